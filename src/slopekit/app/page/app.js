/* The page of slopekit app: what is on it is put together here. */
import { byId } from "./dom.js";
import { ask, connect, on, tell } from "./link.js";
import { change } from "./live.js";
import * as answer from "./answer.js";
import * as controls from "./controls.js";
import * as curve from "./curve.js";
import * as fresh from "./fresh.js";
import * as handover from "./handover.js";
import * as jobs from "./jobs.js";
import { netIn } from "./net.js";
import * as opening from "./opening.js";
import * as probability from "./probability.js";
import * as saving from "./saving.js";
import * as support from "./support.js";
import * as survey from "./survey.js";

// -- the scene and the net --------------------------------------------------------------------------------------------
const view = slopekitView(byId("view"));  // eslint-disable-line no-undef -- the one global, of viewer.js
const net = netIn(byId("net"), byId("planes"), (plane, final) => {
  const values = { [`${plane.path}.dip`]: plane.dip, [`${plane.path}.dip_direction`]: plane.dip_direction };
  for (const [path, value] of Object.entries(values)) { controls.take(path, { value, text: `${Number(value.toFixed(4))}°` }); }
  change(values, final);
});
let waitingScene = null, own = "", drawn = "", renamed = false;  // the design, and whose scene is drawn

function showScene(scene) {
  if (byId("screen-design").hidden) { waitingScene = scene; return; }  // drawn when it is seen
  waitingScene = null;
  drawn = own;
  if (view.works) { view.show(scene); }
}

on("answer", (given) => {
  const began = performance.now();
  if (given.net) {
    const bare = !given.net.planes.length && !given.net.face;
    byId("orientations").hidden = bare;
    byId("view").classList.toggle("alone", bare);
    net.show(given.net);
  }
  if (given.scene && !given.stale) { showScene(given.scene); }
  byId("view").classList.toggle("dimmed", given.faults.length > 0 || given.stale);
  byId("view").classList.toggle("blank", drawn !== own && !waitingScene);  // of another design: nothing is better
  byId("undo").disabled = !given.can_undo;
  byId("redo").disabled = !given.can_redo;
  document.documentElement.dataset.shown = given.rev;
  document.documentElement.dataset.painted = String(performance.now() - began);
});
on("design", (design) => {
  document.documentElement.dataset.live = design.live;
  own = `${design.kind} ${design.name}`;
  if (renamed) { drawn = own; renamed = false; }
  byId("title").textContent = design.title || design.name || design.kind;
  byId("file").textContent = design.file || `${design.kind}, not in a file yet`;
  byId("file").title = design.file || "";
  document.title = `${design.title || design.name} · slopekit`;
  byId("undo").disabled = !design.can_undo;
  byId("redo").disabled = !design.can_redo;
});
on("touched", (values) => { if (typeof values.title === "string") { byId("title").textContent = values.title; } });
on("saved", (back) => { byId("file").textContent = back.file; renamed = true; });

// -- screens ----------------------------------------------------------------------------------------------------------
const tabs = [...document.querySelectorAll('[role="tab"]')];

function goTo(name, focus) {
  for (const tab of tabs) {
    const here = tab.id === `tab-${name}`;
    tab.setAttribute("aria-selected", String(here));
    tab.tabIndex = here ? 0 : -1;
    byId(tab.getAttribute("aria-controls")).hidden = !here;
    if (here && focus) { tab.focus(); }
  }
  document.documentElement.dataset.screen = name;
  if (name === "design" && waitingScene) { showScene(waitingScene); }
  tell("screen", name);
}
tabs.forEach((tab, k) => {
  const name = tab.id.slice(4);
  tab.addEventListener("click", () => goTo(name));
  tab.addEventListener("keydown", (event) => {
    const to = { ArrowRight: k + 1, ArrowLeft: k - 1, Home: 0, End: tabs.length - 1 }[event.key];
    if (to === undefined) { return; }
    event.preventDefault();
    goTo(tabs[(to + tabs.length) % tabs.length].id.slice(4), true);
  });
});
on("goto", goTo);

// -- tools ------------------------------------------------------------------------------------------------------------
async function step(verb) {
  const back = await ask(verb);
  if (back.faults && !back.fos) { tell("say", back.faults[0].message); }
}
byId("undo").addEventListener("click", () => step("undo"));
byId("redo").addEventListener("click", () => step("redo"));
byId("save").addEventListener("click", () => saving.save());
byId("open").addEventListener("click", () => opening.open());
document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.altKey || document.querySelector("dialog[open]")) { return; }
  const key = event.key.toLowerCase();
  const typing = event.target.matches?.('input[type="text"], input[type="search"], input[type="number"]') &&
    event.target.value !== event.target.defaultValue && event.target.dataset.typed;
  if (key === "s") { event.preventDefault(); saving.save(); }
  else if (typing) { return; }
  else if (key === "z") { event.preventDefault(); step(event.shiftKey ? "redo" : "undo"); }
  else if (key === "y") { event.preventDefault(); step("redo"); }
});
document.addEventListener("input", (event) => { if (event.target.matches('[type="text"]')) { event.target.dataset.typed = "1"; } });
document.addEventListener("change", (event) => { if (event.target.dataset) { delete event.target.dataset.typed; } });

// -- dark and light ---------------------------------------------------------------------------------------------------
const dark = window.matchMedia("(prefers-color-scheme: dark)");
let chosen = null;
try { chosen = localStorage.getItem("slopekit-theme"); } catch { /* nothing is kept then */ }

function dress() {
  document.documentElement.dataset.theme = chosen || (dark.matches ? "dark" : "light");
  view.paper?.(getComputedStyle(document.documentElement).getPropertyValue("--scene").trim());
}
dark.addEventListener("change", dress);
byId("theme").addEventListener("click", () => {
  chosen = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
  try { localStorage.setItem("slopekit-theme", chosen); } catch { /* nothing is kept then */ }
  dress();
});

// -- words that pass, and the connection ------------------------------------------------------------------------------
let passing = 0;
on("say", (text) => {
  byId("said").textContent = text;
  byId("said").classList.add("on");
  window.clearTimeout(passing);
  passing = window.setTimeout(() => byId("said").classList.remove("on"), 6000);
});
on("up", () => { byId("lost").hidden = true; });
on("down", () => {
  byId("lost").hidden = false;
  byId("lost").textContent = "slopekit does not answer: it was stopped, or is starting again. What is shown is the last that it said.";
});

dress();
for (const part of [fresh, controls, answer, jobs, curve, probability, support, survey, handover, saving, opening]) { part.start(); }
goTo("design");
connect();
