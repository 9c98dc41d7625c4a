// The robot from above, its heading to the right: feet, footsteps, support polygon, CoM, DCM, CoP.

import { el, set, svg, write } from "./dom.js";
import { COM, COP, DCM, FEET } from "./palette.js";

const WIDTH = 300, HEIGHT = 108; // Of the picture [px].
const LEAST = 0.6; // Half of what is seen ahead and behind, at least [m].
const GRID = 0.2; // The scale changes by this, so that it does not tremble [m].
const DOTS = [["com", COM, 4.5, "CoM"], ["dcm", DCM, 5, "DCM"], ["cop", COP, 3.5, "CoP"]];
const DEGREES = 180 / Math.PI;

export function build(page, root) {
  const [length, width] = page.run.sole;
  const steps = svg("g"), support = svg("polygon", { class: "support" });
  const feet = FEET.map((color) => foot(color, "foot"));
  const dots = DOTS.map(([, color]) => svg("circle", { fill: color, class: "dot" }));
  const ground = svg("g", {}, steps, support, feet, dots); // In W [m].
  const scaleLine = svg("path", { class: "scale" });
  const scaleText = svg("text", { x: 8, y: HEIGHT - 10 });
  const loads = el("span", { class: "number loads" });
  const legend = [...DOTS.map(([, color, , name]) => [name, color]), ["support", null]];
  root.append(
    svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img",
                 "aria-label": "Feet, CoM, DCM and CoP from above" },
      ground, scaleLine, scaleText,
      svg("text", { x: WIDTH - 6, y: 13, "text-anchor": "end" }, "ahead →")),
    loads,
    el("p", { class: "legend" }, legend.map(([name, color]) =>
      el("span", {}, el("i", { class: name, style: { background: color } }), name))));

  function foot(color, style) {
    return svg("rect", { class: style, stroke: color, fill: color, rx: 0.03,
                         x: -0.5 * length, y: -0.5 * width, width: length, height: width });
  }

  // Half of what is seen, so that all of these points are [m].
  function reachOf(points, [x, y], yaw) {
    const cos = Math.cos(yaw), sin = Math.sin(yaw);
    const half = 0.5 * Math.hypot(length, width); // Of a foot.
    const reach = points.map(([px, py]) => Math.max(
      Math.abs(cos * (px - x) + sin * (py - y)) + half,
      (Math.abs(cos * (py - y) - sin * (px - x)) + half) * WIDTH / HEIGHT));
    return GRID * Math.ceil(Math.max(LEAST, ...reach) / GRID);
  }

  const place = (rect, [x, y, yaw]) =>
    set(rect, { transform: `translate(${x} ${y}) rotate(${DEGREES * yaw})` });

  return {
    show(frame) {
      const { balance } = frame.record, yaw = frame.robot[3];
      const middle = [0, 1].map((axis) => 0.5 * (frame.feet[0][axis] + frame.feet[1][axis]));
      const coming = [...frame.steps, ...page.walking.plan];
      const corners = balance.support ?? [];
      const known = DOTS.map(([name]) => balance[name]);
      const scale = 0.5 * WIDTH / reachOf([ // [px/m]
        ...coming.map((step) => step.slice(1)), ...frame.feet, ...corners, ...known.filter(Boolean),
      ], middle, yaw);
      set(ground, { transform: `translate(${WIDTH / 2} ${HEIGHT / 2}) scale(${scale} ${-scale}) `
        + `rotate(${-DEGREES * yaw}) translate(${-middle[0]} ${-middle[1]})` });
      while (steps.childElementCount > coming.length) steps.lastChild.remove();
      coming.forEach(([number, ...pose], i) => {
        if (!steps.children[i]) steps.append(foot("none", "step"));
        place(set(steps.children[i], { stroke: FEET[number] }), pose);
      });
      frame.feet.forEach((pose, i) => place(feet[i], pose));
      set(support, { points: corners.join(" ") });
      known.forEach((at, i) => {
        set(dots[i], { cx: at?.[0] ?? null, cy: at?.[1] ?? null, r: at ? DOTS[i][2] / scale : 0 });
      });
      const rule = scale > 90 ? 0.5 : scale > 40 ? 1 : 2; // [m]
      set(scaleLine, { d: `M8 ${HEIGHT - 9}v6m0 -3h${rule * scale}m0 -3v6` });
      write(scaleText, `${rule} m`);
      const [left, right] = frame.loads.map((load) => load.toFixed(0));
      write(loads, `left ${left} N, right ${right} N`);
    },
  };
}
