// Footsteps of the plan that is not sent yet, as flat boxes on the ground.

import { FEET } from "./palette.js";
import { scene } from "./scene.js";

const THICK = 0.006, LIFT = 0.006; // Of the marks, and above the ground [m].
const OPACITY = 0.55;

let marks = [], shown = "";

// Shows a plan of [foot, x, y, yaw] at a height.
export function showPlan(plan, height, [length, width]) {
  const now = JSON.stringify([plan, height.toFixed(3)]);
  if (now === shown) return;
  shown = now;
  while (marks.length > plan.length) marks.pop().removeFromParent();
  plan.forEach(([foot, x, y, yaw], index) => {
    const mark = marks[index] ??= makeMark(length, width);
    mark.material.color.set(FEET[foot]);
    mark.position.set(x, y, height + LIFT); // The scene is in W.
    mark.rotation.z = yaw;
  });
  scene.viewer.set_dirty();
}

function makeMark(length, width) {
  const { THREE, viewer } = scene;
  const box = new THREE.BoxGeometry(length, width, THICK);
  const mark = new THREE.Mesh(box, new THREE.MeshBasicMaterial(
    { transparent: true, opacity: OPACITY, toneMapped: false }));
  mark.add(new THREE.LineSegments(new THREE.EdgesGeometry(box), new THREE.LineBasicMaterial(
    { color: "#10151c", toneMapped: false })));
  viewer.scene.add(mark);
  return mark;
}

// Index of the step that a ray hits first, from 1, or null.
export function stepUnder(ray) {
  const [hit] = ray.intersectObjects(marks, false);
  return hit ? marks.indexOf(hit.object) + 1 : null;
}
