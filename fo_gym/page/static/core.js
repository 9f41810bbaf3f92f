/* What all parts of the page share: its state, which the address holds, and the scripts that bring data. */
"use strict";
const fg = (() => {
  const MOST = 4;
  const FIRST = "*"; // whoever is shown before anybody is chosen
  const DEFAULTS = { set: "", show: FIRST, view: "traces", sort: "", family: "", search: "", seed: "", joint: "", t: "",
    price: "", story: "" };
  const state = { ...DEFAULTS };
  const listeners = [];
  const waiting = new Map();
  const received = new Map();
  let index = null;

  /* The state from the address; what it does not say is as at the start. */
  function read() {
    const told = new URLSearchParams(location.hash.slice(1));
    for (const key of Object.keys(DEFAULTS)) state[key] = told.get(key) ?? DEFAULTS[key];
  }

  function address() {
    const told = Object.entries(state).filter(([key, value]) => value !== DEFAULTS[key]);
    return "#" + told.map(([key, value]) => `${key}=${encodeURIComponent(value).replaceAll("%2C", ",").replaceAll("%2F", "/")}`).join("&");
  }

  /* Change the state, and tell everybody what changed. */
  function change(news) {
    const before = { ...state };
    Object.assign(state, news);
    const changed = new Set(Object.keys(state).filter((key) => state[key] !== before[key]));
    if (!changed.size) return;
    history.replaceState(null, "", address());
    tell(changed);
  }

  function tell(changed) {
    for (const listener of listeners) listener(changed);
  }

  function shown() {
    if (state.show === FIRST) return index.first[state.set] ?? [];
    return state.show ? state.show.split(",").map(decodeURIComponent).slice(-MOST) : [];
  }

  /* Show a competitor's traces, or no longer; of too many the first goes. */
  function toggle(name) {
    const names = shown();
    const next = names.includes(name) ? names.filter((each) => each !== name) : [...names, name];
    change({ show: next.slice(-MOST).map(encodeURIComponent).join(","), story: "" });
  }

  /* Run a script of the folder once. Scripts, since a page that is opened from a folder may load nothing else. */
  function load(source) {
    if (!waiting.has(source)) {
      waiting.set(source, new Promise((done, failed) => {
        const script = document.createElement("script");
        script.src = source;
        script.onload = () => done();
        script.onerror = () => { waiting.delete(source); failed(new Error(`${source} cannot be loaded`)); };
        document.head.append(script);
      }));
    }
    return waiting.get(source);
  }

  async function numbers() {
    await load("data/numbers.js");
    return received.get("numbers");
  }

  async function trace(key) {
    await load(index.traces[key]);
    return received.get(key);
  }

  /* An element with attributes and children; texts are texts, never markup. */
  function make(tag, attributes = {}, ...children) {
    const svg = ["svg", "g", "path", "circle", "line", "text", "title", "rect"].includes(tag);
    const element = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
      else if (value !== null && value !== undefined && value !== false) element.setAttribute(name, value === true ? "" : value);
    }
    element.append(...children.filter((child) => child !== null));
    return element;
  }

  function save(name, text) {
    const link = make("a", { href: URL.createObjectURL(new Blob([text], { type: "text/csv" })), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

  return {
    state, change, toggle, shown, load, make, save, color, numbers, trace_of: trace,
    get index() { return index; },
    listen(listener) { listeners.push(listener); },
    /* Called by the scripts in data/. */
    receive(told) { index = told; },
    trace(key, told) { received.set(key, told); },
    numbers_are(told) { received.set("numbers", told); },
    map(name, told) { received.set(`map ${name}`, told); },
    received: (key) => received.get(key),
    start() {
      read();
      tell(new Set(Object.keys(state)));
      addEventListener("hashchange", () => {
        if (!location.hash.includes("=")) return;
        read();
        tell(new Set(Object.keys(state)));
      });
    },
  };
})();
