/* What scatters, on sliders; the probability of failure with its histogram. */
import { byId, el, figure, fill, svg } from "./dom.js";
import { on } from "./link.js";
import { quiet } from "./live.js";
import { control, numbers } from "./controls.js";
import { leave, now, outdate, watch } from "./fresh.js";
import { runJob } from "./jobs.js";
import { paper } from "./plot.js";

const rows = new Map();  // by path: its distribution
let parts = null, kind = null, changes = 0;  // of what scatters, of samples and seed
const known = ["normal", "lognormal", "uniform", "triangular"];
const bare = (path) => path.replace(/\.mean$/, "");

function first(own, dist) {
  const value = own.value, about = Math.max(Math.abs(value) * (own.unit === "°" && value > 90 ? 0.03 : 0.1), (own.step || 0.01));
  const spread = own.unit === "°" ? Math.min(Math.max(about, 1), 10) : about;
  if (dist === "normal" || dist === "lognormal") { return { dist, sd: spread }; }
  return { dist, min: Math.max(value - 2 * spread, own.low ?? -Infinity), max: value + 2 * spread };
}

function add(path, given) {
  const own = control(path);
  if (!own || typeof own.value !== "number") { return; }
  const start = given && known.includes(given.dist) ? { ...given } : first(own, "normal");
  delete start.mean; delete start.mode;
  rows.set(path, start);
  otherwise();
  draw();
}

function slider(own, of, name, low, high) {
  const unitful = (value) => `${figure(value, 4)}${own.unit === "°" ? "" : " "}${own.unit || ""}`;
  const text = el("output", {}, unitful(of[name]));
  const input = el("input", { type: "range", min: low, max: high, step: (high - low) / 200, value: of[name],
    "aria-label": `${own.label}: ${name === "sd" ? "standard deviation" : name}`,
    oninput: () => { of[name] = Number(Number(input.value).toPrecision(4)); otherwise(); text.textContent = unitful(of[name]); shape(); } });
  function shape() { input.style.setProperty("--part", `${100 * (of[name] - low) / (high - low || 1)}%`); }
  shape();
  return el("label", { class: "slot3" }, el("span", { class: "soft" }, name === "sd" ? "sd" : name), input, text);
}

function otherwise() {
  changes += 1;
  outdate(parts.found);
}

function draw() {
  fill(parts.rows, [...rows].map(([path, of]) => {
    const own = control(path);
    if (!own) { return null; }
    const reach = of.sd !== undefined ? Math.max(3 * of.sd, own.unit === "°" ? 10 : 0.4 * Math.abs(own.value)) : 0;
    const far = Math.max(Math.abs(of.max - own.value || 0), Math.abs(own.value - of.min || 0)) * 2;
    const pick = el("select", { "aria-label": `${own.label}: distribution`, onchange: () => { rows.set(path, first(own, pick.value)); otherwise(); draw(); } },
      known.map((name) => el("option", { value: name }, name)));
    pick.value = of.dist;
    return el("div", { class: "scatter", "data-path": path }, el("div", { class: "head" }, el("strong", {}, own.label),
      el("span", { class: "soft" }, own.text || figure(own.value)), pick,
      el("button", { type: "button", class: "back", "aria-label": `${own.label} does not scatter`, onclick: () => { rows.delete(path); otherwise(); draw(); } }, "×")),
    of.sd !== undefined ? slider(own, of, "sd", reach / 200, reach) :
      [slider(own, of, "min", Math.max(own.value - far, own.low ?? -Infinity), own.value), slider(own, of, "max", own.value, own.value + far)]);
  }), rows.size ? null : el("p", { class: "soft" }, "Nothing scatters yet: choose a value below."));
  const free = numbers().filter((one) => typeof one.value === "number" && one.type === "number" && !rows.has(one.path) &&
    !/^(analysis|acceptance)\./.test(one.path) && !/\.(sd|min|max)$/.test(one.path));
  fill(parts.pick, el("option", { value: "" }, "add a value that scatters …"), free.map((one) => el("option", { value: one.path }, one.label)));
}

/** What the bars do not show, counted: samples beyond them, and what became of all. */
function beyond(found) {
  const { below, above } = found.histogram || {}, parts = [];
  if (below || above) { parts.push(`${below || 0} samples lie below what is drawn, ${above || 0} above.`); }
  const outcomes = Object.entries(found.outcomes || {}).filter(([, count]) => count);
  if (outcomes.length) { parts.push(`Outcomes: ${outcomes.map(([name, count]) => `${name.replaceAll("_", " ")} ${count}`).join(", ")}.`); }
  return parts.length ? el("p", { class: "soft" }, parts.join(" ")) : null;
}

/** Rank correlations with the factor as bars to the left and right. */
function sensitivity(list) {
  const known = list.filter((one) => one.rank_correlation !== null);
  if (!known.length) { return null; }
  return el("div", {}, el("h3", {}, "What the scatter of the factor follows (rank correlation)"), el("table", { class: "ranks" }, el("tbody", {},
    known.map((one) => {
      const bar = el("i", { class: one.rank_correlation < 0 ? "less" : "more" });
      bar.style.width = `${50 * Math.abs(one.rank_correlation)}%`;
      return el("tr", {}, el("th", { scope: "row" }, one.label), el("td", { class: "num" }, one.rank_correlation.toFixed(2)), el("td", { class: "bar" }, bar));
    }))));
}

