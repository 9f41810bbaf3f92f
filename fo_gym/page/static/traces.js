/* Traces of the chosen competitors: charts that share their time, and the tool's path. */
"use strict";
(() => {
  const charts = document.getElementById("charts");
  const note = document.getElementById("traces-note");
  const episode = document.getElementById("episode");
  const joint = document.getElementById("joint");
  const MILLI = 1e3;
  const HEIGHT = 170;
  const DASHES = [[], [5, 4], [2, 3], [9, 3, 2, 3]];
  let drawn = { plots: [], traces: [], path: null };
  let turn = 0;

  /* A packed column as numbers; null where there is none. */
  function unpacked(column, length) {
    if (!column.data) return new Array(length).fill(column.low);
    const text = atob(column.data);
    const values = new Array(text.length / 2);
    for (let i = 0; i < values.length; i += 1) {
      const level = text.charCodeAt(2 * i) | (text.charCodeAt(2 * i + 1) << 8);
      values[i] = level === 65535 ? null : column.low + level * column.step;
    }
    return values;
  }

  function times(trace) {
    let tick = 0;
    return trace.ticks.map((step) => { tick += step; return tick * trace.tick; });
  }

  const scaled = (values, offset = 0) => values.map((value) => (value === null ? null : MILLI * (value - offset)));
  const minus = (a, b) => a.map((value, i) => (value === null || b[i] === null ? null : value - b[i]));

  /* The signals of a trace that are drawn, in mm, mrad and N m. */
  function signals(trace, at) {
    const column = (name) => unpacked(trace[name][at], trace.ticks.length);
    const [theta, error, target] = ["theta", "error", "target"].map(column);
    return {
      name: trace.name, frr: trace.frr, time: times(trace),
      theta: scaled(theta, target[0]), ideal: scaled(minus(theta, error), target[0]), target: scaled(target, target[0]),
      error: scaled(error), tau_f: column("tau_f"), tau_f_hat: column("tau_f_hat"),
      diagnostics: Object.entries(trace.diagnostics ?? {}).map(([name, columns]) => [name, unpacked(columns[at], trace.ticks.length)]),
      away: trace.away ? scaled(unpacked(trace.away, trace.ticks.length)) : null,
      ...Object.fromEntries(["tool", "tool_ideal", "tool_target"].map((name) => [name, trace[name]?.map((each) => scaled(unpacked(each, trace.ticks.length)))])),
    };
  }

  /* What each chart shows: its title, and series (label, colour, dash, values) of a trace or of the first one. */
  function layouts(unit, all, at) {
    const own = (n, more) => ({ stroke: fg.color(`c${n}`), width: 1.6, ...more });
    const torque = unit === "m" ? "N" : "N m";
    const which = joint.options.length > 1 ? `, joint ${at + 1}` : "";
    const motion = {
      id: "motion", title: `Motion, from the first target${which}`, unit: `m${unit}`, key: [["target", "5 4"], ["friction-free", "2 3"]],
      shared: (s) => [["target", s.target, { stroke: fg.color("ink"), width: 1, dash: [5, 4] }], ["friction-free", s.ideal, { stroke: fg.color("quiet"), width: 1.6, dash: [2, 3] }]],
      each: (s, n) => [["theta", s.theta, own(n)]],
    };
    const error = {
      id: "error", title: `What friction does: motion less the friction-free one${which}`, unit: `m${unit}`, key: [],
      shared: () => [], each: (s, n) => [["theta - ideal", s.error, own(n)]],
    };
    const away = {
      id: "away", title: "What friction does: distance of the tool from the friction-free one", unit: "mm", key: [],
      shared: () => [], each: (s, n) => [["away", s.away, own(n)]],
    };
    const torques = {
      id: "torque", title: `Friction and its estimate${which}`, unit: torque, key: [["tau_f", ""], ["tau_f_hat", "5 4"]],
      shared: () => [],
      each: (s, n) => [["tau_f", s.tau_f, own(n, { width: 1 })], ["tau_f_hat", s.tau_f_hat, own(n, { dash: [5, 4], width: 1.8 })]],
    };
    const names = [...new Set(all.flatMap((s) => s.diagnostics.map(([name]) => name)))];
    const dash = (name) => DASHES[names.indexOf(name) % DASHES.length];
    const diagnostics = {
      id: "diagnostics", title: `What compensators say besides${which}`, unit: torque, key: names.map((name) => [name, dash(name).join(" ")]),
      shared: () => [], each: (s, n) => s.diagnostics.map(([name, values]) => [name, values, own(n, { dash: dash(name) })]),
    };
    const usual = all[0].tool ? [away, torques, motion] : [motion, error, torques];
    return names.length ? [...usual, diagnostics] : usual;
  }

  function draw_chart(layout, all) {
    const tables = [];
    const series = [{}];
    all.forEach((s, n) => {
      const lines = [...(n === 0 ? layout.shared(s) : []), ...layout.each(s, n)];
      tables.push([s.time, ...lines.map(([, values]) => values)]);
      lines.forEach(([label, , style]) => series.push({ label: `${s.name} ${label}`, points: { show: false }, ...style }));
    });
    const figure = fg.make("figure", { class: "chart", "data-chart": layout.id });
    const key = layout.key.flatMap(([text, dash]) => [
      fg.make("svg", { width: 22, height: 8, "aria-hidden": "true" }, fg.make("line", { x1: 1, x2: 21, y1: 4, y2: 4, stroke: "currentColor", "stroke-width": 1.5, "stroke-dasharray": dash })), `${text} `]);
    figure.append(fg.make("figcaption", {}, fg.make("span", {}, `${layout.title} `, fg.make("small", {}, layout.unit)), fg.make("small", { class: "key" }, ...key)));
    const box = fg.make("div", { role: "img", "aria-label": `${layout.title} of ${all.map((s) => s.name).join(", ")} over time` });
    figure.append(box);
    charts.append(figure);
    const grid = { stroke: fg.color("line"), width: 1 };
    const axis = { stroke: fg.color("quiet"), grid, ticks: grid, font: "12px system-ui, sans-serif" };
    const plot = new uPlot({
      width: charts.clientWidth, height: HEIGHT, series, legend: { show: false },
      scales: { x: { time: false } },
      axes: [{ ...axis, size: 30, values: (_, values) => values.map((value) => `${+value.toFixed(3)} s`) }, { ...axis, size: 56 }],
      cursor: { sync: { key: "time" }, drag: { x: true, y: false }, points: { show: false } },
      hooks: { setScale: [(u, scale) => { if (scale === "x") follow(u); }] },
    }, tables.length === 1 ? tables[0] : uPlot.join(tables), box);
    return plot;
  }

  /* All charts show the time that one of them was zoomed to. */
  let following = false;
  function follow(plot) {
    if (following || !drawn.plots.includes(plot)) return;
    const { min, max } = plot.scales.x;
    const [low, high] = whole();
    const all = min <= low + 1e-9 && max >= high - 1e-9;
    fg.change({ t: all ? "" : `${+min.toFixed(4)}-${+max.toFixed(4)}` });
  }

  const whole = () => [drawn.traces[0].time[0], Math.max(...drawn.traces.map((s) => s.time.at(-1)))];

  function span() {
    const [low, high] = whole();
    const [from, to] = fg.state.t.split("-").map(Number);
    return fg.state.t && to > from ? [Math.max(from, low), Math.min(to, high)] : [low, high];
  }

  function show_span() {
    if (!drawn.traces.length) return;
    const [min, max] = span();
    following = true;
    drawn.plots.forEach((plot) => plot.setScale("x", { min, max }));
    following = false;
    drawn.path?.span(min, max);
  }

  function options(select, entries, value) {
    select.replaceChildren(...entries.map(([key, text]) => fg.make("option", { value: key }, text)));
    select.value = value;
    document.getElementById(`${select.id}-field`).hidden = entries.length < 2;
  }

  async function draw() {
    const mine = (turn += 1);
    const { set } = fg.state;
    const episodes = fg.index.episodes[set] ?? [];
    const seed = episodes.some(([each]) => each === fg.state.seed) ? fg.state.seed : episodes[0]?.[0];
    const keys = fg.shown().map((name) => `${set}/${seed}/${name}`);
    const there = keys.filter((key) => fg.index.traces[key]);
    let traces = [];
    try {
      traces = await Promise.all(there.map(fg.trace_of));
    } catch (error) {
      note.textContent = `Some traces cannot be shown: ${error.message}.`;
      return;
    }
    if (mine !== turn) return;
    drawn.plots.forEach((plot) => plot.destroy());
    charts.replaceChildren();
    drawn = { plots: [], traces: [], path: null };
    const missing = fg.shown().filter((name, at) => !fg.index.traces[keys[at]]);
    note.textContent = missing.length ? `There is no trace of ${missing.join(", ")} here.` : "";
    charts.dataset.shown = traces.map((trace) => trace.name).join(",");
    if (!traces.length) return;
    options(episode, episodes, seed);
    const count = traces[0].theta.length;
    const at = Math.min(fg.state.joint ? Number(fg.state.joint) - 1 : 1, count - 1);
    options(joint, traces[0].theta.map((_, i) => [String(i + 1), String(i + 1)]), String(at + 1));
    const order = fg.shown();
    const all = traces.map((trace) => signals(trace, at));
    drawn.traces = all;
    const colors = all.map((s) => order.indexOf(s.name));
    if (all[0].tool) {
      drawn.path = fg.path(traces[0].axes, all, colors);
      charts.append(drawn.path.element);
    }
    drawn.plots = layouts(fg.index.units[set], all, at).map((layout) => {
      const each = layout.each;
      return draw_chart({ ...layout, each: (s) => each(s, order.indexOf(s.name)) }, all);
    });
    show_span();
  }

  episode.addEventListener("change", () => fg.change({ seed: episode.value, t: "" }));
  joint.addEventListener("change", () => fg.change({ joint: joint.value }));

  function move(how) {
    if (!drawn.traces.length) return;
    const [low, high] = whole();
    const [from, to] = span();
    const [middle, half] = [(from + to) / 2, (to - from) / 2];
    const [next, reach] = { in: [middle, half / 2], out: [middle, half * 2], back: [middle - half, half], on: [middle + half, half] }[how] ?? [(low + high) / 2, (high - low) / 2];
    const center = Math.min(Math.max(next, low + reach), Math.max(high - reach, low + reach));
    const [a, b] = [Math.max(center - reach, low), Math.min(center + reach, high)];
    fg.change({ t: a <= low && b >= high ? "" : `${+a.toFixed(4)}-${+b.toFixed(4)}` });
  }

  document.querySelectorAll("[data-time]").forEach((button) => button.addEventListener("click", () => move(button.dataset.time)));

  document.getElementById("traces-csv").addEventListener("click", () => {
    const [from, to] = drawn.traces.length ? span() : [0, 0];
    const lines = ["compensator,time_s,target,ideal,theta,tau_f,tau_f_hat\n"];
    for (const s of drawn.traces) {
      s.time.forEach((time, i) => {
        if (time < from || time > to) return;
        const cells = [time, s.target[i], s.ideal[i], s.theta[i], s.tau_f[i], s.tau_f_hat[i]];
        lines.push(`"${s.name.replaceAll('"', '""')}",${cells.map((cell) => (cell === null ? "" : +cell.toPrecision(7))).join(",")}\n`);
      });
    }
    fg.save(`traces-${fg.state.set.replace("/", "-")}.csv`, lines.join(""));
  });

  new ResizeObserver(() => {
    drawn.plots.forEach((plot) => { if (charts.clientWidth && plot.width !== charts.clientWidth) plot.setSize({ width: charts.clientWidth, height: HEIGHT }); });
  }).observe(charts);
  document.addEventListener("themed", () => { if (drawn.plots.length) draw(); });

  fg.listen((changed) => {
    if (fg.state.view !== "traces" || !fg.state.set) return;
    if (["show", "set", "seed", "joint", "view"].some((key) => changed.has(key))) draw();
    else if (changed.has("t")) show_span();
  });
})();
