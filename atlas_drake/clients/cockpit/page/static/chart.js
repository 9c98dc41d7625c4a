// Curves over time with axes: one chart for each unit.

import { svg } from "./dom.js";

const HEIGHT = 88; // Of a chart [px].
const TOP = 6, RIGHT = 5, BOTTOM = 15; // Margins [px].
const LETTER = 5.7; // Width of a letter of a label [px].
const COLORS = ["#3385e6", "#e0790f", "#2f9e57", "#cc4d92", "#8c66d9", "#8c8c33"];

// The color of a curve, by its place in the list.
export const colorOf = (place) => COLORS[place % COLORS.length];

// Round values between two bounds, at most about `most`, with labels that all differ.
function ticks(low, high, most) {
  const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((one) => one * power).find((one) => one >= raw * 0.999);
  const count = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const found = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n++) {
    found.push([n * step, (n === 0 ? 0 : n * step).toFixed(count)]);
  }
  return found;
}

// Ends of an axis that hold all numbers, and are apart.
function bounds(values) {
  const finite = values.filter(Number.isFinite);
  if (!finite.length) return [0, 1];
  const low = finite.reduce((one, other) => Math.min(one, other));
  const high = finite.reduce((one, other) => Math.max(one, other));
  const least = Math.max(1e-4 * Math.max(Math.abs(low), Math.abs(high)), 1e-6);
  const margin = Math.max(0.06 * (high - low), 0.5 * (least - (high - low)), 0);
  return [low - margin, high + margin];
}

// Draws curves: each has `name`, `color`, `dashed`, and `points` [time, value]; null is a gap.
export function chart(curves, { unit, begin, end, cursor, width }) {
  const [low, high] = bounds(curves.flatMap((curve) => curve.points.map((point) => point[1])));
  const across = ticks(low, high, 4);
  const left = 8 + LETTER * Math.max(...across.map(([, text]) => text.length), unit.length);
  const bottom = HEIGHT - BOTTOM;
  const x = (time) => left + (width - left - RIGHT) * (time - begin) / (end - begin);
  const y = (value) => TOP + (bottom - TOP) * (high - value) / (high - low);
  const along = ticks(begin, end, Math.max((width - left) / 60, 2));
  const line = (d, style) => svg("path", { d, class: style });
  return svg("svg", { class: "chart", viewBox: `0 0 ${width} ${HEIGHT}`, role: "img",
                      "aria-label": `${curves.map(({ name }) => name).join(", ")} [${unit}]` },
    svg("rect", { x: left, y: TOP, width: width - left - RIGHT, height: bottom - TOP }),
    across.map(([value, text]) => [
      line(`M${left} ${y(value)}H${width - RIGHT}`, "grid"),
      svg("text", { x: left - 4, y: y(value) + 3.5, "text-anchor": "end" }, text)]),
    along.map(([time, text]) => [
      line(`M${x(time)} ${TOP}V${bottom}`, "grid"),
      svg("text", { x: Math.min(x(time), width - 0.5 * LETTER * (text.length + 2)), y: HEIGHT - 3,
                    "text-anchor": "middle" }, `${text} s`)]),
    svg("text", { x: left + 4, y: TOP + 10, class: "unit" }, unit),
    curves.flatMap(({ points, color, dashed }) => pieces(points, width).map((piece) =>
      svg("polyline", { points: piece.map(([t, v]) => [x(t).toFixed(1), y(v).toFixed(1)]).join(" "),
                        stroke: color, "stroke-dasharray": dashed ? "4 3" : null }))),
    cursor === null ? null : line(`M${x(cursor)} ${TOP}V${bottom}`, "cursor"));
}

// Parts a curve where it has no value, and thins it to about a point for each pixel.
function pieces(points, width) {
  const every = Math.max(Math.floor(points.length / width), 1);
  const found = [[]];
  points.forEach((point, i) => {
    if (!Number.isFinite(point[1])) {
      if (found.at(-1).length) found.push([]);
    } else if (i % every === 0 || i === points.length - 1) found.at(-1).push(point);
  });
  return found.filter((piece) => piece.length);
}
