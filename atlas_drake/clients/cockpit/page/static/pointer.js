// What mouse and finger do in the view: a click on the ground plans a way and a second one walks
// it, a drag from a link pushes, a click on a link asks whose it is, a step is dragged, and so is
// the goal of a hand.

import { seldom, set, svg } from "./dom.js";
import { stepUnder } from "./plan.js";
import { scene } from "./scene.js";

const PUSH = 0.35;   // Impulse per pixel that a link is dragged [N·s].
const STILL = 6;     // Pointer moves below this are a click [pixel].
const HOVER = 120;   // Least time between two plans while the pointer moves [ms].
const FAR = 60;      // Farthest place on the ground [m].
const AIM = "Point at the ground: press to stop there, drag for the heading";
const PLANNED = "Click again to walk there; drag a footstep to move it; Esc drops the plan";

// Pushes a link by an impulse in W [N·s].
export async function push(page, body, impulse_W) {
  const speed = await page.do("push", { body, impulse_W });
  if (speed !== undefined) page.tell(`Pushed ${body}: ${speed.toFixed(2)} m/s`);
}

// Starts it. `links` are names; `open(link)` shows whose a link is; `hint(text)` helps.
export function startPointer(page, div, links, open, hint) {
  const names = new Set(links), { hand } = page.view;
  let pressed = null, aiming = false;
  const line = svg("path");
  div.after(svg("svg", { class: "arrow", "aria-hidden": true }, line));

  // While the pointer moves a refusal is not told.
  const tryTo = (name, values) => page.do(name, values, { quiet: true }).catch(() => {});
  const planSeldom = seldom(HOVER, (place) => { if (aiming) tryTo("plan_to", place); });
  const moveSeldom = seldom(HOVER, (step) => tryTo("move_step", step));
  const isPlanned = () => page.walking.plan.length > 0;

  function press(event) {
    if (event.button !== 0 || !event.isPrimary || !event.target.matches("canvas")) return;
    const handle = hand.under(ray(event));
    const what = handle ? { kind: "hand", goes: hand.press(handle, ray(event)) }
               : under(event, names, aiming);
    pressed = { what, x: event.clientX, y: event.clientY, moved: false };
    scene.viewer.controls.enabled = what.kind === "sky" || (what.kind === "ground" && !aiming);
  }

  function move(event) {
    if (!event.isPrimary) return;
    if (pressed === null) {
      const place = aiming && event.target.matches("#view canvas") && ground(event);
      if (place) planSeldom(place);
      return;
    }
    const { what, x, y } = pressed, dx = event.clientX - x, dy = event.clientY - y;
    pressed.moved ||= Math.hypot(dx, dy) > STILL;
    if (!pressed.moved) return;
    if (what.kind === "link") {
      const impulse = impulseOf(dx, dy), size = Math.hypot(...impulse);
      hint(`${what.name}: ${size.toFixed(0)} N·s, ${(size / page.run.mass).toFixed(2)} m/s; ` +
           "let go to push");
      arrow(dx, dy);
    } else if (what.kind === "hand") hand.drag(ray(event));
    else if (what.kind === "step" || aiming) {
      const now = ground(event);
      if (now && what.kind === "step") moveSeldom({ index: what.index, ...now });
      else if (now && what.kind === "ground") planSeldom({ ...what.place, yaw: to(what, now) });
    }
  }

  function release(event) {
    if (!event.isPrimary || pressed === null) return;
    const { what, x, y, moved } = pressed, aimed = aiming, now = ground(event);
    pressed = null;
    scene.viewer.controls.enabled = true;
    arrow();
    hand.release();
    if (event.type === "pointercancel") return;
    if (what.kind === "link") {
      const dx = event.clientX - x, dy = event.clientY - y;
      const isBack = Math.hypot(dx, dy) < STILL;
      if (!moved) open(what.name);
      else if (!isBack) push(page, what.name, impulseOf(dx, dy));
    } else if (what.kind === "hand") {
      if (!moved && what.goes) hand.send();
    } else if (what.kind === "step") {
      if (!moved) page.do("send_plan");
      else if (now) page.do("move_step", { index: what.index, ...now });
    } else if (what.kind === "ground" && aimed) {
      aiming = false;
      page.do("plan_to", moved && now ? { ...what.place, yaw: to(what, now) } : what.place);
    } else if (what.kind === "ground" && !moved) {
      if (isPlanned()) page.do("send_plan");
      else page.do("plan_to", what.place);
    }
  }

  // Draws the impulse, which lies in the plane of the picture, over it: at once, and on top.
  function arrow(dx, dy) {
    line.toggleAttribute("hidden", pressed === null || !pressed.moved);
    if (pressed === null) return;
    const box = div.getBoundingClientRect(), length = Math.max(Math.hypot(dx, dy), 15);
    const turn = Math.atan2(dy, dx) * 180 / Math.PI;
    set(line, {
      d: `M0 -2.5H${length - 14}V-9L${length} 0L${length - 14} 9V2.5H0z`,
      transform: `translate(${pressed.x - box.left} ${pressed.y - box.top}) rotate(${turn})`,
    });
  }

  div.addEventListener("pointerdown", press, true);
  window.addEventListener("pointermove", move, true);
  window.addEventListener("pointerup", release, true);
  window.addEventListener("pointercancel", release, true);

  return {
    aim() { aiming = true; },
    sendPlan() { if (isPlanned()) page.do("send_plan"); },
    // Drops also what is being dragged.
    dropPlan() {
      pressed = null;
      arrow();
      scene.viewer.controls.enabled = true;
      if (aiming || isPlanned()) tryTo("drop_plan");
      aiming = false;
      hand.close();
    },
    show() {
      const pushes = pressed?.moved && pressed.what.kind === "link";
      if (!pushes) hint(aiming ? AIM : hand.hint() || (isPlanned() ? PLANNED : ""));
    },
  };
}

