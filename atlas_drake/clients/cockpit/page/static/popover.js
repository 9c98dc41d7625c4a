// A small window that a button opens: the browser's own popover, which closes by a press beside
// it. It is placed beside its button, and never covers STOP.

import { el, set } from "./dom.js";

const GAP = 4; // Between button and window, and to the edge of the page [pixel].

// Makes the window of a button; the caller puts it into the page beside the button.
export function popover(opener, title, ...content) {
  const made = el("div", { popover: "auto", class: "menu", role: "dialog", "aria-label": title },
                  ...content);
  opener.popoverTargetElement = made;
  new ResizeObserver(() => put(made, opener)).observe(made); // Also before it is first drawn.
  return made;
}

export function closePopovers() {
  for (const one of document.querySelectorAll(".menu:popover-open")) one.hidePopover();
}

// Puts a box beside another one: below or above it, inside the page, off STOP.
export function put(made, beside) {
  const at = beside.getBoundingClientRect(), box = made.getBoundingClientRect();
  const { innerWidth: width, innerHeight: height } = window;
  const stop = document.querySelector(".stop")?.getBoundingClientRect();
  const middle = at.left + 0.5 * (at.width - box.width);
  const left = Math.max(GAP, Math.min(middle, width - box.width - GAP));
  const over = (top) => stop && left < stop.right && left + box.width > stop.left &&
    top < stop.bottom && top + box.height > stop.top;
  const fits = (top) => top >= GAP && top + box.height <= height - GAP && !over(top);
  const last = Math.max(GAP, Math.min(at.bottom, height - GAP) - box.height);
  const offStop = stop ? Math.max(GAP, stop.top - GAP - box.height) : last;
  const tops = [at.bottom + GAP, at.top - GAP - box.height, last];
  set(made, { style: { left: `${left}px`, top: `${tops.find(fits) ?? offStop}px` } });
}
