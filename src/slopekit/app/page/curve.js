/* The factor of safety over any slider, with the present design as a dot that goes with the hand. */
import { byId, el, factor, figure, fill, svg } from "./dom.js";
import { on } from "./link.js";
import { change, quiet } from "./live.js";
import { control, numbers, shown, take } from "./controls.js";
import { leave, now, watch } from "./fresh.js";
import { runJob } from "./jobs.js";
import { broken, paper } from "./plot.js";

let path = null, curve = null, sheet = null, dot = null, answer = null, running = false, again = false, live = "drag";
let parts = null;

function build() {
  const pick = el("select", { id: "curve-path", "aria-label": "value along the axis", onchange: () => { path = pick.value; ends(); run(); } });
  const low = el("input", { type: "text", class: "box", "aria-label": "from", inputmode: "decimal" });
  const high = el("input", { type: "text", class: "box", "aria-label": "to", inputmode: "decimal" });
  const points = el("input", { type: "number", class: "box", min: 5, max: 401, value: 41, "aria-label": "points" });
  const job = el("div", { class: "job" }), chart = el("div", { class: "chart-box" }), note = el("p", { class: "soft" });
  fill(byId("screen-curve"), el("div", { class: "form" },
    el("label", {}, "Factor of safety over ", pick), el("label", {}, "from ", low), el("label", {}, "to ", high),
    el("label", {}, "points ", points), el("button", { type: "button", class: "main", id: "curve-run", onclick: run }, "Draw")), job, chart, note);
  parts = { pick, low, high, points, job, chart, note };
}

function list() {
  const all = numbers().filter((one) => typeof one.value === "number");
  fill(parts.pick, all.map((one) => el("option", { value: one.path }, one.label)));
  if (!all.some((one) => one.path === path)) {
    path = (all.find((one) => one.path.endsWith(".phi")) || all.find((one) => one.path.includes(".phi")) || all[0])?.path ?? null;
  }
  if (path) { parts.pick.value = path; ends(); }
}

function ends() {
  const own = control(path);
  const text = (value) => (own.place ? value.toFixed(3) : figure(value));
  parts.low.value = text(own.low); parts.high.value = text(own.high);
}

async function run() {
  if (!path) { return; }
  if (running) { again = true; return; }
  running = true; again = false;
  await quiet();
  const asked = path, of = now();
  const found = await runJob("curve", { path, low: Number(parts.low.value), high: Number(parts.high.value),
    points: Number(parts.points.value) }, parts.job);
  running = false;
  if (found && asked === path) { curve = found; draw(); watch(parts.chart, of, "The curve is of an earlier design: draw it again.", curve.path); }
  if (again) { run(); }
}

function draw() {
  const ys = [...curve.limit, ...(curve.closed_form || [])].filter((v) => v !== null && v !== undefined);
  if (answer?.fos.limit) { ys.push(answer.fos.limit); }
  const sorted = [...ys].sort((a, b) => a - b), typical = sorted[Math.floor(0.9 * (sorted.length - 1))] || 1;
  const top = Math.max(1.3, Math.min(sorted[sorted.length - 1] || 1, 3 * typical)) * 1.05;
  const bottom = Math.min(sorted[0] ?? 0, 0.9) < 0.45 ? 0 : Math.max(0, Math.floor(10 * Math.min(sorted[0] ?? 0, 0.95) - 0.5) / 10);
  const unit = curve.unit ? `, ${curve.unit}` : "", own = control(curve.path);
  sheet = paper({ x: [curve.x[0], curve.x[curve.x.length - 1]], y: [bottom, top], log: own?.log,
    xLabel: curve.label + unit, yLabel: "factor of safety", label: `Factor of safety over ${curve.label}` });
  const cut = (values) => values.map((v) => (v !== null && v <= top ? v : null));
  dot = svg("g", { class: "dot" }, svg("line", { y1: sheet.top, y2: sheet.bottom }), svg("circle", { r: 6 }), svg("text", { class: "name" }));
  const checked = curve.closed_form ? broken(sheet, curve.x, cut(curve.closed_form), "closed") : null;
  fill(sheet.inner, sheet.y(1) < sheet.bottom ? [svg("line", { x1: sheet.left, x2: sheet.right, y1: sheet.y(1), y2: sheet.y(1), class: "one" }),
    svg("text", { x: sheet.right - 4, y: sheet.y(1) - 5, class: "tick end" }, "F = 1")] : null,
  broken(sheet, curve.x, cut(curve.limit), "limit"), checked, gaps(), dot);
  sheet.sheet.addEventListener("click", (event) => {
    const there = sheet.valueAt(event), value = Number(own?.place ? there.toFixed(3) : there.toPrecision(4));
    take(curve.path, { value, text: own ? shown(own, value, 5) : figure(value) });
    change({ [curve.path]: value }, true);
  });
  fill(parts.chart, sheet.sheet, el("p", { class: "key" }, el("span", { class: "k-limit" }, "PRE-IE"),
    curve.closed_form?.some((v) => v !== null) ? el("span", { class: "k-closed" }, "closed form") : null,
    el("span", { class: "k-gap" }, "no factor"), el("span", { class: "k-dot" }, "the present design: click on the chart to move it")));
  const words = {};
  curve.status.forEach((status, k) => { if (curve.limit[k] === null && status) { words[status] = (words[status] || 0) + 1; } });
  const said = Object.entries(words).map(([status, count]) => `${status.replaceAll("_", " ")} at ${count} of ${curve.x.length}`);
  parts.note.textContent = said.length ? `Without a factor: ${said.join("; ")}.` : "";
  move();
}

function gaps() {  // along the axis, where there is no factor
  return curve.x.map((v, k) => (curve.limit[k] === null ?
    svg("circle", { cx: sheet.x(v), cy: sheet.bottom - 4, r: 2.5, class: "gap" }, svg("title", {}, (curve.status[k] || "").replaceAll("_", " "))) : null));
}

function move() {
  const own = curve && control(curve.path);
  if (!dot || !own || typeof own.value !== "number") { return; }
  const lead = answer?.fos.limit ?? answer?.fos.closed_form, x = Math.min(Math.max(sheet.x(own.value), sheet.left), sheet.right);
  const y = lead === null || lead === undefined ? sheet.bottom : Math.max(sheet.y(lead), sheet.top);
  dot.querySelector("line").setAttribute("x1", x); dot.querySelector("line").setAttribute("x2", x);
  dot.querySelector("circle").setAttribute("cx", x); dot.querySelector("circle").setAttribute("cy", y);
  const name = dot.querySelector("text"), right = x > sheet.right - 70;
  name.textContent = lead === null || lead === undefined ? "no factor" : factor(lead);
  name.setAttribute("x", x + (right ? -10 : 10)); name.setAttribute("y", Math.max(y - 10, sheet.top + 10));
  name.setAttribute("text-anchor", right ? "end" : "start");
}

const visible = () => !byId("screen-curve").hidden;

export function start() {
  let others = false;
  build();
  on("design", (design) => { live = design.live; curve = null; dot = null; leave(parts.chart); fill(parts.chart); list(); others = true; if (visible()) { run(); } });
  on("touched", (values) => { others = others || Object.keys(values).some((one) => one !== curve?.path); });
  on("values", () => { if (curve) { move(); } });
  on("answer", (given) => {
    answer = given;
    if (curve) { move(); }
    if (given.final && others && visible() && live === "drag" && !given.faults.length) { others = false; run(); }
  });
  on("screen", (name) => { if (name === "curve" && (!curve || others)) { others = false; if (live !== "button") { run(); } } });
}
