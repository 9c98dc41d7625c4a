// Joins Meshcat's viewer to the page: pictures in, pointer and gamepad out.
// The page's elements and commands are in Python; see atlas_drake/cockpit/page.
"use strict";

const cockpit = {
  PUSH: 0.35,        // Impulse per pixel that a link is dragged [N·s].
  STILL: 5,          // Pointer moves below this are a click [pixel].
  HOVER: 120,        // Least time between two plans while the pointer moves [ms].
  LAG: 0.4,          // Time constant of the camera that follows [s].
  QUICK: 40,         // A picture that takes less is drawn by a graphics card [ms].
  COARSE: 0.5,       // Size of the others.
  REST: 1000,        // Longest pause after one of the others [ms].
  LOWEST: 0.05,      // Least height of the camera and of what it looks at [m].

  CAPTION: "/Cameras/default/rotated/<object>/caption", // The page itself says it.

  tell(event, values) { emitEvent(event, values || {}); },

  start(links, mass, commands) {
    const div = document.getElementById("view");
    this.links = new Set(links);
    this.mass = mass;
    this.viewer = window.viewer = new MeshCat.Viewer(div, false); // draw() is its loop.
    this.THREE = MeshCat.THREE;
    this.followed = null;
    this.camera = "Follow";
    this.planned = false;
    this.rested = 0;
    for (const [light, intensity] of [["SpotLight", 30], ["PointLightNegativeX", 25],
        ["PointLightPositiveX", 25], ["AmbientLight", 0.3], ["FillLight", 0.5]]) {
      this.viewer.set_property(["Lights", light, "<object>"], "intensity", intensity);
    }
    this.connect();
    new ResizeObserver(() => this.viewer.set_3d_pane_size()).observe(div);
    if (commands) {
      div.addEventListener("pointerdown", (e) => this.press(e), true);
      div.addEventListener("pointermove", (e) => this.move(e), true);
      window.addEventListener("pointerup", (e) => this.release(e), true);
      window.addEventListener("keydown", (e) => this.key(e), true);
    }
    // A button that was clicked must not take the keys that come next.
    window.addEventListener("click", (e) => {
      if (e.detail && e.target.closest("button")) setTimeout(() => document.activeElement.blur());
    });
    const frame = () => {
      this.follow();
      this.stayAbove();
      this.viewer.animator.update();
      this.draw();
      if (commands) this.gamepad();
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  },

  // Draws one picture at a time. Without a graphics card a picture takes all cores for a part
  // of a second: it becomes coarser, and leaves time for a simulation on the same computer.
  draw() {
    const renderer = this.viewer.renderer, gl = renderer.getContext(), now = performance.now();
    if (this.drawing) {
      const { done, since } = this.drawing, took = now - since;
      if (gl.getSyncParameter(done, gl.SYNC_STATUS) !== gl.SIGNALED) return;
      gl.deleteSync(done);
      this.drawing = null;
      this.slow = took > this.QUICK;
      if (this.slow) this.rested = now + Math.min(took, this.REST);
    }
    if (!this.viewer.needs_render || now < this.rested) return;
    const pixels = (this.slow ? this.COARSE : 1) * window.devicePixelRatio;
    if (renderer.getPixelRatio() !== pixels) renderer.setPixelRatio(pixels);
    this.viewer.render();
    this.drawing = { done: gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0), since: now };
    gl.flush();
  },

  connect() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}/meshcat`);
    socket.binaryType = "arraybuffer";
    socket.onmessage = (message) => {
      if (typeof message.data === "string") { this.beat(JSON.parse(message.data)); return; }
      const command = this.viewer.decode(message);
      if (!["realtime_rate", "show_realtime_rate", "set_control", "set_control_value",
            "delete_control", "set_animation"].includes(command.type) &&
          !(command.path || "").includes(this.CAPTION)) {
        this.viewer.handle_command(command);
      }
    };
    socket.onclose = () => {
      document.getElementById("age").textContent = "no connection";
      setTimeout(() => this.connect(), 1000);
    };
    this.viewer.connection = { send() {}, readyState: 0 };
  },

  beat(beat) {
    const age = Math.max(beat.age + Date.now() / 1000 - beat.sent, 0);
    document.getElementById("age").textContent = `${age.toFixed(1)} s old`;
    this.robot = beat.robot;
    this.level = beat.ground; // Height of the lower sole [m].
  },

  // ---- what the browser remembers ----------------------------------------

  remember(name, value) {
    const kept = JSON.parse(localStorage.getItem("cockpit") || "{}");
    localStorage.setItem("cockpit", JSON.stringify({ ...kept, [name]: value }));
  },

  recall() { this.tell("remembered", JSON.parse(localStorage.getItem("cockpit") || "{}")); },

  // ---- camera ------------------------------------------------------------

  // Three's y points up; z of W is its y, and y of W its -z.
  fromW(x, y, z) { return new this.THREE.Vector3(x, z, -y); },

  // Where a point of W is on the page [pixel].
  onPage(x, y, z) {
    const at = this.fromW(x, y, z).project(this.viewer.camera);
    const box = this.viewer.renderer.domElement.getBoundingClientRect();
    return [box.left + 0.5 * (1 + at.x) * box.width, box.top + 0.5 * (1 - at.y) * box.height];
  },

  look(name) {
    this.camera = name;
    if (!this.robot || name === "Free") return;
    const [x, y, z, yaw] = this.robot, viewer = this.viewer;
    const middle = this.fromW(x, y, z);
    const away = { Front: [3.6, 0, 0.35], Side: [0, -3.6, 0.35], Above: [0.01, 0, 4.2],
                   Follow: [2.7, -2.2, 0.6] }[name];
    const c = Math.cos(yaw), s = Math.sin(yaw);
    const to = this.fromW(x + c * away[0] - s * away[1], y + s * away[0] + c * away[1],
                          z + away[2]);
    viewer.camera.position.copy(to);
    viewer.controls.target.copy(middle);
    this.followed = middle;
    viewer.set_dirty();
  },

  follow() {
    const now = performance.now() / 1000, dt = Math.min(now - (this.turned || now), 0.5);
    this.turned = now;
    if (!this.robot || this.camera === "Free") { this.followed = null; return; }
    const [x, y, z] = this.robot, goal = this.fromW(x, y, z);
    if (!this.followed) { this.followed = goal; return; }
    const step = goal.sub(this.followed).multiplyScalar(1 - Math.exp(-dt / this.LAG));
    if (step.length() < 1e-5) return;
    this.followed.add(step);
    this.viewer.camera.position.add(step);
    this.viewer.controls.target.add(step);
    this.viewer.set_dirty();
  },

  // Keeps the camera above the ground, which would hide everything from below.
  stayAbove() {
    const { camera, controls } = this.viewer, target = controls.target;
    const sunk = this.LOWEST - target.y;
    if (sunk > 0) {
      target.y += sunk;
      camera.position.y += sunk;
    }
    const away = camera.position.distanceTo(target);
    controls.maxPolarAngle = Math.acos(Math.max((this.LOWEST - target.y) / away, -1));
    if (sunk > 0 || camera.position.y < this.LOWEST - 1e-6) {
      controls.update();
      this.viewer.set_dirty();
    }
  },

  save() {
    this.viewer.render();
    const link = document.createElement("a");
    link.href = this.viewer.renderer.domElement.toDataURL();
    link.download = "atlas_drake.png";
    link.click();
  },

  // ---- what the pointer is over --------------------------------------------

  ray(e) {
    const box = this.viewer.renderer.domElement.getBoundingClientRect();
    const ray = new this.THREE.Raycaster();
    ray.setFromCamera(new this.THREE.Vector2(
      2 * (e.clientX - box.left) / box.width - 1,
      1 - 2 * (e.clientY - box.top) / box.height), this.viewer.camera);
    return ray;
  },

  paths() {
    const found = new Map(), walk = (node, path) => {
      found.set(node.object, path);
      for (const name in node.children) walk(node.children[name], [...path, name]);
    };
    walk(this.viewer.scene_tree, []);
    return found;
  },

  // Returns what is under the pointer: a link, a step of the plan, or the ground.
  under(e) {
    const ray = this.ray(e), paths = this.paths();
    const roots = [["drake", "visualizer"], ["atlas_drake", "planned"]].map(
      (path) => this.viewer.scene_tree.find(path).object);
    let spot = null;
    for (const hit of ray.intersectObjects(roots, true)) {
      let object = hit.object, shown = true;
      for (let o = hit.object; o; o = o.parent) shown = shown && o.visible;
      if (!shown) continue;
      while (object && !paths.has(object)) object = object.parent;
      const path = paths.get(object) || [];
      const link = path.flatMap((part) => part.split("::")).reverse()
        .find((part) => this.links.has(part));
      if (link) return { kind: "link", name: link, point: hit.point };
      if (path[1] === "planned") return { kind: "step", index: Number(path[2]) + 1 };
      spot = spot || hit.point;
    }
    if (spot) return { kind: "ground", x: spot.x, y: -spot.z };
    const place = this.ground(e);
    return place ? { kind: "ground", ...place } : { kind: "sky" };
  },

  // Where the pointer is on the level of the robot's feet; null at the sky.
  ground(e) {
    const r = this.ray(e).ray, t = ((this.level || 0) - r.origin.y) / r.direction.y;
    if (!(t > 0 && t < 60)) return null;
    const p = r.origin.clone().addScaledVector(r.direction, t);
    return { x: p.x, y: -p.z };
  },

  // ---- what it does ----------------------------------------------------------

  press(e) {
    if (e.button !== 0 || e.target !== this.viewer.renderer.domElement) return;
    const what = this.under(e);
    this.pressed = { what, x: e.clientX, y: e.clientY, moved: false };
    const turnsCamera = what.kind === "sky" || (what.kind === "ground" && !this.aiming);
    this.viewer.controls.enabled = turnsCamera;
  },

  move(e) {
    const p = this.pressed;
    if (!p) {
      if (this.aiming && Date.now() - (this.hovered || 0) > this.HOVER) {
        this.hovered = Date.now();
        const what = this.under(e);
        if (what.kind === "ground") this.tell("ground", { x: what.x, y: what.y });
      }
      return;
    }
    const dx = e.clientX - p.x, dy = e.clientY - p.y;
    p.moved = p.moved || Math.hypot(dx, dy) > this.STILL;
    if (!p.moved) return;
    if (p.what.kind === "link") {
      const impulse = this.impulse(p, dx, dy), size = Math.hypot(...impulse);
      this.hint(`${p.what.name}: ${size.toFixed(0)} N·s, ` +
                `${(size / this.mass).toFixed(2)} m/s; let go to push`);
      this.arrow(p.what.point, impulse);
    } else if (Date.now() - (this.hovered || 0) > this.HOVER) {
      this.hovered = Date.now();
      const now = this.ground(e);
      if (!now) return;
      if (p.what.kind === "step") {
        this.tell("plan_step", { index: p.what.index, ...now });
      } else if (p.what.kind === "ground" && this.aiming) {
        const yaw = Math.atan2(now.y - p.what.y, now.x - p.what.x);
        this.tell("ground", { x: p.what.x, y: p.what.y, yaw });
      }
    }
  },

  release(e) {
    const p = this.pressed;
    this.pressed = null;
    if (!p) return;
    this.viewer.controls.enabled = true;
    this.arrow(null);
    const what = p.what;
    if (what.kind === "link" && p.moved) {
      const impulse = this.impulse(p, e.clientX - p.x, e.clientY - p.y);
      this.tell("push", { name: what.name, impulse });
      this.hint("");
    } else if (what.kind === "link") {
      this.tell("link", { name: what.name });
    } else if (what.kind === "step" && p.moved) {
      const now = this.ground(e);
      if (now) this.tell("plan_step", { index: what.index, ...now });
    } else if (what.kind === "step") {
      this.send();
    } else if (what.kind === "ground" && (this.aiming || !p.moved)) {
      if (this.planned && !p.moved) { this.send(); return; }
      if (!p.moved) this.tell("ground", { x: what.x, y: what.y });
      this.planned = true;
      this.aiming = false;
      this.hint("Click again to walk there; drag a footstep to move it; Esc drops the plan");
    }
  },

  send() { this.tell("plan_send"); this.planned = false; this.hint(""); },

  key(e) {
    if (["INPUT", "TEXTAREA", "SELECT"].includes(e.target.tagName)) return;
    if (e.key === "Escape") document.activeElement.blur(); // STOP, wherever one is.
    if (e.key === "g") {
      this.aiming = true;
      this.planned = false;
      this.hint("Point at the ground: press to stop there, drag for the heading");
    } else if (e.key === "Escape" && (this.planned || this.aiming)) {
      this.planned = this.aiming = false;
      this.tell("plan_drop");
      this.hint("");
      e.stopPropagation(); // It is STOP for the page.
    } else if (e.key === "Enter" && this.planned) {
      this.send();
    }
  },

  hint(text) { document.getElementById("hint").textContent = text; },

  // The impulse lies in the plane of the picture [N·s], in W.
  impulse(p, dx, dy) {
    const right = new this.THREE.Vector3(), up = new this.THREE.Vector3();
    this.viewer.camera.matrixWorld.extractBasis(right, up, new this.THREE.Vector3());
    const v = right.multiplyScalar(dx).addScaledVector(up, -dy).multiplyScalar(this.PUSH);
    return [v.x, -v.z, v.y];
  },

  arrow(from, impulse) {
    const scene = this.viewer.scene_tree.find(["Cameras"]).object.parent;
    if (this.shaft) { this.shaft.parent.remove(this.shaft); this.shaft = null; }
    if (from) {
      const way = this.fromW(...impulse), length = 0.01 * way.length();
      this.shaft = new this.THREE.ArrowHelper(way.normalize(), from, length, 0xd02020);
      let root = scene;
      while (root.parent) root = root.parent;
      root.add(this.shaft);
      // The scene is turned so that z points up; the arrow is in the browser's axes.
      this.shaft.applyMatrix4(root.matrixWorld.clone().invert());
    }
    this.viewer.set_dirty();
  },

  // ---- gamepad -----------------------------------------------------------------

  gamepad() {
    const pads = navigator.getGamepads ? [...navigator.getGamepads()] : [];
    const pad = pads.find((one) => one && one.connected);
    if (!pad) return;
    const share = (i) => { // Coarse, so that tremor sends nothing.
      const value = -Math.max(-1, Math.min(1, pad.axes[i] || 0));
      return Math.abs(value) < 0.25 ? 0 : Math.round(4 * value) / 4;
    };
    const stick = { forward: share(1), left: share(0), turn: share(2) };
    const now = JSON.stringify(stick);
    if (now !== (this.stick || '{"forward":0,"left":0,"turn":0}')) this.tell("stick", stick);
    this.stick = now;
  },
};