async function run() {
  await quiet();
  const scatter = {};
  for (const [path, of] of rows) {
    scatter[bare(path)] = of.dist === "triangular" ? { ...of, mode: control(path).value } : of.sd !== undefined ? { ...of, mean: control(path).value } : { ...of };
  }
  parts.run.disabled = true;
  const of = now(), drawn = changes;
  const found = await runJob("probability", { samples: Number(parts.samples.value), seed: Number(parts.seed.value), scatter }, parts.job);
  parts.run.disabled = false;
  if (!found) { return; }
  show(found);
  watch(parts.found, of, "These numbers are of an earlier design, or of another scatter: run again.");
  if (drawn !== changes) { outdate(parts.found); }
}

const percent = (p) => (p === null || p === undefined ? "–" : p === 0 ? "0 %" : `${figure(100 * p, 3)} %`);

function show(found) {
  const edges = found.histogram?.edges || [], counts = found.histogram?.limit || [];
  const most = Math.max(...counts, 1);
  const sheet = edges.length > 1 ? paper({ x: [Math.min(edges[0], 0.95), Math.max(edges[edges.length - 1], 1.05)], y: [0, most * 1.08], xLabel: "factor of safety",
    yLabel: "samples", label: "Histogram of the factor of safety" }) : null;
  if (sheet) {
    fill(sheet.inner, counts.map((count, k) => svg("rect", { x: sheet.x(edges[k]) + 0.5, y: sheet.y(count),
      width: Math.max(sheet.x(edges[k + 1]) - sheet.x(edges[k]) - 1, 0.5), height: Math.max(sheet.bottom - sheet.y(count), 0),
      class: edges[k + 1] <= 1 + 1e-12 ? "bar fails" : "bar" }, svg("title", {}, `${figure(edges[k], 4)} to ${figure(edges[k + 1], 4)}: ${count}`))),
    svg("line", { x1: sheet.x(1), x2: sheet.x(1), y1: sheet.top, y2: sheet.bottom, class: "one" }),
    svg("text", { x: sheet.x(1) + 5, y: sheet.top + 10, class: "tick" }, "F = 1"));
  }
  fill(parts.found, el("div", { class: "figures" }, el("div", {}, el("span", { class: "soft" }, "probability of failure"),
    el("strong", { id: "pf" }, percent(found.pf)), el("span", { class: "soft" }, found.low === null || found.low === undefined ? "" : `${percent(found.low)} to ${percent(found.high)} (${percent(found.confidence ?? 0.95)} confidence)`)),
  el("div", {}, el("span", { class: "soft" }, "samples"), el("strong", {}, found.samples), el("span", { class: "soft" }, found.pf_closed_form === null || found.pf_closed_form === undefined ? "" : `closed form ${percent(found.pf_closed_form)}`))),
  sheet ? sheet.sheet : null, beyond(found), sensitivity(found.sensitivity || []), (found.notices || []).map((one) => el("p", {}, el("code", {}, one.code), " ", one.text)));
}

function build() {
  const box = el("div", { class: "rows" }), job = el("div", { class: "job" }), found = el("div", { class: "chart-box" });
  const pick = el("select", { "aria-label": "a value that scatters", id: "scatter-pick", onchange: () => { if (pick.value) { add(pick.value); } } });
  const samples = el("input", { type: "number", class: "box", min: 10, max: 200000, value: 2000, oninput: otherwise });
  const seed = el("input", { type: "number", class: "box", min: 0, value: 1, oninput: otherwise });
  const button = el("button", { type: "button", class: "main", id: "prob-run", onclick: run }, "Run");
  fill(byId("screen-probability"), el("h2", {}, "What scatters"), box, pick,
    el("div", { class: "form" }, el("label", {}, "samples ", samples), el("label", {}, "seed ", seed), button), job, found);
  parts = { rows: box, job, found, pick, samples, seed, run: button };
}

export function start() {
  build();
  on("design", (design) => {
    const all = numbers();
    if (kind !== design.name + design.kind) {
      kind = design.name + design.kind;
      rows.clear(); leave(parts.found); fill(parts.found);
      for (const own of all) { if (own.scatter && known.includes(own.scatter.dist)) { rows.set(own.path, { ...own.scatter }); delete rows.get(own.path).mean; } }
      if (!rows.size) {
        for (const own of all.filter((one) => /^strength\..*\.(phi|c)$/.test(one.path) && one.given && one.value > 0).slice(0, 2)) { rows.set(own.path, first(own, "normal")); }
      }
    }
    for (const path of [...rows.keys()]) { if (!control(path)) { rows.delete(path); } }
    draw();
  });
  on("answer", (answer) => { if (answer.final && !byId("screen-probability").hidden) { draw(); } });
  on("screen", (name) => { if (name === "probability") { draw(); } });
}
