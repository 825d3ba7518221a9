/* Bolts for a target factor, and into the design with them. */
import { byId, el, fill } from "./dom.js";
import { ask, on, tell } from "./link.js";
import { quiet } from "./live.js";
import { leave, now, outdate, watch } from "./fresh.js";
import { faults, runJob } from "./jobs.js";

let parts = null;

function optional(part, name) {
  const value = Number(parts[part].value);
  return value > 0 ? { [name]: value } : {};
}

async function run() {
  await quiet();
  parts.button.disabled = true;
  const of = now();
  const found = await runJob("support", { fos: Number(parts.target.value), acts: parts.acts.value, ...optional("capacity", "bolt_capacity"), ...optional("spacing", "spacing") }, parts.job);
  parts.button.disabled = false;
  if (!found) { return; }
  fill(parts.found, found.line ? el("p", {}, el("strong", {}, found.line)) : null, found.words.map((line) => el("p", {}, line)),
    (found.notices || []).map((one) => el("p", {}, el("code", {}, one.code), " ", one.text)),
    found.pattern || found.bolts?.length ? el("button", { type: "button", class: "main", id: "add-bolts", onclick: put }, "Put into the design") :
      el("p", { class: "soft" }, "There is no pattern to put into the design."));
  watch(parts.found, of, "These bolts were found for an earlier design or another target: find them again.");
}

async function put() {
  const back = await ask("add_bolts");
  if (back.faults?.length && !back.fos) { leave(parts.found); faults(parts.found, back.faults); return; }
  leave(parts.found);
  fill(parts.found, el("p", { class: "good" }, "The bolts are in the design: the answer beside is with them. Undo takes them out."));
  tell("goto", "design");
}

export function start() {
  const target = el("input", { type: "number", class: "box", min: 0.1, max: 20, step: 0.05, value: 1.5, id: "support-fos" });
  const capacity = el("input", { type: "number", class: "box", min: 1, value: 500, id: "support-capacity" });
  const spacing = el("input", { type: "number", class: "box", min: 0.5, step: 0.5, placeholder: "free", id: "support-spacing" });
  const acts = el("select", {}, ["active", "passive"].map((name) => el("option", { value: name }, name)));
  const button = el("button", { type: "button", class: "main", id: "support-run", onclick: run }, "Find bolts");
  const job = el("div", { class: "job" }), found = el("div", { class: "card-list" }), none = el("p", { class: "soft", hidden: true }, "This kind of design has no search for bolts.");
  fill(byId("screen-support"), el("h2", {}, "Bolts for a target"), none, el("div", { class: "form" }, el("label", {}, "factor of safety ", target),
    el("label", {}, "one bolt carries, kN ", capacity), el("label", {}, "spacing, m ", spacing), el("label", {}, "bolts act ", acts), button), job, found);
  for (const one of [target, capacity, spacing, acts]) { one.addEventListener("input", () => outdate(found)); }
  parts = { target, capacity, spacing, acts, button, job, found };
  let rev = null;
  on("design", (design) => {
    const can = design.jobs.includes("support");
    none.hidden = can; button.disabled = !can;
    if (rev !== null && rev !== design.rev) { leave(found); fill(found); }
    rev = design.rev;
  });
  on("answer", (answer) => {
    const rule = answer.acceptance.map((one) => /fos\s*>=\s*([\d.]+)/.exec(one.rule)).find(Boolean);
    if (rule && !target.dataset.set) { target.value = rule[1]; target.dataset.set = "1"; }
  });
}
