// Where everything is: bar, tabs at the left, view and modes, folds at the right.

import { button, el, set } from "./dom.js";
import * as bar from "./bar.js";
import * as modes from "./modes.js";
import * as scrubber from "./scrubber.js";
import * as steps from "./steps.js";
import * as view from "./view.js";
import * as joints from "./joints.js";
import * as walking from "./walking.js";
import * as pelvis from "./pelvis.js";
import * as scenario from "./scenario.js";
import * as settings from "./settings.js";
import * as above from "./above.js";
import * as timeline from "./timeline.js";
import * as strain from "./strain.js";
import * as plots from "./plots.js";
import * as events from "./events.js";

const TABS = { Joints: joints, Walk: walking, Pelvis: pelvis, Scenario: scenario,
               Settings: settings };
const LOG_TABS = { Joints: joints }; // The others command alone.
const FOLDS = { "From above": above, "Modes": timeline, "Hottest joints": strain,
                "Plots": plots, "Events": events };

// Builds all panels of a run, and returns them.
export function buildLayout(page) {
  const panels = [], add = (module, root) => { panels.push(module.build(page, root) || {}); };
  const top = el("header", { class: "bar" });
  const left = el("section", { class: "left", "aria-label": "Controls" });
  const middle = el("main", { class: "middle" });
  const right = el("section", { class: "right", "aria-label": "What it thinks" });
  const root = document.getElementById("page");
  root.classList.toggle("replay", page.log);
  root.replaceChildren(top, left, middle, right);
  add(bar, top);
  add(steps, left);
  addTabs(page, left, page.log ? LOG_TABS : TABS, add);
  add(view, middle);
  add(page.log ? scrubber : modes, middle);
  for (const [title, module] of Object.entries(FOLDS)) addFold(page, right, title, module, add);
  return panels;
}

function addTabs(page, left, modules, add) {
  const tabs = {}, bodies = {};
  const list = el("div", { role: "tablist", class: "tabs", "aria-label": "Controls" });
  left.append(list);
  page.openTab = (name) => {
    for (const one in tabs) {
      set(tabs[one], { "aria-selected": one === name, tabindex: one === name ? 0 : -1 });
      bodies[one].hidden = one !== name;
    }
    page.remember("tab", name);
  };
  for (const [name, module] of Object.entries(modules)) {
    const id = name.toLowerCase();
    tabs[name] = button(name, () => page.openTab(name),
                        { role: "tab", id: `tab-${id}`, "aria-controls": `panel-${id}` });
    bodies[name] = el("div", { role: "tabpanel", class: `panel ${id}`, id: `panel-${id}`,
                               "aria-labelledby": `tab-${id}` });
    list.append(tabs[name]);
    left.append(bodies[name]);
    add(module, bodies[name]);
  }
  list.addEventListener("keydown", ({ key, target }) => {
    const next = { ArrowRight: target.nextSibling ?? list.firstChild,
                   ArrowLeft: target.previousSibling ?? list.lastChild }[key];
    next?.click();
    next?.focus();
  });
  const last = page.recall("tab");
  page.openTab(last in tabs ? last : "Joints");
}

function addFold(page, right, title, module, add) {
  const body = el("div", { class: "body" });
  const fold = el("details", {
    class: `fold ${title.toLowerCase().replaceAll(" ", "-")}`,
    open: page.recall(title) ?? true,
    ontoggle: () => page.remember(title, fold.open),
  }, el("summary", {}, title), body);
  right.append(fold);
  add(module, body);
}
