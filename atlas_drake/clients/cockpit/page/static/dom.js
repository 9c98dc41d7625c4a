// Makes and changes elements. Text becomes text nodes alone, and functions become listeners:
// nothing of what a robot or a scenario is called is ever read as markup or script.

const SVG = "http://www.w3.org/2000/svg";

// Attributes that are properties; they hold what is shown now.
const PROPERTIES = new Set(["value", "checked", "disabled", "hidden", "open"]);

// Makes an element of HTML. Children are nodes, texts, lists of these, or null.
export function el(tag, attributes, ...children) {
  return filled(document.createElement(tag), attributes, children);
}

export function svg(tag, attributes, ...children) {
  return filled(document.createElementNS(SVG, tag), attributes, children);
}

function filled(node, attributes = {}, children) {
  node.append(...children.flat(Infinity).filter((one) => one !== null));
  return set(node, attributes); // After the children: a select's value is one of them.
}

// Sets attributes: `onclick: fn` listens, `style: {color: "red"}` sets single properties, null
// takes an attribute away. What is so already is left alone, and is not drawn anew.
export function set(node, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (name === "style") {
      for (const [key, one] of Object.entries(value)) node.style.setProperty(key, one);
    } else if (PROPERTIES.has(name)) node[name] = value;
    else if (value === null) node.removeAttribute(name);
    else if (node.getAttribute(name) !== String(value)) node.setAttribute(name, value);
  }
  return node;
}

// Writes a text, if it is another one than before: readers of the screen read it again.
export function write(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

// Lights an element, or any other class of the style sheet.
export function light(node, on, style = "lit") { node.classList.toggle(style, on); }

export function button(content, onclick, attributes) {
  return el("button", { onclick, ...attributes }, content);
}

// Makes a box to tick that asks for what it shows. What was asked for it shows until there is an
// answer: frames on their way still tell of before.
export function tick(attributes, ask) {
  let open = 0;
  const input = el("input", { ...attributes, type: "checkbox", onchange: async () => {
    open += 1;
    await ask(input.checked).finally(() => { open -= 1; });
  } });
  return { input, put(on) { if (!open) set(input, { checked: on }); } };
}

// Makes a list to choose from, of pairs of a value and what is told of it.
export function choice(pairs, attributes) {
  return el("select", attributes, pairs.map(([value, text]) => el("option", { value }, text)));
}

// Makes a form that is read by the page itself once the browser finds all of it valid.
export function form(attributes, submit, ...children) {
  const onsubmit = (event) => {
    event.preventDefault();
    submit();
  };
  return el("form", { ...attributes, onsubmit }, ...children);
}

// Calls a function at once, then at most once in `wait` [ms], the last time with the latest.
export function seldom(wait, fn) {
  let timer = null, latest = null;
  const call = () => {
    timer = latest && setTimeout(call, wait);
    if (latest === null) return;
    const values = latest;
    latest = null;
    fn(...values);
  };
  return (...values) => {
    latest = values;
    if (timer === null) call();
  };
}
