/* The trade-off: what is left of friction against what is paid for it, on logarithmic axes. */
"use strict";
(() => {
  const PRICES = [["torque_roughness_ratio", "torque roughness, of the limit"], ["control_effort_ratio", "control effort, of the limit"],
    ["hunting_ratio", "hunting, share of episodes"], ["steady_state_error_ju", "steady-state error, m or rad"]];
  const [HEIGHT, MARGIN] = [420, { left: 62, right: 14, top: 14, bottom: 48 }];
  let WIDTH = 560;
  const box = document.getElementById("pareto-chart");
  const price = document.getElementById("price");
  price.append(...PRICES.map(([key, text]) => fg.make("option", { value: key }, text)));
  price.addEventListener("change", () => fg.change({ price: price.value }));

  /* A logarithmic axis over some values, or a linear one where one of them is not above 0. */
  function axis(values, from, to) {
    const log = Math.min(...values) > 0;
    const at = log ? Math.log10 : Number;
    let [low, high] = [Math.min(...values.map(at)), Math.max(...values.map(at))];
    const pad = (high - low || 1) * 0.06;
    [low, high] = [low - pad, high + pad];
    const place = (value) => from + ((at(value) - low) / (high - low)) * (to - from);
    const marks = [];
    if (log) {
      for (let decade = Math.floor(low); decade <= Math.ceil(high); decade += 1) {
        for (const digit of high - low > 1.6 ? [1] : [1, 2, 5]) marks.push(Number(`${digit}e${decade}`));
      }
    } else for (let i = 0; i <= 5; i += 1) marks.push(low + pad + ((high - low - 2 * pad) * i) / 5);
    return { place, marks: marks.filter((value) => at(value) >= low && at(value) <= high) };
  }

  /* Who is beaten by nobody in both. */
  const front = (points) => points.filter((p) => !points.some((q) => q.x <= p.x && q.y <= p.y && (q.x < p.x || q.y < p.y)));

  async function draw() {
    const told = await fg.numbers();
    const key = fg.state.price || PRICES[0][0];
    price.value = key;
    const [x_at, y_at] = [key, "frr"].map((column) => told.columns.indexOf(column));
    const visible = new Set([...document.querySelectorAll(`section.ranking[data-key="${CSS.escape(fg.state.set)}"] tbody tr:not([hidden])`)].map((row) => row.dataset.name));
    const points = Object.entries(told.rows[fg.state.set] ?? {})
      .filter(([name, row]) => visible.has(name) && !told.references.includes(name) && row[x_at] !== "" && row[y_at] !== "")
      .map(([name, row]) => ({ name, x: Number(row[x_at]), y: 1 - Number(row[y_at]) }));
    if (points.length < 2) {
      box.replaceChildren(fg.make("p", { class: "hint" }, "There is nothing to compare here."));
      return;
    }
    WIDTH = Math.max(box.clientWidth, 280);
    const across = axis(points.map((p) => p.x), MARGIN.left, WIDTH - MARGIN.right);
    const up = axis(points.map((p) => p.y), MARGIN.top, HEIGHT - MARGIN.bottom);
    const drawing = fg.make("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "pareto", role: "group", "aria-label": `1 - FRR over ${price.selectedOptions[0].text}` });
    for (const value of across.marks) drawing.append(...tick(across.place(value), value, true));
    for (const value of up.marks) drawing.append(...tick(up.place(value), value, false));
    drawing.append(
      fg.make("text", { x: (WIDTH + MARGIN.left) / 2, y: HEIGHT - 8, class: "axis-name", "text-anchor": "middle" }, price.selectedOptions[0].text),
      fg.make("text", { x: 0, y: 0, class: "axis-name", "text-anchor": "middle", transform: `translate(14 ${(HEIGHT - MARGIN.bottom) / 2}) rotate(-90)` }, "1 - FRR, left of friction"));
    const best = front(points).sort((a, b) => a.x - b.x);
    drawing.append(fg.make("path", { class: "front", d: best.map((p, i) => `${i ? "L" : "M"}${across.place(p.x).toFixed(1)} ${up.place(p.y).toFixed(1)}`).join("") }));
    const taken = points.map((p) => [across.place(p.x) - 6, up.place(p.y) - 6, across.place(p.x) + 6, up.place(p.y) + 6]);
    const order = [...points].sort((a, b) => weight(b) - weight(a));
    const labels = [];
    for (const p of order) {
      const [u, v] = [across.place(p.x), up.place(p.y)];
      const at = fg.shown().indexOf(p.name);
      const dot = fg.make("circle", { cx: u, cy: v, r: at >= 0 ? 7 : 5, tabindex: 0, role: "button", "aria-label": `${p.name}: 1 - FRR ${p.y.toPrecision(3)}, ${p.x.toPrecision(3)}`, "aria-pressed": String(at >= 0),
        class: best.includes(p) ? "dot on-front" : "dot", style: at >= 0 ? `fill: var(--c${at})` : null,
        onclick: () => fg.toggle(p.name), onkeydown: (event) => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); fg.toggle(p.name); } } },
      fg.make("title", {}, `${p.name}: 1 - FRR ${p.y.toPrecision(3)}, ${p.x.toPrecision(3)}`));
      drawing.append(dot);
      const spot = weight(p) ? free(u, v, p.name.length * 6.6, taken) : null;
      if (spot) labels.push(fg.make("text", { x: spot[0], y: spot[1], class: at >= 0 ? "label chosen" : "label" }, p.name));
    }
    drawing.append(...labels);
    box.replaceChildren(drawing);

    function weight(p) { return (fg.shown().includes(p.name) ? 2 : 0) + (best.includes(p) ? 1 : 0); }
  }

  function tick(at, value, across) {
    const text = `${+value.toPrecision(3)}`;
    return across
      ? [fg.make("line", { x1: at, x2: at, y1: MARGIN.top, y2: HEIGHT - MARGIN.bottom, class: "grid" }), fg.make("text", { x: at, y: HEIGHT - MARGIN.bottom + 18, class: "tick", "text-anchor": "middle" }, text)]
      : [fg.make("line", { x1: MARGIN.left, x2: WIDTH - MARGIN.right, y1: at, y2: at, class: "grid" }), fg.make("text", { x: MARGIN.left - 6, y: at + 4, class: "tick", "text-anchor": "end" }, text)];
  }

  /* Room for a label beside a point, which nothing else takes; null where there is none. */
  function free(u, v, width, taken) {
    for (const [x, y] of [[u + 11, v + 4], [u - 11 - width, v + 4], [u - width / 2, v - 12], [u - width / 2, v + 20], [u + 9, v - 11], [u + 9, v + 19],
      [u - width - 9, v - 11], [u - width - 9, v + 19]]) {
      const spot = [x - 2, y - 11, x + width + 2, y + 4];
      const inside = spot[0] > MARGIN.left && spot[2] < WIDTH && spot[1] > 0 && spot[3] < HEIGHT - MARGIN.bottom;
      if (inside && !taken.some((t) => spot[0] < t[2] && t[0] < spot[2] && spot[1] < t[3] && t[1] < spot[3])) {
        taken.push(spot);
        return [x, y];
      }
    }
    return null;
  }

  let width = 0;
  new ResizeObserver(() => {
    if (box.clientWidth && width && box.clientWidth !== width) draw();
    width = box.clientWidth;
  }).observe(box);

  fg.listen((changed) => {
    if (fg.state.view === "pareto" && fg.state.set && ["set", "view", "show", "family", "search", "price"].some((key) => changed.has(key))) draw();
  });
})();
