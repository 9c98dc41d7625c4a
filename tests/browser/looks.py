"""What a browser finds out about the look of a page, as scripts that it evaluates."""

SMALL_CONTROLS = """(() => {
  const roles = ["button", "slider", "tab", "switch", "option", "menuitem"];
  const controls = "button, input, select, textarea, a, summary, " +
                   roles.map((role) => `[role=${role}]`).join(", ");
  const small = [];
  for (const e of document.querySelectorAll(controls)) {
    if (!e.checkVisibility({ visibilityProperty: true }) || e.type === "file") continue;
    let { width, height } = e.getBoundingClientRect();
    const line = e.querySelector("line"); // It is hit as far as it is thick.
    if (line) {
      const thick = parseFloat(getComputedStyle(line).strokeWidth);
      width += thick * line.getScreenCTM().a;
      height += thick * line.getScreenCTM().d;
    }
    const name = e.getAttribute("aria-label") || e.innerText || e.outerHTML;
    if (Math.min(width, height) < 23.99) small.push(`${name}: ${width} x ${height}`);
  }
  return small;
})()"""
"""Names and sizes of controls that are smaller than 24 pixels in one direction."""

HIDDEN_JOINTS = """(() => {
  const hidden = [];
  for (const joint of document.querySelectorAll(".figure .joint")) {
    joint.scrollIntoView({ block: "nearest" });
    const { x, y, width, height } = joint.getBoundingClientRect();
    const hit = document.elementFromPoint(x + width / 2, y + height / 2);
    if (!joint.contains(hit)) hidden.push(joint.getAttribute("aria-label"));
  }
  return hidden;
})()"""
"""Joints of the figure that something else lies over."""

NAMELESS = """(() => {
  const controls = "button, input, select, textarea, [role=button], [role=slider]";
  const name = (e) => e.getAttribute("aria-label") || e.textContent.trim() ||
                      e.labels?.[0]?.textContent;
  return [...document.querySelectorAll(controls)]
    .filter((e) => e.checkVisibility() && !name(e))
    .map((e) => e.outerHTML.slice(0, 200));
})()"""
"""Controls without a name."""

FAINT = """(() => {
  const parse = (text) => {
    const [r, g, b, a = 1] = (text.match(/[0-9.]+(e-?[0-9]+)?/g) || []).map(Number);
    const scale = text.startsWith("color(") ? 255 : 1;
    return { rgb: [r, g, b].map((one) => one * scale), a };
  };
  const light = (rgb) => {
    const [r, g, b] = rgb.map((v) => {
      v /= 255;
      return v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
    });
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const over = (top, below) =>
    top.rgb.map((one, i) => top.a * one + (1 - top.a) * below[i]);
  const behind = (e) => {
    if (!e) return [255, 255, 255];
    const own = parse(getComputedStyle(e).backgroundColor);
    return own.a === 1 ? own.rgb : own.a === 0 ? behind(e.parentElement)
      : over(own, behind(e.parentElement));
  };
  const faint = [];
  for (const e of document.querySelectorAll("body *")) {
    const says = [...e.childNodes].some((one) => one.nodeType === 3 && one.data.trim());
    if (!says || !e.checkVisibility({ visibilityProperty: true })) continue;
    if (e.closest(":disabled, datalist, option, .fold.modes svg, .band")) continue;
    const style = getComputedStyle(e), back = behind(e);
    const text = parse(e instanceof SVGElement ? style.fill : style.color);
    const [dark, bright] = [light(back), light(over(text, back))].sort((a, b) => a - b);
    const ratio = (bright + 0.05) / (dark + 0.05);
    if (ratio < 4.5) faint.push(`${e.textContent.slice(0, 30)}: ${ratio.toFixed(2)}`);
  }
  return faint;
})()"""
"""Texts whose contrast is less than that of WCAG AA, but for those on a behavior's
color."""

STOP_COVERED = """async () => {
  const stop = document.querySelector(".stop"), covered = [];
  const check = (what, over) => {
    const box = stop.getBoundingClientRect(), other = over.getBoundingClientRect();
    const at = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
    const apart = other.right <= box.left || other.left >= box.right ||
                  other.bottom <= box.top || other.top >= box.bottom;
    if (!apart || !stop.contains(at)) covered.push(what);
  };
  let opened = 0;
  const later = window.setTimeout, tip = document.getElementById("tip");
  const pointAt = (e) => e.dispatchEvent(
    new PointerEvent("pointerover", { bubbles: true, pointerType: "mouse" }));
  window.setTimeout = (fn) => { fn(); return 0; }; // No waiting for each tip.
  for (const told of document.querySelectorAll("[data-tip]")) {
    if (!told.dataset.tip || !told.checkVisibility()) continue;
    pointAt(document.body);
    pointAt(told);
    opened += 1;
    check(`tip: ${told.dataset.tip}`, tip);
    if (!tip.matches(":popover-open")) covered.push(`no tip: ${told.dataset.tip}`);
  }
  pointAt(document.body);
  window.setTimeout = later;
  for (const opener of document.querySelectorAll("button")) {
    const menu = opener.popoverTargetElement;
    if (!menu || !opener.checkVisibility()) continue;
    menu.showPopover();
    await new Promise((done) => requestAnimationFrame(done));
    await new Promise((done) => requestAnimationFrame(done));
    opened += 1;
    check(`menu: ${menu.getAttribute("aria-label")}`, menu);
    menu.hidePopover();
  }
  cockpit.page.tell("A notice ".repeat(30));
  check("notice", document.getElementById("notices"));
  document.getElementById("notices").replaceChildren();
  return { covered, opened };
}"""
"""Whatever opens over the page and lies over STOP, and how many things were opened."""

ACKNOWLEDGED = """() => {
  const stop = document.querySelector(".stop");
  const walk = document.querySelector(".behavior[aria-label=WALK]");
  window.acknowledged = new Promise((done) => {
    const look = () => {
      const says = stop.textContent.includes("stopping") && !walk.matches(".lit");
      if (says) done(performance.timeOrigin + performance.now());
      else requestAnimationFrame(look);
    };
    look();
  });
  window.pressed = new Promise((done) => {
    const press = (event) => done(performance.timeOrigin + event.timeStamp);
    stop.addEventListener("click", press, { capture: true, once: true });
    window.addEventListener("keydown", press, { capture: true, once: true });
  });
}"""
"""Notes when STOP is pressed and when the page says so [ms], from now on."""

INNER_SIZE = (
    "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
)
