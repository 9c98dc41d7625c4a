// The page: what it knows of the run, what it asks of it, and what it tells.
// Each panel gets `page`; see layout.js for the panels.

import { el } from "./dom.js";
import { buildLayout } from "./layout.js";
import { startKeys } from "./keys.js";
import { startTips } from "./tips.js";

const ALARMS = new Set(["refusal", "warning", "fall", "recovery"]); // Kinds of events told.
const RECENT = 1;          // Age beyond which they are not [s of simulated time].
const TOLD = 4000;         // How long a notice stays [ms].
const SPAN = 60;           // Time that is kept of the moments [s].
const AGAIN = 1000;        // Until a lost connection is tried again [ms].
const ACKNOWLEDGED = 600;  // Shortest time that "stopping" shows [ms].
const REST = ["STAND", "FREEZE", "STAND_PREP"]; // What STOP ends in, besides a fall.
const ORDERS = ["behave", "walk", "send_plan", "reset", "back", "start"]; // End "stopping".

const listeners = {}, waiting = new Map();
let socket = null, count = 0, panels = [], due = null;

export const page = {
  run: null, frame: null, walking: { direction: null, gait: {}, plan: [] }, poses: [],
  settings: null, events: [], moments: [], log: false,
  changes: {}, // Settings that wait for a restart, in this page alone: text by path.
  session: { may_steer: false, control: "nobody", asked: false, asking: false },
  stopping: null, // Since when, or null [ms].

  hasControl() { return page.session.control === "you"; },

  isConnected() { return socket.readyState === WebSocket.OPEN; },

  // Asks for something. A refusal is told and gives undefined; with `quiet` it rejects.
  async do(name, values = {}, { quiet = false } = {}) {
    if (ORDERS.includes(name) || values.atlas_sim_interface_command) stopped();
    try {
      return await ask(name, values);
    } catch (problem) {
      if (quiet) throw problem;
      page.tell(problem.message);
      return undefined;
    }
  },

  // Comes to rest; says so before anything has answered.
  stop() {
    if (page.session.may_steer && !page.log) stopping();
    ask("stop", {}).catch((problem) => { stopped(); page.tell(problem.message); });
  },

  tell(text, lasting = false) {
    const notices = document.getElementById("notices");
    if ([...notices.children].some((one) => one.textContent === text)) return;
    const notice = el("p", { class: lasting ? "notice lasting" : "notice",
                             onclick: () => notice.remove() }, text);
    notices.append(notice);
    notices.hidePopover(); // Shown anew it is above all else.
    notices.showPopover();
    if (!lasting) setTimeout(() => notice.remove(), TOLD);
  },

  // Calls a function when events, settings or changes are others.
  on(kind, fn) { (listeners[kind] ??= []).push(fn); },

  setChanges(changes) {
    page.changes = changes;
    emit("changes");
  },

  download(name, text, type = "text/plain") {
    const url = URL.createObjectURL(text instanceof Blob ? text : new Blob([text], { type }));
    el("a", { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10_000);
  },

  remember(key, value) {
    const kept = { ...memory(), [key]: value };
    try { localStorage.setItem("cockpit", JSON.stringify(kept)); } catch { /* Forbidden. */ }
  },

  recall(key) { return memory()[key]; },
};

function memory() {
  try { return JSON.parse(localStorage.getItem("cockpit")) || {}; } catch { return {}; }
}

function emit(kind) { for (const fn of listeners[kind] ?? []) fn(); }

// ---- STOP ------------------------------------------------------------------------------

function stopping() {
  page.stopping = { since: performance.now(), idle: false };
  showNow();
}

function stopped() {
  if (page.stopping === null) return;
  page.stopping = null;
  show();
}

// Ends "stopping" when a frame says that the robot rests, or that somebody walks on.
function hasStopped() {
  const { frame, stopping: stop, walking } = page;
  if (stop === null || performance.now() - stop.since < ACKNOWLEDGED) return;
  const on = walking.direction !== null && stop.idle;
  stop.idle ||= walking.direction === null;
  if (frame.fallen || on || REST.includes(frame.behavior)) page.stopping = null;
}

// ---- the line --------------------------------------------------------------------------

function ask(name, values) {
  return new Promise((resolve, reject) => {
    if (!page.isConnected()) {
      reject(new Error("No connection to the run; it is tried again"));
      return;
    }
    count += 1;
    waiting.set(count, { resolve, reject });
    socket.send(JSON.stringify({ do: name, number: count, with: values }));
  });
}

const takes = {
  run({ run }) {
    if (page.run === null) {
      page.run = run;
      page.log = run.log !== null;
      panels = buildLayout(page);
    } else if (page.run.id !== run.id) location.reload();
  },

  settings({ settings }) { page.settings = settings; emit("settings"); },

  history({ moments, events }) {
    page.moments = moments;
    page.events = events;
    emit("events");
  },

  events({ events }) {
    if (events.some(([, kind]) => kind === "refusal")) stopped();
    takeEvents(events);
  },

  frame({ frame, walking, poses }) {
    Object.assign(page, { frame, walking, poses });
    const { moments } = page, shares = frame.command.k_effort;
    while (moments.at(-1)?.[0] >= frame.time) moments.pop();
    const user = shares.reduce((sum, one) => sum + one, 0) / (255 * shares.length);
    moments.push([frame.time, frame.behavior, user]);
    while (moments[0][0] < frame.time - SPAN) moments.shift();
    hasStopped();
    if (page.log) takeLogEvents();
    show();
  },

  session(session) {
    page.session = session;
    show();
  },

  stopping,

  answer({ number, value, problem }) {
    const one = waiting.get(number);
    waiting.delete(number);
    if (problem === undefined) one?.resolve(value);
    else one?.reject(new Error(problem));
  },

  notice({ text, lasting }) { page.tell(text, lasting); },
};

function takeEvents(events) {
  const now = page.frame?.time ?? 0;
  for (const [time, kind, text] of events) {
    if (ALARMS.has(kind) && time > now - RECENT) page.tell(text);
  }
  page.events.push(...events);
  emit("events");
}

// A log has all its events from the start; those until now have been.
function takeLogEvents() {
  const until = page.run.log.events.filter(([time]) => time <= page.frame.time);
  const known = page.events.length;
  if (until.length === known) return;
  page.events = until.slice(0, known);
  takeEvents(until.slice(known));
}

// Shows the latest state, once for all that has come meanwhile.
function show() { due ??= setTimeout(showNow); }

function showNow() {
  clearTimeout(due);
  due = null;
  if (page.frame === null) return;
  for (const panel of panels) panel.show?.(page.frame);
}

function connect() {
  socket = new WebSocket(`socket${location.search}`);
  socket.onmessage = ({ data }) => {
    const message = JSON.parse(data);
    takes[message.kind](message);
  };
  socket.onclose = () => {
    for (const { reject } of waiting.values()) reject(new Error("The connection was lost"));
    waiting.clear();
    setTimeout(connect, AGAIN);
  };
}

window.cockpit = { page };
document.getElementById("notices").showPopover();
startTips();
startKeys(page);
connect();
