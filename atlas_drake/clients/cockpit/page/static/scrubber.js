// A slider over a log's time, below a band of its behaviors. View, panels and plots follow it.

import { el, set } from "./dom.js";
import { slider } from "./numbers.js";

const STEP = 0.01;  // Smallest change of the time [s].

export function build(page, root) {
  const { begin, end, phases } = page.run.log;
  const colors = Object.fromEntries(page.run.behaviors.map(({ name, color }) => [name, color]));
  const band = phases.map(([from, name], index) => {
    const long = (phases[index + 1]?.[0] ?? end) - from, text = name.replaceAll("_", " ");
    return el("i", { style: { flex: `${long} 0 0`, background: colors[name] },
                     "data-tip": `${text} from ${from.toFixed(1)} s` }, text);
  });
  const { input, put } = slider(
    { min: begin, max: end, step: STEP, "aria-label": "Time of the log" },
    (time) => page.do("seek", { time }));
  root.append(el("div", { class: "scrubber" },
    el("div", { class: "band", "aria-hidden": true }, band), input,
    el("p", { class: "dim" }, "A log is shown: play it, or drag the slider")));
  return {
    show({ time }) {
      put(time);
      set(input, { "aria-valuetext": `${time.toFixed(2)} s` });
    },
  };
}
