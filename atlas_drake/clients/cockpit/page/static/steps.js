// The steps of the demo's schedule: the present one lit, those done ticked, and "Take over".

import { button, el, light, set } from "./dom.js";

export function build(page, root) {
  const { steps } = page.run;
  if (!steps.length) return {};
  const items = steps.map(({ title, text }) => el("li", {}, el("b", {}, title), el("p", {}, text)));
  const box = el("div", { class: "tutorial" },
    el("ol", { class: "steps", "aria-label": "Steps of the tutorial" }, items),
    button("Take over", take, { class: "main", "data-tip": "Steer by hand from now on" }));
  root.append(box);
  let before = 0;

  // Takes control if need be, and has nothing more sent by the schedule.
  async function take() {
    try {
      if (!page.hasControl()) await page.do("take_control", {}, { quiet: true });
      await page.do("take_over", {}, { quiet: true });
    } catch (problem) {
      page.tell(problem.message);
      return;
    }
    box.hidden = true;
    page.openTab("Joints");
    document.querySelector(".joint").focus();
  }

  return {
    show({ time }) {
      if (time < before - 1) box.hidden = false; // A reset begins the schedule again.
      before = time;
      const now = steps.findLastIndex(({ begin }) => begin <= time);
      items.forEach((item, index) => {
        light(item, index < now, "done");
        set(item, { "aria-current": index === now ? "step" : null });
      });
    },
  };
}
