// Plots of any column by name: of the last frames, or of a log.

import { button, choice, el, write } from "./dom.js";
import { chart, colorOf } from "./chart.js";

const WINDOWS = [2, 5, 10, 30, 60]; // Times that can be seen [s].
const USUAL = 10; // The one at first [s].
const LONGEST = 60; // Time for which records are kept [s].
const KEPT = 1200; // Number of records that are kept, in slow motion [1].
const MOST = 12; // Number of columns that can be plotted.
const PERIOD = 180; // Least time between two drawings, which cost more than all else [ms].
const NEAREST = 3; // Number of names that are proposed for an unknown one.

export function build(page, root) {
  const columns = page.run.columns, every = Object.keys(columns).sort();
  let names = (page.recall("plots") ?? []).filter((name) => name in columns).slice(0, MOST);
  let legend = new Map(), drawn = "", drawnAt = 0, width = 300;
  const records = []; // [time, record] of the last frames: a channel shows its past at once.
  const ofLog = new Map(); // Columns of a log by name, or null while they are on their way.

  const search = el("input", { type: "search", list: "columns", autocomplete: "off",
    spellcheck: "false", placeholder: "Plot, such as balance.com.x",
    "aria-label": "Channel to plot", oninput: typed, onchange: entered });
  const span = choice(WINDOWS.map((one) => [one, `${one} s`]), {
    "aria-label": "Time plotted", value: page.recall("plotted") ?? USUAL, onchange: () => {
      page.remember("plotted", span.value);
      redraw();
    } });
  const problem = el("p", { class: "problem", role: "status" });
  const rows = el("div"), charts = el("div");
  const dashed = el("p", { class: "dim" }, "dashed: the log beside it");
  root.append(
    el("datalist", { id: "columns" }, every.map((name) => el("option", { value: name }))),
    el("div", { class: "search" }, search, span), problem, rows, dashed, charts);
  new ResizeObserver(([entry]) => {
    width = Math.round(entry.contentRect.width) || width;
    redraw();
  }).observe(charts);
  changed();

  // What is chosen from the list is complete at once, unless a longer name begins with it.
  function typed() {
    const name = search.value.trim();
    write(problem, "");
    if (name in columns && !every.some((one) => one !== name && one.startsWith(name))) entered();
  }

  function entered() {
    const name = search.value.trim();
    if (!name) return;
    if (!(name in columns)) {
      const near = nearest(name, every);
      write(problem, `there is no channel “${name}”${near && `; the nearest: ${near}`}`);
    } else if (!names.includes(name) && names.length >= MOST) {
      write(problem, `${MOST} channels are plotted at most: remove one first`);
    } else {
      search.value = "";
      if (!names.includes(name)) names = [...names, name];
      changed();
    }
  }

  function changed() {
    page.remember("plots", names);
    legend = new Map(names.map((name, i) => {
      const value = el("span", { class: "number" });
      const remove = button("×", () => {
        names = names.filter((one) => one !== name);
        changed();
      }, { "aria-label": `Remove ${name}`, "data-tip": `Remove ${name}` });
      return [name, { value, row: el("div", { class: "curve" },
        el("i", { style: { background: colorOf(i) } }),
        el("span", { class: "path" }, name), value, remove) }];
    }));
    rows.replaceChildren(...[...legend.values()].map((one) => one.row));
    dashed.hidden = !page.run.log?.beside || !names.length;
    if (page.log) names.filter((name) => !ofLog.has(name)).forEach(fetchColumn);
    redraw();
  }

  async function fetchColumn(name) {
    ofLog.set(name, null);
    const found = await page.do("columns", { names: [name] });
    if (found !== undefined) ofLog.set(name, found[name]);
    redraw();
  }

  // Curves of a column in a span of time: [[time, value], ...], of a log beside it dashed.
  function curves(name, begin, end) {
    const within = (points) => points.filter(([time]) => time >= begin && time <= end);
    if (!page.log) {
      const { path } = columns[name];
      return [{ points: within(records).map(([time, record]) =>
        [time, number(path.reduce((value, key) => value?.[key], record))]) }];
    }
    const column = ofLog.get(name);
    return [column, column?.beside].filter(Boolean).map(({ time, value }, i) =>
      ({ points: within(time.map((t, n) => [t, value[n]])), dashed: i > 0 }));
  }

  function redraw() {
    drawn = "";
    drawnAt = 0;
    if (page.frame) draw(page.frame);
  }

  function draw(frame) {
    const now = `${frame.run} ${frame.time}`;
    if (now === drawn || performance.now() - drawnAt < PERIOD) return;
    drawn = now;
    drawnAt = performance.now();
    const [begin, end] = seen(frame.time, Number(span.value));
    const charted = {}; // Curves of each unit.
    names.forEach((name, i) => {
      const { unit } = columns[name], found = curves(name, begin, end);
      const told = found[0]?.points.findLast(([time]) => time <= frame.time + 1e-9)?.[1];
      write(legend.get(name).value,
            Number.isFinite(told) ? `${Number(told.toPrecision(4))} ${unit}` : "no value");
      const colored = found.map((curve) => ({ ...curve, name, color: colorOf(i) }));
      charted[unit] = [...charted[unit] ?? [], ...colored];
    });
    charts.replaceChildren(...Object.entries(charted).map(([unit, group]) =>
      chart(group, { unit, begin, end, width, cursor: page.log ? frame.time : null })));
  }

  function seen(time, long) {
    if (!page.log) return [time - long, time];
    const log = page.run.log;
    const begin = Math.max(log.begin, Math.min(time - long / 2, log.end - long));
    return [begin, begin + long];
  }

  return {
    show(frame) {
      if (!page.log) {
        while (records.at(-1)?.[0] >= frame.time) records.pop();
        records.push([frame.time, frame.record]);
        while (records.length > KEPT || records[0][0] < frame.time - LONGEST) records.shift();
      }
      draw(frame);
    },
  };
}

// Truth values count as 0 and 1.
const number = (value) => (typeof value === "boolean" ? Number(value) : value ?? NaN);

// Names that share most words with a name.
function nearest(name, every) {
  const words = name.toLowerCase().match(/[a-z0-9]+/g) ?? [];
  const shared = (one) => words.filter((word) => one.toLowerCase().includes(word)).length;
  const found = every.filter(shared).sort((one, other) => shared(other) - shared(one));
  return found.slice(0, NEAREST).join(", ");
}
