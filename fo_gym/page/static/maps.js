/* Maps by Plotly, which is large: it is loaded where a map comes into sight. */
"use strict";
(() => {
  const figures = [...document.querySelectorAll("figure.map")];
  async function draw(figure) {
    const { name } = figure.dataset;
    await Promise.all([fg.load("vendor/plotly.js"), fg.load(figure.dataset.map)]);
    const map = fg.received(`map ${name}`);
    const log = (values) => (values.every((value) => value > 0) ? "log" : "linear");
    const axis = (title, values) => ({ title: { text: title }, type: log(values), gridcolor: fg.color("line") });
    const field = { type: "heatmap", x: map.x, y: map.y, z: map.values, colorscale: "Cividis", colorbar: { title: { text: map.value_name } } };
    await Plotly.react(figure.querySelector(".chart"), [field], {
      xaxis: axis(map.x_name, map.x), yaxis: axis(map.y_name, map.y), margin: { t: 16, r: 8, b: 56, l: 64 },
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
  figures.forEach((figure) => seen.observe(figure));
  document.addEventListener("themed", () => figures.filter((figure) => figure.dataset.drawn).forEach(draw));
})();
