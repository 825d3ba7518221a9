/* Studies that take a while: progress, cancel, and what came of them. */
import { el, fill } from "./dom.js";
import { ask, on } from "./link.js";

const under = new Map();
let current = null;  // the server does one job at a time
const early = new Map();  // ends that came before their beginning was known

/** Start a job and show it in a box; the promise holds its result, null where it was cancelled or could not be. */
export async function runJob(job, given, box) {
  if (current?.what === "curve") {  // it is drawn by itself: what is asked for goes first
    if (current.number !== null) { ask("cancel", { job: current.number }); }
    await current.end;
  }
  let finish = null;
  const mine = { what: job, number: null, end: new Promise((done) => { finish = done; }) };
  current = mine;
  const found = await begun(job, given, box, mine);
  if (current === mine) { current = null; }
  finish();
  return found;
}

async function begun(job, given, box, mine) {
  const back = await ask("start", { job, ...given });
  mine.number = back.job ?? null;
  if (back.faults) { faults(box, back.faults); return null; }
  const bar = el("progress", { "aria-label": "progress" }), words = el("span", { class: "soft" }, "started");
  fill(box, el("div", { class: "progress" }, bar, words,
    el("button", { type: "button", onclick: () => { ask("cancel", { job: back.job }); } }, "Cancel")));
  return new Promise((done) => {
    under.set(back.job, { bar, words, box, done });
    if (early.has(back.job)) { ended(early.get(back.job)); early.delete(back.job); }
  });
}

export function faults(box, list) {
  fill(box, list.map((fault) => el("div", { class: "fault" }, el("p", { class: "what" }, fault.code ? el("code", {}, fault.code) : null, " ", fault.message),
    fault.where ? el("p", { class: "soft mono" }, fault.where) : null,
    fault.advice ? el("p", { class: "advice" }, fault.advice) : null)));
}

function ended(message) {
  const own = under.get(message.job);
  if (!own) { early.set(message.job, message); return; }
  under.delete(message.job);
  if (message.faults) { faults(own.box, message.faults); own.done(null); }
  else if (message.cancelled) { fill(own.box, el("p", { class: "soft" }, "Cancelled.")); own.done(null); }
  else { fill(own.box); own.done(message.result); }
}

export function start() {
  on("progress", (message) => {
    const own = under.get(message.job);
    if (!own) { return; }
    if (message.total) { own.bar.max = message.total; own.bar.value = message.done; } else { own.bar.removeAttribute("value"); }
    own.words.textContent = `${message.words ? `${message.words} ` : ""}${message.done ?? ""}${message.total ? ` of ${message.total}` : ""}`;
  });
  on("done", ended);
  on("down", () => { for (const [job] of under) { ended({ job, faults: [{ message: "The connection was lost." }] }); } });
}
