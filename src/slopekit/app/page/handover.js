/* What goes to others: page, drawing, numbers, the file, and the command that gives the same numbers. */
import { byId, el, fill } from "./dom.js";
import { ask, on } from "./link.js";
import { quiet } from "./live.js";
import { faults } from "./jobs.js";
import { now } from "./fresh.js";

const OFFERS = [["page", "Report page", "One self-contained page: the answer, its check, the scene to turn, inputs and defaults."],
  ["dxf", "Drawing (DXF)", "Blocks, joints and bolts for CAD."], ["json", "Numbers (JSON)", "Every number of the result, by stable keys."],
  ["yaml", "Design file (YAML)", "The design as it is now."], ["command", "Command line", "A line that gives the same numbers."]];

async function make(what, box) {
  await quiet();
  fill(box, el("p", { class: "soft" }, "making …"));
  const of = now(), back = await ask("handover", { what });
  if (of !== now()) { fill(box, el("p", { class: "soft" }, "The design has changed meanwhile: ask again.")); return; }
  if (back.faults) { faults(box, back.faults); return; }
  if (back.text !== undefined && !back.address) {
    const said = el("span", { class: "soft", role: "status" }), line = el("pre", { tabindex: 0 }, back.text);
    fill(box, back.note ? el("p", {}, back.note) : null, line, el("button", { type: "button", onclick: async () => {
      try { await navigator.clipboard.writeText(back.text); said.textContent = " copied"; }
      catch { getSelection().selectAllChildren(line); said.textContent = " selected: copy it with Ctrl+C"; }
    } }, "Copy"), said);
    return;
  }
  fill(box, el("p", {}, el("a", { href: back.address, download: back.name }, `Download ${back.name}`)));
}

export function start() {
  const boxes = [];
  fill(byId("screen-handover"), el("h2", {}, "Hand over"), el("div", { class: "cards" }, OFFERS.map(([what, name, words]) => {
    const box = el("div", { class: "made", "data-what": what });
    boxes.push(box);
    return el("section", { class: "card" }, el("h3", {}, name), el("p", { class: "soft" }, words),
      el("button", { type: "button", class: "main", "data-make": what, onclick: () => make(what, box) }, what === "command" ? "Show" : "Make"), box);
  })));
  on("touched", () => { boxes.forEach((box) => fill(box)); });
  on("design", () => { boxes.forEach((box) => fill(box)); });
}
