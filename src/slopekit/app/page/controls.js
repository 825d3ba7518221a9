/* The design as sliders and boxes, in the groups of its file. */
import { byId, el, figure, fill } from "./dom.js";
import { ask, on } from "./link.js";
import { change } from "./live.js";

const MOST = 80;  // controls of a group that are drawn before it is opened
const STEPS = 400;  // of a slider that goes by the logarithm
const rows = new Map();  // by path: what is drawn of a control
let groups = [];
let folded = null;

export function control(path) { return rows.get(path)?.own; }
export function controls() { return [...rows.values()].map((row) => row.own); }
export const numbers = () => controls().filter((one) => one.type === "number" && one.low !== null && one.high !== null);

function sliderOf(own, value) {
  return own.log ? Math.round(STEPS * Math.log(value / own.low) / Math.log(own.high / own.low)) : value;
}

function valueOf(own, at) {
  return own.log ? Number((own.low * Math.pow(own.high / own.low, at / STEPS)).toPrecision(3)) : Number(Number(at).toPrecision(10));
}

/** A value of a control with its unit, a coordinate to the millimetre. */
export function shown(own, value, digits = 8) {
  if (value === null || value === undefined) { return ""; }
  if (typeof value !== "number") { return String(value); }
  const unit = own.unit === "°" ? "°" : own.unit ? ` ${own.unit}` : "";
  return (own.place ? value.toFixed(3) : figure(value, digits)) + unit;
}

function numberRow(own) {
  const id = `c-${own.path}`;
  const box = el("input", { type: "text", class: "box", id: `${id}-box`, autocomplete: "off", spellcheck: "false",
    "aria-label": `${own.label}, as a number with its unit`, title: own.example ? `for example ${own.example}` : null });
  const slider = el("input", { type: "range", id, min: own.log ? 0 : own.low, max: own.log ? STEPS : own.high,
    step: own.log ? 1 : own.step || "any", "aria-label": own.label });
  const slid = (final) => {
    const value = valueOf(own, slider.value);
    take(own.path, { value, text: shown(own, value) });
    change({ [own.path]: value }, final);
  };
  slider.addEventListener("input", () => slid(false));
  slider.addEventListener("change", () => slid(true));
  box.addEventListener("change", () => typed(own, box.value));
  box.addEventListener("keydown", (event) => {
    const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (event.key === "Escape") { box.value = own.text; box.blur(); }
    if (!way || typeof own.value !== "number") { return; }
    event.preventDefault();
    const step = (own.step || 1) * (event.shiftKey ? 10 : 1);
    let value = own.value + way * step;
    if (own.period) { value = (value + own.period) % own.period; }
    if (own.low !== null) { value = Math.min(Math.max(value, own.low), own.high); }
    value = Number(value.toPrecision(10));
    take(own.path, { value, text: shown(own, value) });
    change({ [own.path]: value }, true);
  });
  return { box, slider, line: [el("div", { class: "slot" }, slider, box)] };
}

function typed(own, text) {
  const plain = /^\s*([-+]?[\d.]+(?:e[-+]?\d+)?)\s*(\S*)\s*$/i.exec(text);
  const same = plain && (!plain[2] || plain[2] === own.unit || plain[2] === "deg") ? Number(plain[1]) : null;
  take(own.path, same !== null && Number.isFinite(same) && own.type === "number" ? { value: same, text: shown(own, same) } : { text });
  change({ [own.path]: text.trim() === "" ? null : text.trim() }, true);
}

function wordsRow(own) {
  const box = el("select", { id: `c-${own.path}`, "aria-label": own.label, onchange: () => {
    take(own.path, { value: box.value, text: box.value });
    change({ [own.path]: box.value }, true);
  } }, own.instead ? el("option", { value: "", disabled: true, selected: true }, `by ${own.instead.replaceAll("_", " ")}`) : null,
  own.words.includes(own.value) || own.value === null ? null : el("option", { value: own.value }, own.value),
  own.words.map((word) => el("option", { value: word }, word)));
  return { box, line: [box] };
}

function flagRow(own) {
  const box = el("input", { type: "checkbox", id: `c-${own.path}`, "aria-label": own.label,
    onchange: () => { change({ [own.path]: box.checked ? "true" : "false" }, true); } });
  return { box, line: [box] };
}

function textRow(own) {
  const box = el("input", { type: "text", class: "wide-box", id: `c-${own.path}`, "aria-label": own.label, autocomplete: "off",
    onchange: () => {
      take(own.path, { value: box.value, text: box.value });
      change({ [own.path]: box.value }, true);
    } });
  return { box, line: [box] };
}

function rowOf(own) {
  const slides = own.low !== null && own.high !== null && own.high > own.low && (own.type === "number" || own.type === "count");
  const made = slides ? numberRow(own) : { words: wordsRow, flag: flagRow }[own.type]?.(own) || textRow(own);
  const back = el("button", { type: "button", class: "back", "aria-label": `${own.label}: back to ${own.opened || "what it was"}`,
    onclick: () => { ask("reset", { path: own.path }); } }, "↺");
  const label = el("label", { for: `c-${own.path}`, title: own.doc || null }, own.label);
  const element = el("div", { class: `control of-${own.type}`, "data-path": own.path },
    el("div", { class: "head" }, label, own.scatter ? el("span", { class: "chip", title: "scatters: see Probability" }, own.scatter.dist) : null, back),
    made.line);
  const row = { own, element, back, ...made };
  rows.set(own.path, row);
  refresh(row);
  return element;
}

