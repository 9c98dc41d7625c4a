// The behaviors of the last minute, above the user's share of all joints.

import { svg } from "./dom.js";
import { BEHAVIOR, USER } from "./palette.js";

const SPAN = 60; // Time that is seen [s].
const WIDTH = 300, HEIGHT = 40; // Of the picture [px].
const BAND = 16, TOP = 20; // Height of the bands, and where the shares begin [px].
const LETTER = 6.6; // Width of a letter [px].
const LEAST = 0.15; // Change of time that can be seen [s].

export function build(page, root) {
  const colors = new Map(page.run.behaviors.map((one) => [one.name, one.color]));
  const picture = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label":
    `Modes of ${page.log ? "a" : "the last"} minute, and the user's share` });
  root.append(picture);

  // Phases as [begin, behavior], shares as [time, share], and the times that are seen.
  function ofLog(time) {
    const { begin, end, phases, share } = page.run.log;
    const first = Math.max(begin, Math.min(time - SPAN / 2, end - SPAN));
    return { phases, shares: share, begin: first, last: end };
  }

  function ofMoments(time) {
    const phases = page.moments.filter(([, name], i) => name !== page.moments[i - 1]?.[1]);
    return { phases, shares: page.moments.map(([when, , share]) => [when, share]),
             begin: Math.max(time - SPAN, 0), last: time };
  }

  function draw(time) {
    const { phases, shares, begin, last } = page.log ? ofLog(time) : ofMoments(time);
    const end = begin + SPAN;
    const x = (when) => WIDTH * (when - begin) / SPAN;
    const y = (share) => HEIGHT - 2 - (HEIGHT - TOP - 2) * share;
    const parts = [];
    phases.forEach(([from, name], i) => {
      const to = phases[i + 1]?.[0] ?? last;
      if (to < begin || from > end) return;
      const left = Math.max(x(from), 0), width = Math.max(Math.min(x(to), WIDTH) - left, 1);
      parts.push(svg("rect", { x: left, y: 1, width, height: BAND, fill: colors.get(name),
                               "data-tip": `${name} from ${from.toFixed(1)} s` }));
      if (width > LETTER * name.length + 6) parts.push(svg("text", { x: left + 3, y: 13 }, name));
    });
    const seen = shares.filter(([when]) => when >= begin && when <= end);
    if (seen.length) {
      const left = x(seen[0][0]), right = x(seen.at(-1)[0]);
      const line = seen.map(([when, share]) => `${x(when)},${y(share)}`);
      parts.push(
        svg("rect", { x: left, y: TOP, width: right - left, height: HEIGHT - TOP - 2,
                      fill: BEHAVIOR, opacity: 0.55 }),
        svg("polygon", { fill: USER,
                         points: `${left},${y(0)} ${line.join(" ")} ${right},${y(0)}` }));
    }
    if (page.log) parts.push(svg("path", { class: "cursor", d: `M${x(time)} 0V${HEIGHT}` }));
    picture.replaceChildren(...parts);
  }

  let drawn = -1;
  return {
    show(frame) {
      if (Math.abs(frame.time - drawn) < LEAST) return;
      drawn = frame.time;
      draw(frame.time);
    },
  };
}
