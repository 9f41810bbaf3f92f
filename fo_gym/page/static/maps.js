/* Maps by Plotly, which is large: it is loaded where a map comes into sight. */
"use strict";
(() => {
  const figures = [...document.querySelectorAll("figure.map")];
  const MARK = "#D55E00";

  /* 1, 2 and 5 times powers of ten between two ends; powers alone where that would be too many. */
  function steps(low, high, most) {
    const found = [];
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
      for (const digit of [1, 2, 5]) found.push([digit, Number(`${digit}e${power}`)]);
    }
    const inside = found.filter(([, value]) => value >= low * 0.999 && value <= high * 1.001);
    return (inside.length > most ? inside.filter(([digit]) => digit === 1) : inside).map(([, value]) => value);
  }

  function axis({ title, values, logarithmic }) {
    const shown = logarithmic ? steps(values[0], values.at(-1), 10) : [];
    return {
      title: { text: title }, gridcolor: fg.color("line"), zeroline: false, exponentformat: "none",
      ...(logarithmic ? { type: "log", tickvals: shown, ticktext: shown.map(String) } : {}),
    };
  }

  function ticks({ low, high }) {
    const shown = steps(low, high, 7);
    return { tickvals: shown.map(Math.log10), ticktext: shown.map(String) };
  }

  const each = (values, change) => values.map((row) => row.map((value) => (value === null ? null : change(value))));

  /* The cells of a layer, as Plotly has them: those at rest grey, the others by the logarithm where that is the scale. */
  function cells(map, layer) {
    const { low, high, rest, values } = layer;
    const logarithmic = high > 0;
    const shared = { type: "heatmap", x: map.x.values, y: map.y.values, text: each(values, String), hoverongaps: false,
      hovertemplate: `${map.x.title}: %{x:.3g}<br>${map.y.title}: %{y:.3g}<br>${layer.title}: %{text}<extra></extra>` };
    const colored = { ...shared, z: each(values, (value) => (rest && value < low ? null : logarithmic ? Math.log10(Math.max(value, low)) : value)),
      colorscale: "Viridis", colorbar: { title: { text: layer.title, side: "right" }, thickness: 14, ...(logarithmic ? ticks(layer) : {}) },
      ...(logarithmic ? { zmin: Math.log10(low), zmax: Math.log10(high) } : {}) };
    const calm = { ...shared, z: each(values, (value) => (rest && value < low ? 0 : null)), colorscale: [[0, fg.color("line")], [1, fg.color("line")]], showscale: false };
    return rest ? [calm, colored] : [colored];
  }

  function marks({ points, line, line_name }) {
    const found = [];
    if (line.length) {
      found.push({ type: "scatter", mode: "lines", name: line_name, x: line.map(([x]) => x), y: line.map(([, y]) => y), line: { color: MARK, width: 2 } });
    }
    if (points.length) {
      found.push({ type: "scatter", mode: "markers", name: "", x: points.map(([, x]) => x), y: points.map(([, , y]) => y),
        text: points.map(([name]) => name), hovertemplate: "%{text}<extra></extra>", showlegend: false,
        marker: { color: MARK, symbol: "diamond", size: 11, line: { color: "#fff", width: 1.5 } } });
    }
    return found;
  }

  /* Names of points, beside them, on paper of their own so that they can be read on any colour. */
  const names = (map) => map.marks.points.map(([text, x, y]) => ({
    text, x: map.x.logarithmic ? Math.log10(x) : x, y: map.y.logarithmic ? Math.log10(y) : y,
    yshift: -17, showarrow: false, bgcolor: fg.color("paper"), font: { size: 11 },
  }));

  async function draw(figure) {
    const { name } = figure.dataset;
    await Promise.all([fg.load("vendor/plotly.js"), fg.load(figure.dataset.map)]);
    const map = fg.received(`map ${name}`);
    const layer = map.layers[Number(figure.querySelector("select").value)];
    const ends = (values) => [values[0], values.at(-1)];
    const between = ({ values, logarithmic }) => (logarithmic ? ends(values).map(Math.log10) : ends(values));
    const within = { ...map.marks, line: map.marks.line.filter(([, y]) => y >= map.y.values[0] && y <= map.y.values.at(-1)) };
    await Plotly.react(figure.querySelector(".chart"), [...cells(map, layer), ...marks(within)], {
      xaxis: { ...axis(map.x), range: between(map.x) }, yaxis: { ...axis(map.y), range: between(map.y) },
      annotations: names(map), margin: { t: 16, r: 8, b: within.line.length ? 88 : 56, l: 64 },
      showlegend: within.line.length > 0, legend: { orientation: "h", x: 0, y: -0.2, yanchor: "top" },
      paper_bgcolor: "transparent", plot_bgcolor: "transparent", font: { color: fg.color("ink"), family: "system-ui, sans-serif" },
    }, { responsive: true, displaylogo: false });
    figure.dataset.drawn = "yes";
  }
  const seen = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      seen.unobserve(target);
      draw(target);
    }
  });
  figures.forEach((figure) => {
    seen.observe(figure);
    figure.querySelector("select").addEventListener("change", () => draw(figure));
  });
  document.addEventListener("themed", () => figures.filter((figure) => figure.dataset.drawn).forEach(draw));
})();
