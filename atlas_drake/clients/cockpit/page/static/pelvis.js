// The pelvis in MANIPULATE: height, orientation, and center of mass over the feet.

import { button, el, write } from "./dom.js";
import { numbers, titleOf } from "./numbers.js";

const LEVEL = ["pelvis_yaw", "pelvis_pitch", "pelvis_roll", "com_v0", "com_v1"];
const NEAR = 0.003; // Difference from what was asked for below which nothing is clamped [m], [rad].
const SETTLES = 0.1; // Time until the behavior has answered to what was asked for [s].

export function build(page, root) {
  const ranges = page.run.pelvis;
  let asked = null, askedAt = 0; // All coordinates, and the time [s].

  // The coordinates that are left out stay as asked for.
  async function move(changes) {
    const before = asked;
    asked = { ...page.frame.record.manipulate.clamped, ...asked, ...changes };
    askedAt = page.frame.time;
    const done = await page.do("message", { atlas_sim_interface_command: {
      behavior: "MANIPULATE", manipulate_params: { use_desired: true, desired: asked } } });
    if (done === undefined) asked = before;
  }

  const pose = numbers(ranges, (name, value) => move({ [name]: value }));
  const level = button("Level", () => move(Object.fromEntries(LEVEL.map((name) => [name, 0]))), {
    "data-tip": "Turn the pelvis upright and ahead, with the center of mass between the feet" });
  const told = el("p", { class: "dim", role: "status" });
  root.append(
    el("div", { class: "presets" },
       button("MANIPULATE", () => page.do("behave", { name: "MANIPULATE" }),
              { "data-tip": "Stand, and follow what is asked of the pelvis" }),
       level),
    pose.element, told);

  // Names what the behavior does not follow, such as "pelvis height 0.80 → 0.76 m".
  function clamped(now) {
    const changed = Object.entries(asked ?? {}).filter(
      ([name, value]) => Math.abs(value - now[name]) > NEAR);
    return changed.map(([name, value]) =>
      `${titleOf(name)} ${value.toFixed(2)} → ${now[name].toFixed(2)} ${ranges[name].unit}`);
  }

  return {
    show(frame) {
      const acts = frame.behavior === "MANIPULATE";
      level.disabled = !acts;
      if (!acts) {
        asked = null;
        pose.show({ pelvis_height: frame.record.pelvis.position[2] - frame.ground }, false);
        write(told, "The pelvis moves in MANIPULATE; until then its height is the measured one");
        return;
      }
      const now = frame.record.manipulate.clamped;
      pose.show(now);
      if (frame.time < askedAt + SETTLES && frame.time >= askedAt) return;
      const said = clamped(now).join(", ");
      write(told, said ? `clamped: ${said}` : asked ? "as asked for" : "");
    },
  };
}
