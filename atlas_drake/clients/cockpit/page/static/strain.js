// The joints that are nearest to the limits of their effort.

import { el, set, write } from "./dom.js";
import { digits } from "./numbers.js";

const SHOWN = 5; // Number of joints that are listed.

// A bar for an effort as a share of its limit; it changes color where that gets near.
export const loadBar = () => el("meter", { low: 0.5, high: 0.9, optimum: 0, "aria-hidden": true });

export function build(page, root) {
  const joints = page.run.joints;
  const rows = joints.slice(0, SHOWN).map(() => ({
    name: el("span"), bar: loadBar(), number: el("span", { class: "number" }) }));
  root.append(...rows.map((row) => el("div", { class: "hot" }, row.name, row.bar, row.number)));

  return {
    show(frame) {
      const hottest = joints.map(({ name, effort: limit }, i) => {
        const effort = frame.record.joints.effort[i];
        return { name, effort, share: Math.abs(effort) / limit };
      }).sort((one, other) => other.share - one.share);
      rows.forEach(({ name, bar, number }, i) => {
        const { name: joint, effort, share } = hottest[i];
        write(name, joint);
        set(bar, { value: share });
        write(number, `${digits(effort, 1)} N·m, ${(100 * share).toFixed(0)} %`);
      });
    },
  };
}
