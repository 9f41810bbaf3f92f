/* The tables: which is shown, in which order, and who of it. */
"use strict";
(() => {
  const form = document.getElementById("controls");
  const sections = [...document.querySelectorAll("section.ranking")];
  const rankings = sections.filter((section) => section.dataset.key);
  const tables = new Map(sections.map((section) => [section.dataset.key, section]));

  /* Numbers before texts, empty cells last, whichever way. */
  function compare(a, b, sign) {
    const [x, y] = [a, b].map((text) => (text === "" || text === "nan" ? null : Number.isNaN(Number(text)) ? text : Number(text)));
    if (x === null || y === null) return (x === null) - (y === null);
    return sign * (typeof x === "number" && typeof y === "number" ? x - y : String(x).localeCompare(String(y)));
  }

  function sort(section) {
    const [column, way] = (fg.state.sort || "rank").split(".");
    const buttons = [...section.querySelectorAll("thead [data-sort]")];
    let place = buttons.findIndex((button) => button.dataset.sort === column);
    if (place < 0) place = 0;
    buttons.forEach((button, at) => {
      const cell = button.closest("th");
      if (at === place) cell.setAttribute("aria-sort", way === "down" ? "descending" : "ascending");
      else cell.removeAttribute("aria-sort");
    });
    const body = section.querySelector("tbody");
    const value = (row) => row.cells[place].dataset.value ?? "";
    const rows = [...body.rows].map((row) => ({ row, first: Number(row.dataset.place), value: value(row) }));
    rows.sort((a, b) => compare(a.value, b.value, way === "down" ? -1 : 1) || a.first - b.first);
    body.append(...rows.map(({ row }) => row));
  }

  function filter(section) {
    const { family, search } = fg.state;
    let left = 0;
    for (const row of section.querySelectorAll("tbody tr")) {
      const fits = (!family || row.dataset.family === family) && row.dataset.name.toLowerCase().includes(search.toLowerCase());
      row.hidden = !fits;
      left += fits;
    }
    document.getElementById("empty").hidden = left > 0;
  }

  function mark(section) {
    const names = fg.shown();
    for (const row of section.querySelectorAll("tbody tr")) {
      const at = names.indexOf(row.dataset.name);
      row.classList.toggle("chosen", at >= 0);
      row.style.setProperty("--own", at >= 0 ? `var(--c${at})` : "transparent");
      row.querySelector("button.name")?.setAttribute("aria-pressed", String(at >= 0));
    }
  }

  /* What stands in the form follows the state, wherever it came from. */
  function fill() {
    const [place, variant] = [fg.state.set.split("/")[0], fg.state.set.split("/")[1]];
    for (const radio of form.elements.place.length ? form.elements.place : [form.elements.place]) radio.checked = radio.value === place;
    for (const radio of form.querySelectorAll("[name=variant]")) {
      radio.checked = radio.value === variant;
      radio.disabled = Boolean(place) && !tables.has(`${place}/${radio.value}`);
    }
    document.getElementById("variants").hidden = !place;
    form.elements.family.value = fg.state.family;
    if (form.elements.search.value !== fg.state.search) form.elements.search.value = fg.state.search;
  }

  fg.listen((changed) => {
    if (!tables.has(fg.state.set)) fg.state.set = fg.index.start;
    const section = tables.get(fg.state.set);
    if (changed.has("set")) {
      sections.forEach((each) => { each.hidden = each !== section; });
      document.getElementById("board").classList.toggle("wide", !fg.state.set);
    }
    fill();
    if (fg.state.set && (changed.has("set") || changed.has("sort"))) sort(section);
    filter(section);
    mark(section);
  });

  form.addEventListener("input", (event) => {
    const { name, value } = event.target;
    if (name === "family" || name === "search") return fg.change({ [name]: value });
    const place = name === "place" ? value : fg.state.set.split("/")[0];
    const variant = name === "variant" ? value : fg.state.set.split("/")[1];
    const key = tables.has(`${place}/${variant}`) ? `${place}/${variant}` : [...tables.keys()].find((each) => each.startsWith(`${place}/`));
    return fg.change({ set: place ? key : "", seed: "", joint: "", t: "", story: "", sort: "" });
  });
  form.addEventListener("submit", (event) => event.preventDefault());

  for (const section of rankings) {
    [...section.querySelectorAll("tbody tr")].forEach((row, place) => { row.dataset.place = place; });
    section.querySelector("thead").addEventListener("click", (event) => {
      const button = event.target.closest("[data-sort]");
      if (!button) return;
      const up = button.dataset.sort;
      fg.change({ sort: (fg.state.sort || "rank") === up ? `${up}.down` : up });
    });
    section.querySelector("tbody").addEventListener("click", (event) => {
      const row = event.target.closest("tr");
      if (!row || String(getSelection())) return;
      fg.toggle(row.dataset.name);
      const panel = document.getElementById("panel");
      if (fg.shown().includes(row.dataset.name) && panel.getBoundingClientRect().top > innerHeight * 0.7) {
        panel.scrollIntoView({ behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth" });
      }
    });
  }

  document.getElementById("table-csv").addEventListener("click", async () => {
    const told = await fg.numbers();
    const keys = fg.state.set ? [fg.state.set] : Object.keys(told.rows);
    const names = [...tables.get(fg.state.set).querySelectorAll("tbody tr")].filter((row) => !row.hidden).map((row) => row.dataset.name);
    const lines = keys.flatMap((key) => names.filter((name) => told.rows[key][name]).map((name) => told.rows[key][name]));
    const quoted = (cell) => (/[",\n]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell);
    fg.save(`${fg.state.set.replace("/", "-") || "leaderboard"}.csv`, [told.columns, ...lines].map((line) => `${line.map(quoted).join(",")}\n`).join(""));
  });
})();
