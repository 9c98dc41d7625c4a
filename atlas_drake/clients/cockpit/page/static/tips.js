// Explanations: an element says its own in `data-tip`, shown while the pointer is over it or the
// keyboard's focus in it. They take no pointer, and open away from STOP.

import { el, write } from "./dom.js";
import { put } from "./popover.js";

const PATIENCE = 350; // Until the pointer rests [ms].

export function startTips() {
  const tip = el("div", { popover: "manual", class: "tip", role: "tooltip", id: "tip" });
  document.body.append(tip);
  let at = null, timer = null;
  const hide = () => {
    clearTimeout(timer);
    at?.removeAttribute("aria-describedby");
    at = null;
    tip.hidePopover();
  };
  const show = () => {
    if (!at.isConnected) { hide(); return; }
    write(tip, at.dataset.tip);
    at.setAttribute("aria-describedby", "tip");
    tip.showPopover();
    put(tip, at);
  };
  const over = (element, wait) => {
    if (element === at) return;
    hide();
    at = element;
    if (at) timer = setTimeout(show, wait);
  };
  const told = (event) => event.target.closest('[data-tip]:not([data-tip=""])');
  document.addEventListener("pointerover", (event) => {
    if (event.pointerType === "mouse") over(told(event), PATIENCE);
  });
  document.addEventListener("pointerdown", hide, true);
  document.addEventListener("keydown", hide, true);
  document.addEventListener("focusin", (event) => {
    if (event.target.matches(":focus-visible")) over(told(event), 0);
  });
  document.addEventListener("focusout", hide);
}
