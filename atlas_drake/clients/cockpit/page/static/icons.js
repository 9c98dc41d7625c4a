// Small pictures on buttons, drawn as lines in a box of 24 by 24.

import { set, svg } from "./dom.js";

const PATHS = {
  pause: "M8 5v14M16 5v14",
  play: "M7 4.5v15l12-7.5z",
  step: "M6 5v14l9-7zM18.5 5v14",
  back: "M4 12a8 8 0 1 0 3-6.2M7.5 1.5 6.5 6.2l4.7 1",
  reset: "M20 12a8 8 0 1 1-3-6.2M16.5 1.5l1 4.7-4.7 1",
  begin: "M12 5v14M5 12h14",
  keys: "M3 7h18v10H3zM6.5 10.5h.5M10 10.5h.5M13.5 10.5h.5M17 10.5h.5M8 14h8",
  theme: "M12 3.5a8.5 8.5 0 1 0 0 17zM12 3.5a8.5 8.5 0 0 1 0 17",
  layers: "M12 4 3.5 8.5 12 13l8.5-4.5zM3.5 12.5 12 17l8.5-4.5M3.5 16.2 12 20.7l8.5-4.5",
  push: "M3 12h12M11 7l5 5-5 5M20 4v16",
  picture: "M3.5 7.5h4L9 5h6l1.5 2.5h4v11.5h-17zM12 9.5a3.5 3.5 0 1 0 0 7 3.5 3.5 0 0 0 0-7z",
  record: "M12 6a6 6 0 1 0 0 12 6 6 0 0 0 0-12z",
  close: "M6 6l12 12M18 6 6 18",
};

export function icon(name) {
  return svg("svg", { viewBox: "0 0 24 24", class: "icon", "aria-hidden": true },
             svg("path", { d: PATHS[name] }));
}

// Shows another picture in the place of one.
export function swapIcon(node, name) { set(node.firstChild, { d: PATHS[name] }); }
