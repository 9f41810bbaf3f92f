/* The panel beside the table: its tabs, who is chosen, the answers of stories, and all numbers of the chosen. */
"use strict";
(() => {
  const tabs = [...document.querySelectorAll("[role=tab]")];
  const chosen = document.getElementById("chosen");
  const answer = document.getElementById("answer");
  const stories = new Map([...document.querySelectorAll(".story")].map((link) => [link.dataset.story, link]));

  tabs.forEach((tab, at) => {
    const view = tab.id.replace("tab-", "");
    tab.addEventListener("click", () => fg.change({ view }));
    tab.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!step) return;
      const next = tabs[(at + step + tabs.length) % tabs.length];
      next.focus();
      next.click();
    });
  });

  function chips() {
    chosen.replaceChildren(...fg.shown().map((name, at) => fg.make("li", { style: `--own: var(--c${at})` },
      fg.make("span", {}, name),
      fg.make("button", { type: "button", "aria-label": `Take ${name} out`, onclick: () => fg.toggle(name) }, "×"))));
    if (!fg.shown().length) chosen.append(fg.make("li", { class: "none" }, "Choose up to four rows of the table."));
  }

  function tell_story() {
    const story = stories.get(fg.state.story);
    answer.hidden = !story;
    if (!story) return;
    const more = story.dataset.more ? fg.make("a", { href: story.dataset.more }, "The whole story") : null;
    answer.replaceChildren(fg.make("strong", {}, story.querySelector("strong").textContent), " ",
      story.querySelector("span").textContent, " ", ...(more ? [more] : []));
  }

  async function compare() {
    const told = await fg.numbers();
    const rows = fg.shown().map((name) => [name, told.rows[fg.state.set]?.[name]]).filter(([, row]) => row);
    const lines = told.columns.map((column, at) => [column, rows.map(([, row]) => row[at])])
      .filter(([column, cells]) => told.told.includes(column) && cells.some((cell) => cell !== ""));
    const head = fg.make("tr", {}, fg.make("th", { scope: "col" }, "number"), ...rows.map(([name]) => fg.make("th", { scope: "col" }, name)));
    const body = lines.map(([column, cells]) => {
      const metric = told.metrics[column];
      const better = metric ? best(cells, metric.better) : null;
      return fg.make("tr", {}, fg.make("th", { scope: "row", title: metric?.description }, column),
        ...cells.map((cell) => fg.make("td", { class: cell !== "" && cell === better && rows.length > 1 ? "better" : null }, cell)));
    });
    const gains = fg.make("tr", {}, fg.make("th", { scope: "row" }, "gains"),
      ...rows.map(([name]) => fg.make("td", {}, told.gains[fg.state.set]?.[name] ?? "")));
    document.getElementById("numbers-table").replaceChildren(
      fg.make("thead", {}, head), fg.make("tbody", {}, ...body, gains));
  }

  function best(cells, way) {
    const numbers = cells.filter((cell) => cell !== "").map(Number);
    const found = way === "lower" ? Math.min(...numbers) : Math.max(...numbers);
    return cells.find((cell) => cell !== "" && Number(cell) === found);
  }

  fg.listen((changed) => {
    for (const tab of tabs) {
      const on = tab.id === `tab-${fg.state.view}`;
      tab.setAttribute("aria-selected", String(on));
      tab.tabIndex = on ? 0 : -1;
      document.getElementById(tab.getAttribute("aria-controls")).hidden = !on;
    }
    chips();
    tell_story();
    if (fg.state.view === "numbers" && fg.state.set && (changed.has("show") || changed.has("set") || changed.has("view"))) compare();
  });

  /* Links into the page go to where the answer stands, once it stands there. */
  document.addEventListener("click", (event) => {
    const link = event.target.closest("a[href^='#set=']");
    if (!link) return;
    const place = document.getElementById(link.dataset.story || link.closest(".episodes") ? "panel" : "board");
    const go = () => place.scrollIntoView();
    if (location.hash === link.hash) go();
    else addEventListener("hashchange", go, { once: true });
  });
})();
