// Walking: directions, the gait of the next steps, and a place to walk to.

import { button, el, form, light, write } from "./dom.js";
import { DIRECTIONS, walkBy } from "./keys.js";
import { numbers } from "./numbers.js";

// Pictures on the pad: an arrow and the angle by which it is turned from ahead [degree].
const PICTURES = { u: ["↑", -45], i: ["↑", 0], o: ["↑", 45], j: ["↑", -90], k: ["■", 0],
                   l: ["↑", 90], m: ["↺", 0], ",": ["↑", 180], ".": ["↻", 0] };
const AXES = ["forward", "left", "turn"];
const DEGREE = Math.PI / 180;

export function build(page, root) {
  const pads = Object.entries(DIRECTIONS).map(([key, [text, way]]) => {
    const [sign, angle] = PICTURES[key];
    const one = button([el("span", { style: { rotate: `${angle}deg` } }, sign), el("kbd", {}, key)],
                       () => walkBy(page, key),
                       { "aria-label": text, "data-tip": `${text} (${key})` });
    return { one, direction: String(way && AXES.map((axis) => way[axis] ?? 0)) };
  });
  const gait = numbers(page.run.gait, (name, value) => page.do("gait", { [name]: value }));
  const goal = [["x [m]", 1], ["y [m]", 0], ["heading [°]", 0]].map(
    ([label, value]) => ({
      label, input: el("input", { type: "number", step: "any", required: "", value,
                                  "aria-label": label }) }));
  const told = el("p", { class: "dim", role: "status" });

  async function plan() {
    const [x, y, heading] = goal.map((one) => one.input.valueAsNumber);
    const steps = await page.do("plan_to", { x, y, yaw: heading * DEGREE });
    if (steps !== undefined) write(told, `Planned: ${steps} steps. “Send plan” walks them.`);
  }

  function end(order) {
    write(told, "");
    page.do(order);
  }

  root.append(
    el("div", { class: "pad" }, pads.map(({ one }) => one)),
    el("h3", {}, "Gait of the next steps"), gait.element,
    el("h3", {}, "Walk to a place"),
    form({ class: "goal" }, plan, goal.map((one) => el("label", {}, one.label, one.input)),
      button("Plan"),
      button("Send plan", () => end("send_plan"), { type: "button" }),
      button("Drop plan", () => end("drop_plan"), { type: "button" })),
    told,
    el("p", { class: "dim" }, "In the view: click the ground to plan a way, click again to walk "
      + "it. A gamepad's sticks steer while they are held."));

  return {
    show() {
      const now = page.walking.direction;
      for (const { one, direction } of pads) light(one, now !== null && direction === String(now));
      gait.show(page.walking.gait);
    },
  };
}
