// The events of the run, the newest first, with a search.

import { el } from "./dom.js";

const SHOWN = 200; // Number of events that are listed.

export function build(page, root) {
  const search = el("input", { type: "search", placeholder: "Search", oninput: fill,
                               "aria-label": "Search events", autocomplete: "off" });
  const list = el("div", { role: "log", "aria-label": "Events", tabindex: 0 });
  root.append(search, list);
  page.on("events", fill);

  function fill() {
    const word = search.value.toLowerCase();
    const found = page.events.filter(([, kind, text]) =>
      `${kind} ${text}`.toLowerCase().includes(word));
    const rows = found.slice(-SHOWN).reverse().map(([time, kind, text]) =>
      el("p", { class: kind }, el("b", { class: "number" }, time.toFixed(2)), ` ${text}`));
    list.replaceChildren(...rows);
    if (!rows.length) list.append(word ? "nothing has this word" : "nothing yet");
  }
  return {};
}
