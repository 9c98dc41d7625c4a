// The camera: it follows the robot, looks at it from a side, or is free; never from below.

import { scene } from "./scene.js";

const LAG = 0.4;      // Time constant of the camera that follows [s].
const LOWEST = 0.05;  // Least height of the camera and of what it looks at [m].
const LONGEST = 0.5;  // Longest time between two pictures that counts [s].

// From the robot to the camera, in the robot's heading [m].
const AWAY = { Follow: [2.1, -1.7, 0.45], Front: [2.8, 0, 0.3], Side: [0, -2.8, 0.3],
               Above: [0.01, 0, 3.6] };
export const CAMERAS = [...Object.keys(AWAY), "Free"];

let mode = "Follow", followed = null, turned = null;

export function look(name) {
  mode = name;
  if (!scene.robot || !scene.viewer || name === "Free") return;
  const [x, y, z, yaw] = scene.robot, { viewer } = scene, away = AWAY[name];
  const c = Math.cos(yaw), s = Math.sin(yaw);
  followed = scene.fromW(x, y, z);
  viewer.camera.position.copy(scene.fromW(
    x + c * away[0] - s * away[1], y + s * away[0] + c * away[1], z + away[2]));
  viewer.controls.target.copy(followed);
  viewer.set_dirty();
}

// Moves the camera before a picture.
export function moveCamera() {
  follow();
  stayAbove();
}

function follow() {
  const now = performance.now() / 1000, dt = Math.min(now - (turned ?? now), LONGEST);
  turned = now;
  if (!scene.robot || mode === "Free") { followed = null; return; }
  const goal = scene.fromW(...scene.robot);
  if (!followed) { followed = goal; return; }
  const step = goal.sub(followed).multiplyScalar(1 - Math.exp(-dt / LAG));
  if (step.length() < 1e-5) return;
  followed.add(step);
  scene.viewer.camera.position.add(step);
  scene.viewer.controls.target.add(step);
  scene.viewer.set_dirty();
}

// Keeps the camera above the ground, which would hide everything from below.
function stayAbove() {
  const { camera, controls } = scene.viewer, { target } = controls;
  const sunk = LOWEST - target.y;
  if (sunk > 0) {
    target.y += sunk;
    camera.position.y += sunk;
  }
  const away = camera.position.distanceTo(target);
  controls.maxPolarAngle = Math.acos(Math.max((LOWEST - target.y) / away, -1));
  if (sunk > 0 || camera.position.y < LOWEST - 1e-6) {
    controls.update();
    scene.viewer.set_dirty();
  }
}
