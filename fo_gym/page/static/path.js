/* The tool's path in its plane, with what friction does to it magnified, and the time that the charts show brought out. */
"use strict";
fg.path = (axes, all, colors) => {
  const SIZE = 360;
  const [xs, ys] = all[0].tool_target;
  const finite = (values) => values.filter((value) => value !== null);
  const [left, right] = [Math.min(...finite(xs)), Math.max(...finite(xs))];
  const [low, high] = [Math.min(...finite(ys)), Math.max(...finite(ys))];
  const reach = Math.max(right - left, high - low) * 1.3 || 1;
  const scale = SIZE / reach;
  const place = (x, y) => [SIZE / 2 + (x - (left + right) / 2) * scale, SIZE / 2 - (y - (low + high) / 2) * scale];

  const line = (points, from, to, times) => {
    let text = "";
    let open = false;
    points.forEach(([x, y], i) => {
      if (x === null || y === null || (times && (times[i] < from || times[i] > to))) { open = false; return; }
      const [u, v] = place(x, y);
      text += `${open ? "L" : "M"}${u.toFixed(1)} ${v.toFixed(1)}`;
      open = true;
    });
    return text;
  };
  const pairs = (columns) => columns[0].map((x, i) => [x, columns[1][i]]);

  const drawing = fg.make("svg", { viewBox: `0 0 ${SIZE} ${SIZE}`, class: "path", role: "img",
    "aria-label": `Path of the tool of ${all.map((s) => s.name).join(", ")}` });
  drawing.append(fg.make("path", { d: line(pairs(all[0].tool_target)), class: "target" }));
  drawing.append(fg.make("path", { d: line(pairs(all[0].tool_ideal)), class: "ideal" }));
  const layers = all.map((s, n) => {
    const faint = fg.make("path", { class: "faint", style: `stroke: var(--c${colors[n]})` });
    const bright = fg.make("path", { class: "bright", style: `stroke: var(--c${colors[n]})`, "data-name": s.name });
    drawing.append(faint, bright);
    return { s, faint, bright };
  });
  const step = 50;
  drawing.append(fg.make("line", { x1: 12, x2: 12 + step * scale, y1: SIZE - 12, y2: SIZE - 12, class: "rule" }),
    fg.make("text", { x: 12, y: SIZE - 18, class: "rule-text" }, `${step} mm`));

  let shown = [-Infinity, Infinity];
  let factor = 1;
  const off = (s) => pairs(s.tool).map(([x, y], i) => {
    const [a, b] = [s.tool_ideal[0][i], s.tool_ideal[1][i]];
    return x === null || a === null ? [null, null] : [a + factor * (x - a), b + factor * (y - b)];
  });
  function draw() {
    for (const { s, faint, bright } of layers) {
      const points = off(s);
      faint.setAttribute("d", line(points));
      bright.setAttribute("d", line(points, ...shown, s.time));
    }
  }
  const select = fg.make("select", { id: "magnified", onchange: (event) => { factor = Number(event.target.value); draw(); } },
    ...[1, 5, 20].map((each) => fg.make("option", { value: each }, `× ${each}`)));
  const figure = fg.make("figure", { class: "chart", "data-chart": "path" },
    fg.make("figcaption", {}, fg.make("span", {}, `Path of the tool `, fg.make("small", {}, `${axes[0]} and ${axes[1]}; dashed: target, dotted: friction-free`)),
      fg.make("span", { class: "field" }, fg.make("label", { for: "magnified" }, "Distance from it"), select)),
    drawing);
  draw();
  return { element: figure, span(from, to) { shown = [from, to]; draw(); } };
};
