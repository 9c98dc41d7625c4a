// The bar at the top: what runs, its time and the controls of time, and who steers.

import { button, choice, el, form, light, set, write } from "./dom.js";
import { icon, swapIcon } from "./icons.js";
import { KEY_TEXTS } from "./keys.js";
import { popover } from "./popover.js";

const PACES = [[0.1, "0.1 ×"], [0.25, "0.25 ×"], [0.5, "0.5 ×"], [1, "1 ×"], [2, "2 ×"],
               [0, "max"]];

export function build(page, root) {
  const mode = el("span", { class: "mode", role: "status", "aria-label": "Mode" });
  const time = el("span", { class: "number", "aria-label": "Time", role: "timer" });
  const speed = el("span", { class: "number dim", "aria-label": "Speed", role: "note",
    "data-tip": "Simulated seconds per second of real time, and the time that the computer " +
                "needs for one tick of the controller" });
  const pause = tool("pause", "Pause", "Pause or go on (space)",
                     () => page.do("pause", { on: !page.frame?.paused }));
  const pace = addPace(page);
  const steer = button("", () => page.do(page.hasControl() ? "release_control" : "take_control"),
                       { class: "steer", "aria-label": "Steering", hidden: page.log });
  root.append(
    el("span", { class: "robot", "data-tip": `Scenario ${page.run.title}` }, page.run.robot),
    mode, time, speed, el("span", { class: "space" }),
    el("div", { class: "tools" },
       pause,
       tool("step", "Single step", "Single step of 20 ms (n)", () => page.do("step")),
       pace.select,
       tool("back", "Back 10 s", "Back 10 s: the run goes on from there (b)",
            () => page.do("back"), "10 s"),
       tool("reset", "Reset", "Reset (r)", () => page.do("reset"), "Reset"),
       page.log ? null : addNewRun(page)),
    steer,
    el("div", { class: "tools" }, addKeys(page), addTheme(page)));

  return {
    show(frame) {
      const going = frame.behavior === frame.desired ? "" : ` → ${frame.desired}`;
      const stopping = page.stopping !== null && !frame.fallen;
      write(mode, frame.fallen ? "FALLEN" : stopping ? "stopping …" : frame.behavior + going);
      light(mode, frame.fallen || stopping, "alarm");
      write(time, `${frame.time.toFixed(1)} s`);
      const rate = frame.paused ? "paused" : `${frame.rate.toFixed(2)} × real time`;
      write(speed, frame.tick_ms ? `${rate} · tick ${frame.tick_ms.toFixed(1)} ms` : rate);
      swapIcon(pause.firstChild, frame.paused ? "play" : "pause");
      light(pause, frame.paused);
      pace.show(frame.pace);
      const [text, tip] = steering(page.session);
      write(steer, text);
      set(steer, { "data-tip": tip, disabled: !page.session.may_steer });
      light(steer, page.session.asked, "asked");
    },
  };
}

function tool(picture, name, tip, press, text = null) {
  return button([icon(picture), text], press,
                { class: "tool", "aria-label": name, "data-tip": tip });
}

function addPace(page) {
  const select = choice(PACES, { "aria-label": "Pace", class: "pace",
    "data-tip": "Pace: simulated time as a multiple of real time, as far as the computer can",
    onchange: () => page.do("rate", { rate: Number(select.value) }) });
  return { select, show(pace) {
    if (select.value === String(pace)) return;
    select.value = pace;
    if (select.selectedIndex >= 0) return;
    select.append(el("option", { value: pace }, `${pace} ×`));
    select.value = pace;
  } };
}

function addNewRun(page) {
  const opener = tool("begin", "New run", "Begin again with another seed", null, "New run");
  const seed = el("input", { type: "number", min: 0, required: "", value: 0 });
  const menu = popover(opener, "New run",
    el("p", { class: "dim" }, "The same scenario from its start, with other noise"),
    form({}, () => {
      menu.hidePopover();
      page.do("reset", { seed: seed.valueAsNumber });
    }, el("label", {}, "Seed", seed), button("Begin", null, { class: "main" })));
  return [opener, menu];
}

function addKeys(page) {
  const opener = tool("keys", "Keys", "The keys (?)", null, "Keys");
  const rows = KEY_TEXTS.map(([key, text]) => [
    el("kbd", {}, key), el("span", {}, text.replaceAll("_", " "))]);
  const menu = popover(opener, "Keys", el("h2", {}, "Keys"), el("div", { class: "keys" }, rows),
    el("p", { class: "dim" }, "The robot walks in a direction until the next key. " +
                              "A gamepad's sticks steer while they are held."));
  page.showKeys = () => menu.togglePopover();
  return [opener, menu];
}

function addTheme(page) {
  let dark = page.recall("dark") ?? matchMedia("(prefers-color-scheme: dark)").matches;
  const show = () => { document.documentElement.dataset.theme = dark ? "dark" : "light"; };
  show();
  return tool("theme", "Dark or light", "Dark or light", () => {
    dark = !dark;
    page.remember("dark", dark);
    show();
  });
}

// What the button says of who steers, and its tip.
function steering({ may_steer: may, control, asked, asking }) {
  if (!may) return ["You watch", "Steering needs the token of the printed address"];
  if (control === "nobody") return ["Steer", "Nobody steers: take control"];
  if (control === "you") {
    return asked ? ["Hand over", "Somebody asks to steer: hand over"]
                 : ["You steer", "Press to let others steer"];
  }
  return asking ? ["Asked …", "You steer when the other lets go or is idle for 30 s"]
                : ["Ask to steer", "Somebody else steers: ask for it"];
}
