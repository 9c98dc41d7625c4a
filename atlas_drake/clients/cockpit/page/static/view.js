// The 3D view, and what lies over it: camera, overlays, pushes, pictures, and whose a link is.

import { button, choice, el, form, light, set, tick, write } from "./dom.js";
import { CAMERAS, look, moveCamera } from "./camera.js";
import { startGamepad } from "./gamepad.js";
import { startHand } from "./hand.js";
import { icon } from "./icons.js";
import { showPlan } from "./plan.js";
import { push, startPointer } from "./pointer.js";
import { popover } from "./popover.js";
import { scene } from "./scene.js";

const RECORDING = "atlas_drake.html", PICTURE = "atlas_drake.png";
const DIRECTIONS = [[0, "ahead"], [90, "to the left"], [180, "back"], [-90, "to the right"]];
const LOOK = 200;     // Time between two looks at age and loading [ms].

export function build(page, root) {
  const div = el("div", { id: "view" });
  const hint = el("div", { class: "hint", id: "hint", role: "status" });
  const cameras = addCameras();
  const overlays = addOverlays(page);
  const record = addRecord(page);
  const card = addLinkCard(page);
  const fall = addFall(page);
  const picture = button([icon("picture"), "Picture"],
    async () => page.download(PICTURE, await scene.picture()),
    { "data-tip": "Save the 3D view as a picture" });
  root.append(el("div", { class: "view" }, div,
    el("div", { class: "over" }, cameras.group,
       el("div", { class: "tools" }, overlays.parts, page.log ? null : addPush(page), picture,
          record.opener)),
    card.box, hint, fall.box, addStatus(page)));

  const links = [...page.run.joints.flatMap((joint) => joint.links), ...page.run.pushed];
  let pointer = null, run = null;
  page.view = {
    look: cameras.look,
    aim: () => pointer?.aim(),
    sendPlan: () => pointer?.sendPlan(),
    dropPlan: () => pointer?.dropPlan(),
  };
  window.cockpit = Object.assign(scene, { page });
  scene.start(div).then(() => {
    look("Follow");
    scene.steps.push(moveCamera);
    if (page.log) return;
    scene.steps.push(startGamepad(page));
    page.view.hand = startHand(page);
    scene.steps.push(page.view.hand.step);
    pointer = startPointer(page, div, links, card.open, (text) => write(hint, text));
  });

  return {
    show(frame) {
      const first = !scene.robot;
      if (frame.run !== run) page.view.hand?.close(); // Time has jumped.
      run = frame.run;
      scene.robot = frame.robot;
      scene.level = frame.ground;
      if (first) look("Follow");
      if (scene.viewer) showPlan(page.walking.plan, frame.ground, page.run.sole);
      pointer?.show();
      overlays.show(frame);
      record.show(frame);
      card.show(frame);
      fall.show(frame);
    },
  };
}

function addCameras() {
  const buttons = CAMERAS.map((name) => button(name, () => choose(name), {
    "data-tip": name === "Follow" ? "Follow the robot (c)"
              : name === "Free" ? "Leave the camera where it is" : `Look from: ${name}`,
  }));
  const choose = (name) => {
    look(name);
    buttons.forEach((one, index) => set(one, { "aria-pressed": CAMERAS[index] === name }));
  };
  choose("Follow");
  return { look: choose,
           group: el("div", { class: "group", role: "group", "aria-label": "Camera" }, buttons) };
}

function addOverlays(page) {
  const opener = button([icon("layers"), "Show"], null,
                        { "data-tip": "Show what the controller thinks" });
  const texts = Object.entries(page.run.overlays).filter(([name]) => name !== "follow");
  const switches = texts.map(([name, text]) => {
    const { input, put } = tick({ role: "switch", "aria-label": name },
                                (on) => page.do("show", { overlay: name, on }));
    const label = el("label", {}, input, el("span", {}, el("b", {}, name), ` ${text}`));
    return { name, put, label };
  });
  const menu = popover(opener, "Show", ...switches.map(({ label }) => label));
  return { parts: [opener, menu], show(frame) {
    for (const { name, put } of switches) put(frame.overlays.includes(name));
  } };
}

