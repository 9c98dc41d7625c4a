// A button for each behavior, and STOP.

import { button, el, form, light, set, write } from "./dom.js";
import { field } from "./fields.js";
import { MODES } from "./keys.js";
import { POLICY } from "./palette.js";
import { popover } from "./popover.js";

const KEYS = Object.fromEntries(Object.entries(MODES).map(([key, name]) => [name, key]));

export function build(page, root) {
  const nav = el("nav", { class: "modes", "aria-label": "Modes" });
  const buttons = page.run.behaviors.map((behavior) => addBehavior(page, nav, behavior));
  const policy = page.log ? null : addPolicy(page, nav);
  const said = el("small", {}, "Esc");
  const stop = button(["STOP", said], () => page.stop(), { class: "stop", "aria-label": "STOP" });
  nav.append(stop);
  root.append(nav);
  return {
    show(frame) {
      const stopping = page.stopping !== null;
      for (const one of buttons) one.show(frame, stopping);
      policy?.show(frame, stopping);
      stop.hidden = !page.session.may_steer;
      light(stop, stopping, "stopping");
      write(said, stopping ? "stopping …" : "Esc");
    },
  };
}

function addBehavior(page, nav, { name, color, description, params }) {
  let refusal = "";
  const press = (event) => {
    if (refusal) {
      event.preventDefault(); // The form stays closed.
      page.tell(refusal);
    } else if (!params.length) page.do("behave", { name });
  };
  const key = KEYS[name] ? el("kbd", {}, KEYS[name]) : null;
  const one = button([name.replaceAll("_", " "), key], press,
                     { class: "behavior", "aria-label": name, style: { "--own": color } });
  nav.append(one);
  if (params.length) nav.append(addForm(page, one, name, description, params));
  return {
    show(frame, stopping) {
      refusal = frame.refusals[name] || "";
      const active = frame.behavior === name && !stopping && !frame.fallen;
      light(one, active);
      set(one, { "aria-pressed": active, "aria-disabled": refusal !== "",
                 "data-tip": refusal || description });
    },
  };
}

// Lets a learned policy take its joints again; STOP takes them back.
function addPolicy(page, nav) {
  const one = button("POLICY", () => page.do("take_policy"),
                     { class: "behavior", style: { "--own": POLICY } });
  nav.append(one);
  return {
    show({ policy, fallen }, stopping) {
      one.hidden = policy === null;
      if (policy === null) return;
      const active = policy.runs && !stopping && !fallen;
      const tip = `${policy.name} commands ${policy.joints.length} joints, and the keys of the walk`
        + " ask it for a velocity. STOP gives the legs back to STAND";
      light(one, active);
      set(one, { "aria-pressed": active, "data-tip": tip });
    },
  };
}

// The parameters of a behavior of the user's own.
function addForm(page, opener, name, description, params) {
  const values = Object.fromEntries(params.map((one) => [one.path, plain(one.kind, one.value)]));
  const fields = params.map((one) =>
    field(one, (text) => { values[one.path] = plain(one.kind, text); }));
  const menu = popover(opener, name, el("h2", {}, name.replaceAll("_", " ")),
    el("p", { class: "dim" }, description),
    form({}, () => {
      menu.hidePopover();
      page.do("message", { atlas_sim_interface_command: { behavior: name, params: values } });
    }, ...fields, button(`Start ${name}`, null, { class: "main" })));
  return menu;
}

function plain(kind, text) {
  if (kind === "number") return Number(text);
  return kind === "flag" ? text === "true" : text;
}
