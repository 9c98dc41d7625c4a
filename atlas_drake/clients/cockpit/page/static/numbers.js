// Sliders: native ones, so that mouse, touch and keys move them.

import { el, seldom, set, write } from "./dom.js";

const PERIOD = 100; // Least time between two values that are sent [ms].
const PATIENCE = 600; // Time in which a value that was sent takes effect [ms].

const TITLES = { com_v0: "CoM to the left", com_v1: "CoM ahead" };

export const titleOf = (name) => TITLES[name] ?? name.replaceAll("_", " ");

// Makes a slider that sends what it is moved to. `put` shows a value, but lets a slider alone
// that is held, or was moved just now.
export function slider(attributes, send) {
  let moved = -Infinity;
  const later = seldom(PERIOD, send);
  const oninput = () => {
    moved = performance.now();
    later(Number(input.value));
  };
  const input = el("input", { type: "range", ...attributes, oninput });
  const put = (value) => {
    if (input.matches(":active") || performance.now() - moved < PATIENCE) return;
    if (Number(input.value) !== value) input.value = value;
  };
  return { input, put };
}

// Writes a number with the digits of its smallest change.
export function digits(value, step) {
  const count = String(step).split(".")[1]?.length ?? 0;
  const text = value.toFixed(count);
  return Number(text) === 0 ? text.replace("-", "") : text;
}

// Makes a row for each number of a run's `gait` or `pelvis`: name, slider, value with unit.
export function numbers(ranges, change) {
  const rows = Object.entries(ranges).map(([name, range]) => {
    const { input, put } = slider({
      "aria-label": titleOf(name), min: digits(range.low, range.step), max: range.high,
      step: range.step, value: range.usual,
    }, (value) => change(name, value));
    return { name, range, input, put, value: el("span", { class: "number" }) };
  });
  const element = el("div", { class: "numbers" }, rows.map((row) => [
    el("span", {}, titleOf(row.name)), row.input, row.value]));

  function show(values, usable = true) {
    for (const { name, range, input, put, value } of rows) {
      const now = values?.[name] ?? range.usual;
      put(now);
      write(value, `${digits(now, range.step)} ${range.unit}`);
      set(input, { disabled: !usable });
    }
  }
  return { element, show };
}
