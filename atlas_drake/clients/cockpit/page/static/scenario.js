// The scenario: what runs, another one to start, and what was done by hand as a file.

import { button, choice, el, form, write } from "./dom.js";

const LARGEST = 1e6; // Size of a file beyond which it is not read [byte].
const FILE = "file:"; // Stands for the opened file among the examples.

export function build(page, root) {
  const now = el("p");
  const from = choice([], { onchange: showChanges });
  const robot = choice([]), world = choice([]);
  const seed = el("input", { type: "number", min: 0, placeholder: "the scenario's" });
  const told = el("p", { class: "dim" });
  const problem = el("p", { class: "problem", role: "alert" });
  const opened = el("p", { class: "dim", role: "status" });
  const file = el("input", { type: "file", accept: ".yaml,.yml", hidden: true,
                             "aria-label": "YAML file", onchange: open });
  let read = null; // Name and text of the opened file.

  root.append(
    now,
    el("h3", {}, "Start another one"),
    form({ class: "rows" }, start,
      el("label", {}, "Scenario", from),
      el("div", { class: "presets" },
         button("Open a YAML file …", () => file.click(), { type: "button" }), file),
      opened,
      el("label", {}, "Robot", robot), el("label", {}, "World", world),
      el("label", {}, "Seed", seed), told,
      button("Start scenario", null, { class: "main" }), problem),
    el("h3", {}, "What was done by hand since the last reset"),
    el("p", { class: "dim" }, "All that was sent and pushed, as a scenario: atlas-drake run "
      + "by_hand.yaml does it again."),
    button("Save what I did", save));
  page.on("settings", fill);
  page.on("changes", showChanges);

  function fill() {
    const { examples, robots, worlds, ...is } = page.settings;
    now.replaceChildren(el("b", {}, "Now: "),
      `scenario ${is.name}, robot ${is.robot}, world ${is.world}, seed ${is.seed}`);
    const opened = read ? [[FILE, `File ${read.name}`]] : [];
    offer(from, "Keep the present scenario", examples, opened);
    offer(robot, "The scenario's robot", robots);
    offer(world, "The scenario's world", worlds);
    showChanges();
  }

  // Changes what can be chosen, and keeps what is.
  function offer(select, keep, names, first = []) {
    const named = names.map((one) => (Array.isArray(one) ? one : [one, one]));
    const chosen = select.value, pairs = [["", keep], ...first, ...named];
    select.replaceChildren(...choice(pairs).children);
    select.value = chosen;
    if (select.selectedIndex < 0) select.value = "";
  }

  function showChanges() {
    const count = Object.keys(page.changes).length, why = page.settings.why_not;
    const kept = from.value === "" && count
      ? `Starts with the ${count === 1 ? "changed setting" : `${count} changed settings`} too. `
      : "";
    write(told, kept + why.slice(0, 1).toUpperCase() + why.slice(1));
  }

  async function open() {
    const [chosen] = file.files;
    const size = `${chosen.size.toLocaleString("en")} bytes`;
    if (chosen.size > LARGEST) write(problem, `${chosen.name} has ${size}; at most 1 MB are read`);
    else {
      read = { name: chosen.name, text: await chosen.text() };
      write(problem, "");
      write(opened, `${read.name}, ${size}`);
      fill();
      from.value = FILE;
      showChanges();
    }
    file.value = ""; // The same file can be opened again after a change.
  }

  async function start() {
    write(problem, "");
    const changes = from.value === "" ? { ...page.changes } : {};
    if (robot.value) changes.model = robot.value;
    if (world.value) changes.world = world.value;
    if (seed.value) changes.seed = seed.value;
    const source = from.value === FILE ? { text: read.text } : from.value ? { example: from.value }
      : {};
    try {
      await page.do("start", { changes, ...source }, { quiet: true });
      page.setChanges({});
    } catch (error) {
      write(problem, error.message);
    }
  }

  async function save() {
    const text = await page.do("done");
    if (text !== undefined) page.download("by_hand.yaml", text);
  }
  return {};
}
