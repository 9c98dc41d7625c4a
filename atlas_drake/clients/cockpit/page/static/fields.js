// The input for a field of a configuration: a setting of the scenario, a behavior's parameter.

import { el } from "./dom.js";

// Makes the input between its name and its unit. `onChange` gets the new value, once it has been
// entered, as the text that YAML has for it.
export function field(description, onChange) {
  const { path, kind, value, unit, bounds } = description;
  const named = { "aria-label": path };
  return el("label", { class: `field ${kind}` }, el("span", { class: "path" }, path), input(),
            el("span", { class: "dim unit" }, unit),
            bounds ? el("span", { class: "dim told" }, bounds) : null);

  function input() {
    if (kind === "flag") {
      return el("input", { type: "checkbox", ...named, checked: value === "true",
                           onchange: (event) => onChange(String(event.target.checked)) });
    }
    const onchange = (event) => onChange(event.target.value.trim());
    if (kind === "choice") {
      const choices = [...new Set([value, ...description.choices])];
      return el("select", { ...named, onchange, value },
                choices.map((choice) => el("option", { value: choice }, choice)));
    }
    return el("input", { type: "text", ...named, value, onchange, spellcheck: "false",
                         autocomplete: "off", ...(kind === "number" && { inputmode: "decimal" }) });
  }
}
