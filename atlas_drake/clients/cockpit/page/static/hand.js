// The goal of a hand in the view: arrows move it, rings turn it, a ghost of the arm shows what
// is reached, and a click on its ball lets the hand go there. Points and turns are in W.

import { seldom } from "./dom.js";
import { scene } from "./scene.js";

const ASK = 120;                  // Least time between two ghosts [ms].
const BALL = 0.035, LONG = 0.22, WIDE = 0.15, THIN = 0.006, FAT = 0.022; // [m]
const COLORS = ["#ff5d5d", "#4fd06b", "#5b9dff"]; // Of x, y and z.
const PALE = "#6db8ff";
const OPEN = "Drag an arrow to move the hand, a ring to turn it";
const TURNED = 3;                 // Difference of an orientation that is told [°].
const ALONG = 0.95, ACROSS = 0.1; // Arrows and rings seen from beyond are left alone [-].

let pale = null; // The ghost's material.

export function startHand(page) {
  const { THREE, viewer } = scene;
  const marks = new THREE.Group(), ghost = new THREE.Group(), turn = new THREE.Quaternion();
  const axes = COLORS.map((_, index) => new THREE.Vector3().setComponent(index, 1));
  const handles = makeHandles(axes);
  // What is found for a goal; `held` from a press on a handle on; `round` of asking for ghosts.
  let hand = null, found = null, held = null, round = 0;
  marks.add(...handles.map(({ mesh }) => mesh));
  viewer.scene.add(marks, ghost);
  close();

  const ask = seldom(ASK, async (goal, asked) => {
    if (asked !== round) return;
    const answer = await page.do("plan_hand", goal, { quiet: true }).catch(() => null);
    if (asked !== round || answer === null) return;
    found = answer;
    showGhost(ghost, found.links);
  });

  function pose() {
    const { x, y, z, w } = turn;
    return { hand: hand.link, position_W: marks.position.toArray(), orientation_W: [w, x, y, z] };
  }

  function close() {
    hand = held = null;
    marks.visible = false;
    drop();
  }

  function intoW() { return viewer.scene.matrixWorld.clone().invert(); }

  // Whether a drag says how far: not of an arrow seen from its tip, nor of a ring from its edge.
  function isUsable(ray) {
    const look = ray.direction.clone().transformDirection(intoW());
    return ({ axis, turns }) => {
      const along = axis ? Math.abs(look.dot(axis)) : 0;
      return turns ? along > ACROSS : along < ALONG;
    };
  }

  // Drops the ghost, and what is still asked for it.
  function drop() {
    round += 1;
    found = null;
    ghost.clear();
    viewer.set_dirty();
  }

  // Where a ray meets the axis, or the angle at which it meets the ring's plane.
  function measured(world, { axis, turns }) {
    const ray = world.clone().applyMatrix4(intoW());
    const from = held.from;
    if (!turns) {
      const far = from.clone().addScaledVector(axis, 10), on = new THREE.Vector3();
      ray.distanceSqToSegment(from.clone().addScaledVector(axis, -10), far, null, on);
      return on.sub(from).dot(axis);
    }
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(axis, from);
    const at = ray.intersectPlane(plane, new THREE.Vector3())?.sub(from);
    if (!at) return null;
    const [u, v] = axes.filter((one) => one !== axis);
    const sense = u.clone().cross(v).dot(axis);
    return sense * Math.atan2(at.dot(v), at.dot(u));
  }

  return {
    close,

    // Opens the goal of the hand of a limb; closes it if it is open.
    toggle(limb) {
      const wanted = page.run.hands.find((one) => one.limb === limb);
      const again = hand === wanted;
      close();
      if (again) return;
      hand = wanted;
      marks.visible = true;
    },

    limb() { return hand?.limb ?? null; },

    // Where it is in W, or null.
    goal() { return hand && marks.position; },

    // What of the goal a ray hits, the ball first, or null.
    under(caster) {
      if (!hand) return null;
      const hit = caster.intersectObjects(handles.map(({ mesh }) => mesh), true)
        .map(({ object }) => handles.find(
          ({ mesh }) => mesh === object || mesh === object.parent))
        .filter(isUsable(caster.ray));
      return hit.find(({ axis }) => !axis) ?? hit[0] ?? null;
    },

    // Takes a handle; returns whether it is the ball.
    press(handle, { ray }) {
      held = { handle, from: marks.position.clone(), turn: turn.clone() };
      held.at = handle.axis && measured(ray, handle);
      return !handle.axis;
    },

    drag({ ray }) {
      const { handle, from, at } = held ?? {};
      const now = handle?.axis ? measured(ray, handle) : null;
      if (now === null || at === null) return;
      if (handle.turns) {
        const about = new THREE.Quaternion().setFromAxisAngle(handle.axis, now - at);
        turn.copy(about.multiply(held.turn));
      } else marks.position.copy(from).addScaledVector(handle.axis, now - at);
      found ??= { near: true, angle: 0 };
      viewer.set_dirty();
      ask(pose(), round);
    },

    release() { held = null; },

    // Lets the hand go there.
    async send() {
      if (!found) return;
      const { link } = hand, asked = round;
      const duration = await page.do("move_hand", pose());
      if (duration === undefined) return;
      page.tell(`${link} gets there in ${duration.toFixed(1)} s`);
      if (asked === round) drop();
    },

    // Before each picture: a goal that nobody has moved stays at its hand.
    step() {
      const node = hand && !found && !held && nodeOf(hand.link);
      if (!node) return;
      const pose = intoW().multiply(node.object.matrixWorld);
      pose.decompose(marks.position, turn, new THREE.Vector3());
      marks.position.set(...hand.palm).applyMatrix4(pose);
    },

    hint() {
      if (!hand) return "";
      if (!found) return OPEN;
      if (!found.near) return `Out of reach by ${(1000 * found.distance).toFixed(0)} mm`;
      const degrees = found.angle * 180 / Math.PI;
      return "Click the ball and the hand goes there"
        + (degrees > TURNED ? `, ${degrees.toFixed(0)}° off` : "");
    },
  };
}

