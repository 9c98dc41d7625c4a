// The robot's figure from the front, as the camera sees it: its left is on the right of the
// picture. Each limb and each joint is a button.

import { light, set, svg } from "./dom.js";
import { BEHAVIOR, POLICY, SHARED, USER } from "./palette.js";

export const MOST = 255; // k_effort of a joint that is the user's alone.

const TALL = 278; // Height of the robot in the figure [px]; it is drawn at this size or larger.
const LEAST = 28; // Least distance between two joints [px].
const RADIUS = 8.5, TARGET = 12.5; // Of a joint, and of what a click on it hits [px].
const MARGIN = 17; // Around the joints [px].
const PULL = 0.15; // Share of the way back to its place that a joint goes in each turn.
const TURNS = 80; // Turns in which joints are moved apart.

// Moves places apart that are closer than LEAST, so that each can be hit.
export function spread(places) {
  const now = places.map(([x, y], i) => [x + 0.02 * i, y + 0.04 * i]);
  for (let turn = 0; turn < TURNS; turn++) {
    now.forEach((one, i) => {
      for (const axis of [0, 1]) one[axis] += PULL * (places[i][axis] - one[axis]);
    });
    now.forEach((one, i) => now.slice(i + 1).forEach((other) => {
      const way = [other[0] - one[0], other[1] - one[1]];
      const distance = Math.max(Math.hypot(...way), 1e-3);
      if (distance >= LEAST) return;
      for (const axis of [0, 1]) {
        const push = 0.5 * (LEAST / distance - 1) * way[axis];
        one[axis] -= push;
        other[axis] += push;
      }
    }));
  }
  return now;
}

// The color of a share: from the behavior's over half each to the user's.
export function ownerColor(kEffort) {
  const share = kEffort / MOST;
  return share < 0.5 ? mixed(BEHAVIOR, SHARED, 2 * share) : mixed(SHARED, USER, 2 * share - 1);
}

function mixed(one, other, way) {
  const parts = [1, 3, 5].map((at) => {
    const [a, b] = [one, other].map((color) => parseInt(color.slice(at, at + 2), 16));
    return Math.round(a + way * (b - a)).toString(16).padStart(2, "0");
  });
  return `#${parts.join("")}`;
}

export function owner(kEffort) {
  return { 0: "behavior", [MOST]: "yours" }[kEffort] ?? `k_effort ${kEffort}`;
}

// The user's share as a slice from the top, so that it shows without color, too.
function slice(kEffort) {
  const share = kEffort / MOST, r = RADIUS - 2.5;
  if (share <= 0) return "";
  if (share >= 1) return `M0 ${-r}A${r} ${r} 0 1 1 0 ${r}A${r} ${r} 0 1 1 0 ${-r}Z`;
  const [x, y] = [r * Math.sin(2 * Math.PI * share), -r * Math.cos(2 * Math.PI * share)];
  return `M0 0V${-r}A${r} ${r} 0 ${share > 0.5 ? 1 : 0} 1 ${x.toFixed(2)} ${y.toFixed(2)}Z`;
}

// Lays the joints out. `pressJoint` and `pressLimb` get the joint's number or the limb's name,
// and whether it is only chosen.
export function figure(joints, pressJoint, pressLimb) {
  const heights = joints.flatMap((joint) => [joint.place[1], joint.parent[1]]);
  const scale = TALL / Math.max(Math.max(...heights) - Math.min(...heights), 0.1);
  const at = ([y, z]) => [scale * y, -scale * z];
  const places = spread(joints.map((joint) => at(joint.place)));
  const known = new Map(); // Of two joints at one place, the second.
  const parents = joints.map((joint, i) => {
    const parent = known.get(String(joint.parent)) ?? at(joint.parent);
    known.set(String(joint.place), places[i]);
    return parent;
  });
  const every = [...places, ...parents];
  const [left, top] = [0, 1].map((axis) => Math.min(...every.map((p) => p[axis])) - MARGIN);
  const [right, bottom] = [0, 1].map((axis) => Math.max(...every.map((p) => p[axis])) + MARGIN);

  const limbs = new Map([...new Set(joints.map((joint) => joint.limb))].map((limb) => {
    const bones = joints.flatMap((joint, i) => joint.limb !== limb ? [] : [svg("line", {
      x1: parents[i][0], y1: parents[i][1], x2: places[i][0], y2: places[i][1],
    })]);
    const tip = `${limb}: click to choose it, again for all of its joints`;
    return [limb, pressed({ class: "limb", "aria-label": limb, "data-tip": tip },
                          (only) => pressLimb(limb, only), bones)];
  }));
  const circles = joints.map((joint, i) => {
    const ring = svg("circle", { class: "ring", r: RADIUS }), share = svg("path");
    const group = pressed(
      { class: "joint", transform: `translate(${places[i]})` }, (only) => pressJoint(i, only),
      [svg("circle", { class: "target", r: TARGET }),
       svg("circle", { class: "ground", r: RADIUS + 1.5 }), ring, share]);
    return { group, ring, share };
  });
  const size = [right - left, bottom - top];
  const element = svg("svg", {
    class: "figure", viewBox: [left, top, ...size].join(" "),
    style: { "--least-width": `${size[0]}px`, "--least-height": `${size[1]}px` },
    role: "group", "aria-label": "Who has which joint",
  }, [...limbs.values()], circles.map((one) => one.group),
  svg("text", { class: "side", x: left + 4, y: top + 16 }, "R"),
  svg("text", { class: "side", x: right - 4, y: top + 16, "text-anchor": "end" }, "L"));

  // `policys` are the joints that a learned policy has.
  function show(shares, chosen, policys = []) {
    limbs.forEach((group, limb) => light(group, limb === chosen, "chosen"));
    circles.forEach(({ group, ring, share }, i) => {
      const learned = policys.includes(i);
      const color = learned ? POLICY : ownerColor(shares[i]);
      const text = `${joints[i].name}: ${learned ? "the policy's" : owner(shares[i])}`;
      set(group, { "aria-label": text, "data-tip": text });
      set(ring, { fill: color, stroke: color });
      set(share, { fill: color, d: slice(shares[i]) });
    });
  }
  return { element, show };
}

// A group that is a button: pressed by click, Enter and space; with shift it only chooses.
function pressed(attributes, press, children) {
  const onkeydown = (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    event.stopPropagation();
    press(event.shiftKey);
  };
  return svg("g", { role: "button", tabindex: 0, ...attributes, onkeydown,
                    onclick: (event) => press(event.shiftKey) }, children);
}
