/* Dark or light: as the system has it, until the reader says otherwise. Runs before anything is drawn. */
"use strict";
(() => {
  const root = document.documentElement;
  const memory = {
    get() { try { return localStorage.getItem("theme"); } catch { return null; } },
    set(value) { try { localStorage.setItem("theme", value); } catch { /* a page from a folder may have no memory */ } },
  };
  const system = matchMedia("(prefers-color-scheme: dark)");
  const apply = () => {
    root.dataset.theme = memory.chosen || (system.matches ? "dark" : "light");
    document.dispatchEvent(new Event("themed"));
  };
  memory.chosen = memory.get();
  apply();
  system.addEventListener("change", apply);
  addEventListener("DOMContentLoaded", () => {
    document.getElementById("theme").addEventListener("click", () => {
      memory.chosen = root.dataset.theme === "dark" ? "light" : "dark";
      memory.set(memory.chosen);
      apply();
    });
  });
})();