function refresh(row) {
  const { own } = row;
  if (document.activeElement !== row.box || row.box.type !== "text" || row.box.value === "") {
    if (row.box.type === "checkbox") { row.box.checked = own.value === true || own.value === "true"; }
    else if (own.type === "words") { row.box.value = own.value ?? ""; }
    else { row.box.value = own.is_default && typeof own.value === "number" ? shown(own, own.value, 6) : own.text || shown(own, own.value); }
  }
  if (row.slider) {
    const has = typeof own.value === "number";
    const middle = own.log ? Math.sqrt(own.low * own.high) : own.low;
    if (has && !own.log) {
      if (own.value > own.high) { own.high = own.value; row.slider.max = own.value; }
      if (own.value < own.low) { own.low = own.value; row.slider.min = own.value; }
    }
    row.slider.value = sliderOf(own, has ? own.value : middle);
    const ends = Number(row.slider.max) - Number(row.slider.min);
    row.slider.style.setProperty("--part", `${100 * (Number(row.slider.value) - Number(row.slider.min)) / (ends || 1)}%`);
    row.slider.setAttribute("aria-valuetext", has ? own.text || shown(own, own.value) : "not given");
  }
  row.element.classList.toggle("default", own.is_default && !own.changed);
  row.element.classList.toggle("changed", own.changed);
  row.back.hidden = !own.changed;
  row.back.title = `back to ${own.opened || "the default"}`;
}

/** What was set here or on the net, before the server has answered. */
export function take(path, given) {
  const row = rows.get(path);
  if (!row) { return; }
  Object.assign(row.own, { given: true, is_default: false, changed: true }, given);
  refresh(row);
}

function build(design) {
  rows.clear();
  groups = design.groups;
  for (const group of groups) {  // several of one name say whose they are
    const names = group.controls.map((own) => own.label);
    group.controls.forEach((own, k) => {
      const parts = own.path.split(".");
      if (names.indexOf(names[k]) !== names.lastIndexOf(names[k]) && parts.length > 2) {
        const [list, name] = parts.slice(-3), k = Number(name);
        own.label += ` of ${Number.isNaN(k) ? name : `${list.replace(/s$/, "")} ${k + 1}`}`;
      }
    });
  }
  if (!folded) { folded = new Set(["analysis", "title"]); }
  fill(byId("controls"), groups.map((group) => {
    const large = group.controls.length > MOST, body = el("div", { class: "group-body" }, large ? null : group.controls.map(rowOf));
    if (large) { folded.add(group.name); }
    return el("details", { class: large ? "group large" : "group", "data-group": group.name, open: !folded.has(group.name),
      ontoggle: (event) => {
        if (event.target.open && !body.firstChild) { fill(body, group.controls.map(rowOf)); }
        if (!filtering()) { folded[event.target.open ? "delete" : "add"](group.name); }
      } }, el("summary", {}, el("span", {}, group.label), el("span", { class: "count" }),
      large ? el("span", { class: "soft small" }, `${group.controls.length} values`) : null), body);
  }));
  counted(design.changed);
  sift();
}

const filtering = () => byId("filter").value.trim() !== "" || byId("only-changed").checked;

function sift() {
  const words = byId("filter").value.toLowerCase().split(/\s+/).filter(Boolean), changed = byId("only-changed").checked;
  let any = false;
  for (const group of byId("controls").querySelectorAll(".group")) {
    let shownHere = 0;
    for (const element of group.querySelectorAll(".control")) {
      const { own } = rows.get(element.dataset.path);
      const text = `${own.path} ${own.label} ${own.doc || ""}`.toLowerCase();
      element.hidden = !words.every((word) => text.includes(word)) || (changed && !own.changed);
      if (!element.hidden) { shownHere += 1; }
    }
    group.hidden = !shownHere && (filtering() || !group.classList.contains("large"));
    any = any || shownHere > 0;
    if (filtering()) { group.open = shownHere > 0; } else { group.open = !folded.has(group.dataset.group); }
  }
  byId("controls").classList.toggle("empty", !any);
}

function counted(changed) {
  byId("changed-count").textContent = changed.length;
  for (const group of groups) {
    const element = byId("controls").querySelector(`[data-group="${CSS.escape(group.name)}"] .count`);
    const own = group.controls.filter((one) => changed.includes(one.path)).length;
    if (element) { element.textContent = own ? `${own} changed` : ""; }
  }
}

/** Bring a control into sight and put the hand on it. */
export function goTo(...paths) {  // to the first; all of them are marked
  const at = (path) => rows.get(path) || [...rows.values()].find((one) => one.own.path.startsWith(`${path}.`) || path.startsWith(`${one.own.path}.`));
  const all = paths.map(at).filter(Boolean), row = all[0];
  if (!row) { return; }
  byId("filter").value = ""; byId("only-changed").checked = false;
  sift();
  all.forEach((one) => { one.element.closest("details").open = true; });
  row.element.scrollIntoView({ block: "center" });
  (row.slider || row.box).focus();
  all.forEach((one) => one.element.classList.add("found"));
  window.setTimeout(() => all.forEach((one) => one.element.classList.remove("found")), all.length > 1 ? 4000 : 1600);
}

export function start() {
  on("design", build);
  on("values", (values) => { for (const [path, given] of Object.entries(values)) { take(path, given); } });
  on("kept", (values) => {  // refused: the boxes go back to what the design has
    for (const [path, given] of Object.entries(values)) {
      const row = rows.get(path);
      if (row) { Object.assign(row.own, given); row.box.value = given.text; refresh(row); }
    }
  });
  on("answer", (answer) => {
    if (!answer.changed) { return; }
    for (const row of rows.values()) {
      const changed = answer.changed.includes(row.own.path);
      if (changed !== row.own.changed && answer.final) { row.own.changed = changed; refresh(row); }
    }
    counted(answer.changed);
  });
  byId("filter").addEventListener("input", sift);
  byId("only-changed").addEventListener("change", sift);
}
