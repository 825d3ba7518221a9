/* What is changed goes to the server at once, one message at a time: while one is under way the newest values wait. */
import { ask, on, tell } from "./link.js";

let live = "drag";
let pending = {};
let isFinal = false;
let under = false;
const idle = [];

on("design", (design) => { live = design.live; });

/** Set values by path; `final` where the hand has let go. */
export function change(values, final) {
  Object.assign(pending, values);
  isFinal = isFinal || final;
  tell("touched", values);
  send();
}

/** A promise that nothing waits and nothing is under way. */
export function quiet() {
  return under || Object.keys(pending).length ? new Promise((done) => { idle.push(done); }) : Promise.resolve();
}

async function send() {
  if (under || !Object.keys(pending).length || (!isFinal && live !== "drag")) { return; }
  const values = pending, final = isFinal;
  pending = {}; isFinal = false; under = true;
  const back = await ask("set", { values, final });
  under = false;
  if (back.values) { tell("values", back.values); }
  if (back.faults && !back.fos) { tell("kept", back.kept || {}); tell("refused", back); }
  if (Object.keys(pending).length) { send(); } else { idle.splice(0).forEach((done) => done()); }
}
