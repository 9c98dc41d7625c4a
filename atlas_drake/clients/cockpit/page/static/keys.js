// Lets the keyboard alone suffice.

import { closePopovers } from "./popover.js";

// Keys of the walk, as they lie on the keyboard: what they say and the direction.
export const DIRECTIONS = {
  u: ["arc left", { forward: 1, turn: 1 }],
  i: ["forward", { forward: 1 }],
  o: ["arc right", { forward: 1, turn: -1 }],
  j: ["left", { left: 1 }],
  k: ["stop walking", null],
  l: ["right", { left: -1 }],
  m: ["turn left", { turn: 1 }],
  ",": ["backward", { forward: -1 }],
  ".": ["turn right", { turn: -1 }],
};

export const MODES = { 1: "STAND", 2: "WALK", 3: "STEP", 4: "MANIPULATE", 5: "FREEZE",
                       6: "USER", 7: "STAND_PREP" };

// All others, with what they do; `view` has the camera and the plan.
const OTHERS = {
  " ": ["pause or go on", (page) => page.do("pause", { on: !page.frame?.paused })],
  n: ["single step", (page) => page.do("step")],
  b: ["back 10 s", (page) => page.do("back")],
  r: ["reset", (page) => page.do("reset")],
  c: ["the camera follows again", (page) => page.view.look("Follow")],
  g: ["choose a place and heading on the ground", (page) => page.view.aim()],
  Enter: ["send the plan", (page) => page.view.sendPlan()],
  "?": ["these keys", (page) => page.showKeys()],
};

// What the keys do: key, text.
export const KEY_TEXTS = [
  ["Esc", "STOP, wherever one is"],
  ...Object.entries(DIRECTIONS).map(([key, [text]]) => [key, text]),
  ...Object.entries(MODES),
  ...Object.entries(OTHERS).map(([key, [text]]) => [key === " " ? "space" : key, text]),
];

// Walks in the direction of a key.
export function walkBy(page, key) {
  const [, direction] = DIRECTIONS[key];
  if (direction === null) page.do("stop_walking");
  else page.do("walk", { forward: 0, left: 0, turn: 0, ...direction });
}

// What takes space and Enter, and what takes all keys.
const PRESSED = "button, summary, input, [role=button]";
const TYPED = "select, input:not([type=range], [type=checkbox], [type=file])";

export function startKeys(page) {
  window.addEventListener("keydown", (event) => {
    if (page.run === null) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (key === "Escape") {
      closePopovers();
      document.activeElement?.blur();
      page.view.dropPlan();
      if (!event.repeat && !page.log) page.stop();
      return;
    }
    if (event.repeat || event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.target.matches(TYPED)) return;
    if ((key === " " || key === "Enter") && event.target.closest(PRESSED)) return;
    if (key in DIRECTIONS) walkBy(page, key);
    else if (key in MODES) page.do("behave", { name: MODES[key] });
    else if (key in OTHERS) {
      OTHERS[key][1](page);
      event.preventDefault(); // Space would scroll.
    }
  }, true);
  // What was clicked or chosen must not take the keys that come next.
  window.addEventListener("click", (event) => {
    const taken = event.detail && event.target.closest("button, summary, input[type=checkbox]");
    if (taken) setTimeout(() => taken.blur());
  });
  window.addEventListener("change", (event) => {
    if (event.target.matches("select")) event.target.blur();
  });
}