function to(what, now) { return Math.atan2(now.y - what.place.y, now.x - what.place.x); }

function ray(event) {
  const box = scene.viewer.renderer.domElement.getBoundingClientRect();
  const made = new scene.THREE.Raycaster();
  made.setFromCamera(new scene.THREE.Vector2(
    2 * (event.clientX - box.left) / box.width - 1,
    1 - 2 * (event.clientY - box.top) / box.height), scene.viewer.camera);
  return made;
}

// What is under the pointer: a step of the plan, a link, the ground, or the sky. Who aims means
// the ground, also where the plan of the moment lies.
function under(event, links, aiming) {
  const made = ray(event), index = aiming ? null : stepUnder(made);
  const root = scene.find("/drake/visualizer");
  const hit = made.intersectObjects(root ? [root.object] : [], true).find(isShown);
  const link = hit && !aiming && linkOf(hit.object, root, links);
  if (link) return { kind: "link", name: link };
  if (index !== null) return { kind: "step", index };
  if (hit) return { kind: "ground", place: { x: hit.point.x, y: -hit.point.z } };
  const place = ground(event);
  return place ? { kind: "ground", place } : { kind: "sky" };
}

function isShown({ object }) {
  for (let one = object; one; one = one.parent) if (!one.visible) return false;
  return true;
}

// Name of the link that an object belongs to, by the path of its nodes.
function linkOf(object, root, links) {
  const names = new Map(), walk = (node) => {
    for (const [name, child] of Object.entries(node.children)) {
      names.set(child.object, name);
      walk(child);
    }
  };
  walk(root);
  for (let one = object; one; one = one.parent) {
    const name = (names.get(one) || "").split("::").reverse().find((part) => links.has(part));
    if (name) return name;
  }
  return null;
}

// Where the pointer is on the level of the robot's feet; null at the sky.
function ground(event) {
  const { origin, direction } = ray(event).ray;
  const t = ((scene.level || 0) - origin.y) / direction.y;
  if (!(t > 0 && t < FAR)) return null;
  const at = origin.clone().addScaledVector(direction, t);
  return { x: at.x, y: -at.z };
}

// The impulse lies in the plane of the picture [N·s], in W.
function impulseOf(dx, dy) {
  const { Vector3 } = scene.THREE, right = new Vector3(), up = new Vector3();
  scene.viewer.camera.matrixWorld.extractBasis(right, up, new Vector3());
  const v = right.multiplyScalar(dx).addScaledVector(up, -dy).multiplyScalar(PUSH);
  return [v.x, -v.z, v.y];
}