// A ball, and an arrow and a ring for each axis; each has a fat twin, unseen, to be hit.
function makeHandles(axes) {
  const { THREE } = scene;
  const made = (geometry, fat, color, more) => {
    const mesh = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial(
      { color, transparent: true, opacity: 0.85, depthTest: false, toneMapped: false }));
    const twin = new THREE.Mesh(fat);
    twin.visible = false; // A ray hits it all the same.
    mesh.add(twin);
    mesh.renderOrder = 1; // Over the robot.
    return { mesh, ...more };
  };
  const arrow = (axis, index) => {
    const outline = [[0, BALL], [THIN, BALL], [THIN, 0.75 * LONG], [0.02, 0.75 * LONG], [0, LONG]];
    const handle = made(
      new THREE.LatheGeometry(outline.map(([r, y]) => new THREE.Vector2(r, y)), 12),
      new THREE.CylinderGeometry(FAT, FAT, LONG - BALL).translate(0, 0.5 * (LONG + BALL), 0),
      COLORS[index], { axis });
    handle.mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), axis);
    return handle;
  };
  const ring = (axis, index) => {
    const handle = made(new THREE.TorusGeometry(WIDE, 0.6 * THIN, 8, 60),
                        new THREE.TorusGeometry(WIDE, 0.6 * FAT, 6, 30),
                        COLORS[index], { axis, turns: true });
    handle.mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), axis);
    return handle;
  };
  const ball = made(new THREE.SphereGeometry(BALL), new THREE.SphereGeometry(BALL), PALE);
  return [ball, ...axes.map(arrow), ...axes.map(ring)];
}

// Shows pale copies of links at their poses in W, by name.
function showGhost(ghost, links) {
  const { THREE, viewer } = scene;
  ghost.clear();
  pale ??= new THREE.MeshStandardMaterial(
    { color: PALE, transparent: true, opacity: 0.6, depthWrite: false });
  for (const [link, matrix] of Object.entries(links)) {
    const copy = nodeOf(link)?.object.clone();
    if (!copy) continue;
    copy.traverse((one) => { if (one.isMesh) one.material = pale; });
    copy.matrixAutoUpdate = false;
    copy.matrix.fromArray(matrix);
    ghost.add(copy);
  }
  viewer.set_dirty();
}

// The node of a link of the robot.
function nodeOf(link) {
  const search = (node) => {
    for (const [name, child] of Object.entries(node.children)) {
      const found = name.split("::").at(-1) === link ? child : search(child);
      if (found) return found;
    }
    return null;
  };
  const root = scene.find("/drake/visualizer");
  return root ? search(root) : null;
}
