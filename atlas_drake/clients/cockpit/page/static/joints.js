// Who has which joint: the figure, presets, the user's share of a limb, and its joints.

import { button, el, form, set, tick, write } from "./dom.js";
import { dial } from "./dials.js";
import { figure, MOST, ownerColor } from "./figure.js";
import { slider } from "./numbers.js";
import { BEHAVIOR, SHARED, USER } from "./palette.js";
import { popover } from "./popover.js";

const ARMS = ["l_arm", "r_arm"];

export function build(page, root) {
  const joints = page.run.joints;
  const limbs = [...new Set(joints.map((joint) => joint.limb))];
  const all = joints.map((_, i) => i);
  const of = (...chosen) => all.filter((i) => chosen.includes(joints[i].limb));
  let limb = "", shares = all.map(() => 0), share = null, dials = [], policys = [];

  const give = (indices, share) => page.do("share", {
    joints: indices.map((i) => joints[i].name), k_effort: share });
  const picture = figure(joints, (index, only) => {
    choose(joints[index].limb);
    if (!only && !page.log) give([index], shares[index] ? 0 : MOST);
  }, (pressed, only) => {
    const again = pressed === limb && !only && !page.log;
    choose(pressed);
    if (again) give(of(limb), of(limb).every((i) => shares[i]) ? 0 : MOST);
  });
  const scale = `linear-gradient(90deg, ${BEHAVIOR}, ${SHARED}, ${USER})`;
  const part = el("div", { class: "share", style: { "--scale": scale } });
  const value = el("span", { class: "number" });
  const box = el("div", { class: "dials" });
  const poses = poseMenu(page), watchdog = watchdogSwitch(page);
  const handButton = button("Move hand", () => page.view.hand?.toggle(limb), {
    "data-tip": "Drag the hand of this arm to where it has to go, in the view" });
  root.append(
    el("div", { class: "who" }, picture.element, page.log ? null : presets()),
    part,
    el("p", { class: "dim told" }, "Knob set-point, tick measured [rad], bar effort"),
    box, watchdog.element);

  function presets() {
    const tips = [
      ["Arms mine", "Take both arms; the behavior keeps its balance with the rest",
       () => give(of(...ARMS), MOST)],
      ["All mine", "Take every joint: nobody balances but you", () => give(all, MOST)],
      ["None mine", "Give every joint back to the behavior", () => give(all, 0)],
      ["Hold", "Your joints stay where they are, with the robot's gains", () => page.do("hold")],
      ["Go limp", "Your joints lose their stiffness, and keep their damping",
       () => page.do("go_limp")],
    ];
    return el("div", { class: "presets" },
      tips.map(([text, tip, press]) => button(text, press, { "data-tip": tip })),
      handButton, poses.opener, poses.menu);
  }

  function choose(chosen) {
    if (chosen === limb) return;
    limb = chosen;
    share = slider({ min: 0, max: MOST, step: 1, value: 0, disabled: page.log,
                     "aria-label": `k_effort of ${limb}`,
                     "data-tip": "Your share of the limb: 0 is the behavior's, 255 yours" },
                   (kEffort) => give(of(chosen), kEffort));
    part.replaceChildren(el("b", {}, limb), share.input, value);
    dials = of(limb).map((i) => dial(page, joints[i], i));
    box.replaceChildren(...dials.map((one) => one.element));
    draw();
    if (page.frame) showDials(page.frame);
  }

  function showDials(frame) { dials.forEach((one) => one.show(frame)); }

  function draw() {
    picture.show(shares, limb, policys);
    const own = of(limb).map((i) => shares[i]);
    share.put(Math.max(...own));
    set(share.input, { style: { "--owner": ownerColor(Math.max(...own)) } });
    write(value, own.every((one) => one === own[0]) ? String(own[0]) : "mixed");
  }

  choose(limbs.includes("r_arm") ? "r_arm" : limbs[0]);
  return {
    show(frame) {
      shares = frame.command.k_effort;
      policys = frame.policy?.runs ? frame.policy.joints : [];
      watchdog.show(frame.policy);
      draw();
      showDials(frame);
      poses.show(page.poses);
      handButton.disabled = !page.run.hands.some((one) => one.limb === limb);
      set(handButton, { "aria-pressed": page.view.hand?.limb() === limb });
    },
  };
}

// Whether STAND takes the joints of a policy that has died.
function watchdogSwitch(page) {
  const { input, put } = tick({}, (on) => page.do("watch_policy", { on }));
  const element = el("label", {
    "data-tip": "STAND takes all joints when the policy's commands are late, no numbers, or "
      + "far beyond a joint's stop" }, input, " Watchdog over the policy");
  return {
    element,
    show(policy) {
      element.hidden = !policy;
      if (policy) put(policy.watched);
    },
  };
}

// Poses that the user's joints can go to, and a name for a new one.
function poseMenu(page) {
  const opener = button("Pose", null, {
    "data-tip": "Move your joints to a saved pose, or save the present one" });
  const list = el("div", { class: "presets" });
  const name = el("input", { placeholder: "Name of the present pose", "aria-label": "Save as",
                             maxlength: 40, required: "" });
  const menu = popover(opener, "Pose", list, form({ class: "save" }, async () => {
    const done = await page.do("save_pose", { name: name.value });
    if (done !== undefined) name.value = "";
  }, name, button("Save")));
  let shown = "";
  return {
    opener, menu,
    show(poses) {
      if (shown === String(poses)) return;
      shown = String(poses);
      list.replaceChildren(...poses.map((pose) => button(`Go to ${pose}`, () => {
        menu.hidePopover();
        page.do("go_to_pose", { name: pose });
      })));
    },
  };
}
