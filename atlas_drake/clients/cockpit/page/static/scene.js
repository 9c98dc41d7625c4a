// Meshcat's scene in the page: its objects come in by a websocket, and one loop draws them.
// Lengths are in m, points in W, whose z axis points up.

import { el } from "./dom.js";

const QUICK = 40;      // A picture that takes less is drawn by a graphics card [ms].
const COARSE = 0.5;    // Size of the others, as a part of the window's pixels.
const REST = 1000;     // Longest pause after one of the others [ms].
const AGAIN = 1000;    // Until what failed is tried again [ms].
const TRIES = 20;      // How often a file that failed is asked for.
const LIGHTS = [["SpotLight", 30], ["PointLightNegativeX", 25], ["PointLightPositiveX", 25],
                ["AmbientLight", 0.3], ["FillLight", 0.5]];
// What Meshcat may do here; its controls, callbacks and camera stay out.
const SHOWN = new Set(["set_transform", "set_object", "set_property", "delete"]);
const CAMERA = "/Cameras";
const ROBOT = "/drake/visualizer";
const PICTURE = [1280, 720]; // Least size of a picture that is saved [pixel].

export const scene = {
  viewer: null, THREE: null,
  slow: false,      // True without a graphics card.
  drawing: null, rested: 0,
  wanted: new Map(), // Objects that have been sent, by path: the command.
  tried: new Map(),  // Files that failed, by address: how often.
  loading: false,    // True while files come in.
  steps: [],         // Functions called before each picture.

  async start(div) {
    while (!await hasScript("meshcat.js")) await new Promise((done) => setTimeout(done, AGAIN));
    const { MeshCat } = window;
    this.THREE = MeshCat.THREE;
    this.viewer = window.viewer = new MeshCat.Viewer(div, false); // draw() is its loop.
    this.viewer.connection = { send() {}, readyState: 0 };
    for (const [light, intensity] of LIGHTS) {
      this.viewer.set_property(["Lights", light, "<object>"], "intensity", intensity);
    }
    const manager = this.THREE.DefaultLoadingManager;
    manager.onStart = () => { this.loading = true; };
    manager.onLoad = () => { this.loading = false; };
    manager.onError = (url) => this.retry(url);
    new ResizeObserver(() => this.viewer.set_3d_pane_size()).observe(div);
    this.connect();
    const frame = () => {
      requestAnimationFrame(frame);
      for (const step of this.steps) step();
      this.draw();
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
      this.slow = took > QUICK;
      if (this.slow) this.rested = now + Math.min(took, REST);
    }
    if (!this.viewer.needs_render || now < this.rested) return;
    const pixels = (this.slow ? COARSE : 1) * window.devicePixelRatio;
    if (renderer.getPixelRatio() !== pixels) renderer.setPixelRatio(pixels);
    this.viewer.render();
    this.drawing = { done: gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0), since: now };
    gl.flush();
  },

  connect() {
    const socket = new WebSocket(`meshcat${location.search}`);
    socket.binaryType = "arraybuffer";
    socket.onmessage = (message) => {
      if (typeof message.data !== "string") this.take(this.viewer.decode(message));
    };
    socket.onclose = () => setTimeout(() => this.connect(), AGAIN);
  },

  take(command) {
    const path = command.path || "";
    if (!SHOWN.has(command.type) || path.startsWith(CAMERA)) return;
    if (command.type === "set_object") this.wanted.set(path, command);
    if (command.type === "delete") {
      for (const one of this.wanted.keys()) {
        if (one === path || one.startsWith(`${path}/`)) this.wanted.delete(one);
      }
    }
    this.viewer.handle_command(command);
  },

  // Sends for the objects again that a file failed of.
  retry(url) {
    const tries = (this.tried.get(url) ?? 0) + 1;
    this.tried.set(url, tries);
    if (tries > TRIES) return;
    const needy = [...this.wanted.values()].filter(
      (command) => textOf(command.object?.object?.data).includes(url));
    setTimeout(() => needy.forEach((command) => this.viewer.handle_command(command)), AGAIN);
  },

  // True if all that was sent of the robot has come in.
  isComplete() {
    const own = [...this.wanted.keys()].filter((path) => path.startsWith(ROBOT));
    const hasCome = (path) => this.find(path)?.children["<object>"];
    return !this.loading && own.length > 0 && own.every(hasCome);
  },

  // The node of a path, or undefined.
  find(path) {
    const parts = path.split("/").filter(Boolean);
    return parts.reduce((node, part) => node?.children[part], this.viewer.scene_tree);
  },

  // Three's y points up; z of W is its y, and y of W its -z.
  fromW(x, y, z) { return new this.THREE.Vector3(x, z, -y); },

  // Where a point of W is on the page [pixel].
  onPage(x, y, z) {
    const at = this.fromW(x, y, z).project(this.viewer.camera);
    const box = this.viewer.renderer.domElement.getBoundingClientRect();
    return [box.left + 0.5 * (1 + at.x) * box.width, box.top + 0.5 * (1 - at.y) * box.height];
  },

  // Draws a fine picture, and returns it as a file.
  picture() {
    const { viewer } = this, { renderer } = viewer, before = renderer.getPixelRatio();
    const { offsetWidth: width, offsetHeight: height } = viewer.dom_element;
    const [least, high] = PICTURE;
    renderer.setPixelRatio(Math.max(window.devicePixelRatio, least / width, high / height));
    viewer.render();
    return new Promise((done) => renderer.domElement.toBlob(done)).finally(() => {
      renderer.setPixelRatio(before);
      viewer.set_dirty();
    });
  },
};

function hasScript(source) {
  return new Promise((done) => {
    document.head.append(el("script", {
      src: source, onload: () => done(true), onerror: () => done(false) }));
  });
}

function textOf(data) {
  return typeof data === "string" ? data : data ? new TextDecoder().decode(data) : "";
}
