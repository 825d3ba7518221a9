/* Where the answer stands: the factor with its status, the check, what governs; or the faults in words. */
import { byId, el, factor, fill } from "./dom.js";
import { on, tell } from "./link.js";
import { goTo } from "./controls.js";
import { runJob } from "./jobs.js";

let design = null, shown = null, spoken = "", unfolded = window.innerWidth >= 1120;

const tone = (answer) => {
  if (answer.lead === null) { return answer.faults.length ? "bad" : "plain"; }
  if (answer.acceptance.length) { return answer.acceptance.every((one) => one.met) ? "good" : "bad"; }
  const lead = answer.fos.limit ?? answer.fos.closed_form;
  return lead !== null && lead < 1 ? "bad" : "plain";
};

function badge(answer) {
  if (answer.agree === true) { return el("span", { class: "badge good" }, "AGREE"); }
  if (answer.agree === false) { return el("span", { class: "badge bad" }, answer.moments_govern ? "MOMENTS GOVERN" : "DISAGREE"); }
  return answer.lead === null ? null : el("span", { class: "badge plain" }, "no closed form");
}

function faultCard(fault) {
  return el("div", { class: "fault", role: "group" },
    el("p", { class: "what" }, fault.code ? el("code", {}, fault.code) : null, " ", fault.message),
    fault.where ? el("p", { class: "soft mono" }, fault.where) : null,
    fault.advice ? el("p", { class: "advice" }, fault.advice) : null,
    fault.path ? el("button", { type: "button", class: "link", onclick: () => goTo(fault.path) }, "Show this value") : null);
}

function numbers(answer) {
  const rows = [["PRE-IE, limit", answer.fos.limit], ...answer.fos.lowest === null ? [] : [["lowest estimate", answer.fos.lowest]],
    ["closed form", answer.fos.closed_form], ["upper bound (associated flow), not for design", answer.fos.static_bound]];
  if (rows.every(([, value]) => value === null)) { return null; }
  return el("table", { class: "numbers" }, el("tbody", {}, rows.map(([name, value]) =>
    el("tr", {}, el("th", { scope: "row" }, name), el("td", { class: "num" }, factor(value))))));
}

function governs(answer) {
  if (!answer.governs.length && !answer.why_no_governs) { return null; }
  return el("section", {}, el("h3", {}, "What governs"), answer.why_no_governs ? el("p", { class: "soft" }, answer.why_no_governs) : el("ul", { class: "governs" }, answer.governs.map((one) =>
    el("li", {}, one.paths.length ? el("button", { type: "button", class: "link", title: one.label, onclick: () => goTo(...one.paths) }, one.text) : one.text))));
}

const job = el("div", { class: "job" });  // stays while answers come and go

async function run() {
  const found = await runJob("analyse", {}, job);
  if (found) { tell("answer", { ...found, final: true }); }
}

function stale(answer) {
  if (!answer.stale) { return null; }
  return el("div", { class: "stale" },
    el("p", {}, answer.lead === null ? "Not analysed yet." : "The numbers are those of an earlier design."),
    design?.live === "button" ? el("button", { type: "button", class: "main", onclick: run }, "Analyse") : null, job);
}

export function show(answer) {
  shown = answer;
  const box = byId("answer"), faulty = answer.faults.length > 0;
  const focused = box.contains(document.activeElement) ? [...box.querySelectorAll("button")].indexOf(document.activeElement) : -1;
  fill(box,
    el("div", { class: `lead ${tone(answer)}${answer.stale ? " old" : ""}` },
      el("p", { class: "lead-of" }, "Factor of safety", answer.lead_of ? ` · ${answer.lead_of}` : ""),
      el("p", { class: `fos${answer.lead === null ? " none" : ""}`, id: "fos" }, answer.lead ?? (faulty ? "no answer" : answer.stale ? "…" : "no factor")),
      faulty ? null : el("p", { class: "status" }, answer.status_words),
      el("div", { class: "badges" }, badge(answer), answer.acceptance.map((one) =>
        el("span", { class: `badge ${one.met ? "good" : "bad"}` }, `${one.rule}${one.on} ${one.met ? "met" : "not met"}`)))),
    faulty ? el("section", { class: "faults", "aria-label": "Why there is no answer" }, answer.faults.map(faultCard),
      byId("view").classList.contains("blank") ? null : el("p", { class: "soft" }, "The dimmed view is the last design that could be analysed.")) : null,
    stale(answer), numbers(answer),
    answer.agree_words && answer.agree !== null ? el("p", { class: "soft small" }, answer.agree_words.replace(/\s{2,}/g, " · ")) : null,
    answer.moments.length ? el("section", { class: "moments" }, el("h3", {}, "Moments"), answer.moments.map((line) => el("p", {}, line))) : null,
    governs(answer),
    answer.notices.length ? el("section", { class: "notices" }, el("h3", {}, "Notices"), answer.notices.map((one) =>
      el("p", {}, el("code", {}, one.code), " ", one.text,
        one.path ? el("button", { type: "button", class: "link", onclick: () => goTo(one.path) }, "show") : null))) : null,
    answer.words.length ? el("details", { class: "words", open: unfolded, ontoggle: (event) => { unfolded = event.target.open; } }, el("summary", {}, "The slope in words"), answer.words.map((line) => el("p", {}, line))) : null,
    answer.ms && answer.ms.all ? el("p", { class: "soft small ms" }, `analysed in ${answer.ms.analysis.toFixed(1)} ms, all ${answer.ms.all.toFixed(1)} ms`) : null);
  if (focused >= 0) { box.querySelectorAll("button")[focused]?.focus(); }
  const words = faulty ? `No answer: ${answer.faults[0].message}` : answer.lead === null ? answer.status_words :
    `Factor of safety ${answer.lead}, ${answer.status_words}${answer.agree === true ? ", methods agree" : ""}`;
  if (answer.final && words !== spoken) { spoken = words; byId("spoken").textContent = words; }
  byId("answer").dataset.rev = answer.rev;
}

export function start() {
  on("design", (own) => { design = own; });
  on("answer", show);
  on("refused", (message) => { if (shown) { 
    show({ ...shown, faults: message.faults, lead: null, stale: false, governs: [], why_no_governs: "", moments: [], notices: [], acceptance: [], agree: null,
      fos: { limit: null, lowest: null, closed_form: null, static_bound: null } });
  } });
}
