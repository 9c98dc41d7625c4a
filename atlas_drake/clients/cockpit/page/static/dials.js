// The joints of a limb: set-point within its limits, measured position, effort, and gains.

import { button, el, form, set, write } from "./dom.js";
import { ownerColor } from "./figure.js";
import { slider } from "./numbers.js";
import { popover } from "./popover.js";
import { loadBar } from "./strain.js";

const GAINS = {
  kp_position: "N·m/rad", ki_position: "N·m/(rad·s)",
  kd_position: "N·m·s/rad", kp_velocity: "N·m·s/rad",
};
const NEAR = 0.011; // Difference below which a set-point is where it was put [rad].
const STANDS = 1000; // A set-point that stands still so long goes nowhere [ms].

// Makes the row of a joint, whose number in the messages is `index`.
export function dial(page, joint, index) {
  let asked = null, movedAt = 0, before = 0; // Where the set-point was put, when; where it was.
  const { input, put } = slider({
    "aria-label": `${joint.name} [rad]`, step: 0.01,
    min: Math.ceil(100 * joint.lower) / 100, max: Math.floor(100 * joint.upper) / 100,
  }, async (position) => {
    asked = position;
    movedAt = performance.now();
    const done = await page.do("move", { joint: joint.name, position });
    if (done === undefined) asked = null;
  });
  const name = button(joint.name.replace(`${joint.limb}_`, ""), null, {
    class: "name", "aria-label": `Gains of ${joint.name}`,
    "data-tip": `${joint.name}: ${joint.lower.toFixed(2)} to ${joint.upper.toFixed(2)} rad, at `
      + `most ${joint.effort.toFixed(0)} N·m. Click for its gains.`,
  });
  const gains = gainsOf(page, joint, index, name);
  const value = el("span", { class: "number" });
  const load = loadBar(), measured = el("i", { class: "measured" });
  const track = el("div", { class: "track" }, input, measured, load);
  const element = el("div", { class: "dial" }, name, track, value, gains.element);

  function show(frame) {
    const { position, effort } = frame.record.joints;
    const share = frame.command.k_effort[index], setPoint = frame.command.position[index];
    const usable = share > 0 && !page.log;
    set(input, { disabled: !usable, style: { "--owner": ownerColor(share) } });
    const stands = setPoint === before && performance.now() - movedAt > STANDS && !frame.paused;
    if (!usable || stands || Math.abs(setPoint - (asked ?? setPoint)) < NEAR) asked = null;
    before = setPoint;
    put(share > 0 ? asked ?? setPoint : position[index]);
    write(value, position[index].toFixed(2));
    const at = (position[index] - joint.lower) / (joint.upper - joint.lower);
    set(measured, { style: { "--at": Math.min(Math.max(at, 0), 1) } });
    set(load, { value: Math.abs(effort[index]) / joint.effort });
    gains.show(frame);
  }
  return { element, show };
}

// Makes the window of a joint's gains, which are those of the user's law.
function gainsOf(page, joint, index, opener) {
  const inputs = Object.entries(GAINS).map(([name, unit]) => [name, unit, el("input", {
    type: "number", min: 0, step: "any", required: "", "aria-label": name })]);
  const apply = () => page.do("message", {
    atlas_command: Object.fromEntries(inputs.map(([name, , input]) =>
      [name, page.frame.command[name].with(index, input.valueAsNumber)])),
  });
  const title = `Gains of ${joint.name}`;
  const element = popover(opener, title, el("h2", {}, title),
    el("p", { class: "dim" }, "They act on the part of the joint that is yours."),
    form({ class: "gains" }, apply,
      inputs.map(([name, unit, input]) => [name, input, el("span", { class: "dim" }, unit)]),
      page.log ? null : button("Apply", null, { class: "main" })));

  const shown = {};
  function show(frame) {
    for (const [name, , input] of inputs) { // What is typed stays until a gain changes.
      const now = frame.command[name][index];
      if (now !== shown[name]) input.value = Number(now.toPrecision(6));
      shown[name] = now;
    }
  }
  return { element, show };
}