function addPush(page) {
  const opener = button([icon("push"), "Push"], null,
                        { "data-tip": "Push by numbers; or drag from a link of the robot" });
  const body = choice(page.run.pushed.map((link) => [link, link]));
  const direction = choice(DIRECTIONS);
  const size = el("input", { type: "number", min: 0, step: "any", required: "", value: 20 });
  const now = () => {
    const angle = page.frame.robot[3] + Number(direction.value) * Math.PI / 180;
    const impulse = size.valueAsNumber;
    push(page, body.value, [impulse * Math.cos(angle), impulse * Math.sin(angle), 0]);
  };
  return [opener, popover(opener, "Push", form({}, now,
    el("label", {}, "Link", body),
    el("label", {}, "Direction", direction),
    el("label", {}, "Impulse [N·s]", size),
    button("Push now", null, { class: "main" })))];
}

function addRecord(page) {
  const name = el("span", {}, "Record");
  const opener = button([icon("record"), name], async () => {
    const on = !page.frame.recording;
    const text = await page.do("record", { on });
    if (text) page.download(RECORDING, text, "text/html");
  }, { "data-tip": "Record the 3D view from now on, as a web page" });
  return { opener, show({ recording }) {
    write(name, recording ? "Stop and save" : "Record");
    light(opener, recording, "recording");
  } };
}

// Says whose a link is, as long as it is open, and offers to take its joint or give it back.
function addLinkCard(page) {
  const { joints } = page.run;
  const title = el("b"), owner = el("span", { class: "dim" });
  let joint = 0;
  const give = (k_effort) => page.do("share", { joints: [joints[joint].name], k_effort });
  const take = button("Take it", () => give(255)), back = button("Give it back", () => give(0));
  const close = button(icon("close"), () => { box.hidden = true; },
                       { class: "tool", "aria-label": "Close" });
  const box = el("div", { class: "link", hidden: true }, title, close, owner,
                 el("div", { class: "row" }, take, back));
  const show = (frame) => {
    const share = frame.command.k_effort[joint];
    write(owner, { 0: "the behavior has it", 255: "you have it" }[share] ??
                 `shared, k_effort ${share}`);
    take.disabled = share === 255;
    back.disabled = share === 0;
  };
  const open = (link) => {
    const found = joints.findIndex((one) => one.links.includes(link));
    box.hidden = found < 0;
    if (box.hidden) return;
    joint = found;
    write(title, `${link}: ${joints[joint].name}`);
    show(page.frame);
  };
  return { box, open, show };
}

// After a fall: when, what failed first, and the way on.
function addFall(page) {
  const text = el("span");
  const box = el("div", { class: "fallen", role: "alert", hidden: true }, text,
                 page.log ? null : button("Reset (r)", () => page.do("reset"), { class: "main" }));
  return { box, show({ fallen, failure }) {
    box.hidden = !fallen;
    const fall = page.events.findLast(([, kind]) => kind === "fall");
    if (!fallen || !fall) return;
    write(text, `Fell at ${fall[0].toFixed(1)} s.${failure ? ` First: ${failure}` : ""}`);
  } };
}

// Age of the picture; that the robot loads, or that the connection is lost.
function addStatus(page) {
  const age = el("div", { class: "age", "data-tip": "Age of the picture" });
  const loading = el("div", { class: "loading", role: "status" }, "Loading the robot …");
  const lost = el("div", { class: "lost", role: "alert", hidden: true },
                  "No connection to the run; it is tried again each second");
  setInterval(() => {
    const old = Math.max(Date.now() / 1000 - page.frame?.sent, 0);
    write(age, old >= 0 ? `${old.toFixed(1)} s old` : "");
    lost.hidden = page.isConnected();
    loading.hidden ||= Boolean(scene.viewer) && scene.isComplete();
  }, LOOK);
  return [age, loading, lost];
}
