// The settings of the run: search, change, save, restart with the changes.

import { button, el, write } from "./dom.js";
import { field } from "./fields.js";

const SHOWN = 40; // Greatest number of settings that are listed at once.

export function build(page, root) {
  const search = el("input", { type: "search", placeholder: "Search", oninput: fill,
                               "aria-label": "Search settings", autocomplete: "off" });
  const only = el("input", { type: "checkbox", role: "switch", onchange: fill });
  const found = el("p", { class: "dim", role: "status" }), rows = el("div", { class: "rows" });
  const count = el("b", { role: "status" }), list = el("div", { class: "path" });
  const restart = el("div", { class: "rows", hidden: true }, count, list,
    el("div", { class: "presets" },
       button("Restart with changes", start, { class: "main" }),
       button("Forget changes", () => {
         page.setChanges({});
         fill();
       })));
  root.append(
    el("div", { class: "search" }, search, el("label", {}, only, "Changed only")),
    restart, found, rows,
    el("div", { class: "presets" }, button("Save settings", save, {
      "data-tip": "Download what differs from the usual, as a scenario for atlas-drake run" })));
  page.on("settings", fill);
  page.on("changes", showChanges);

  function fill() {
    const { fields } = page.settings;
    const words = search.value.toLowerCase().split(" ").filter(Boolean);
    if (!words.length && !only.checked) {
      showGroups(fields);
      return;
    }
    const matching = fields.filter((one) =>
      words.every((word) => `${one.path} ${one.text}`.toLowerCase().includes(word))
      && (!only.checked || one.path in page.changes || one.value !== one.usual));
    const more = matching.length > SHOWN ? `; the first ${SHOWN} are shown` : "";
    write(found, `${matching.length} of ${fields.length} settings${more}`);
    rows.replaceChildren(...matching.slice(0, SHOWN).map((one) => row(one)));
  }

  function showGroups(fields) {
    const groups = new Set(fields.map(({ path }) => path.match(/^(controller\.)?[^.]+/)[0]));
    write(found, `${fields.length} settings, in groups:`);
    rows.replaceChildren(el("div", { class: "presets" }, [...groups].map((group) =>
      button(group, () => {
        search.value = group;
        fill();
      }))));
  }

  function row(setting, problem = "") {
    const value = page.changes[setting.path] ?? setting.value;
    const told = [`usually ${setting.usual}`, setting.bounds,
                  setting.needs && `needs ${setting.needs}`];
    const one = el("div", { class: `setting${value !== setting.usual ? " changed" : ""}` },
      field({ ...setting, value, bounds: "" }, (text) => change(setting, text, one)),
      el("p", { class: "dim told" }, told.filter(Boolean).join(" · ")),
      el("p", { class: "told" }, setting.text),
      el("p", { class: "problem", role: "alert" }, problem));
    return one;
  }

  // Lets a value wait if the scenario can be used with it; else shows what was in force.
  async function change(setting, text, old) {
    const changes = { ...page.changes, [setting.path]: text };
    if (text === setting.value) delete changes[setting.path];
    let problem = "";
    try {
      await page.do("check", { changes }, { quiet: true });
      page.setChanges(changes);
    } catch (error) {
      problem = error.message;
    }
    const focused = old.contains(document.activeElement), anew = row(setting, problem);
    old.replaceWith(anew);
    if (focused) anew.querySelector("input, select").focus();
  }

  function showChanges() {
    const changes = Object.entries(page.changes);
    restart.hidden = !changes.length;
    write(count, changes.length === 1 ? "1 change needs a restart"
                                      : `${changes.length} changes need a restart`);
    list.replaceChildren(...changes.map(([path, value]) => el("p", {}, `${path}: ${value}`)));
  }

  async function start() {
    const done = await page.do("start", { changes: page.changes });
    if (done !== undefined) page.setChanges({});
  }

  async function save() {
    const text = await page.do("written", { changes: page.changes });
    if (text !== undefined) page.download("scenario.yaml", text);
  }
  return {};
}
