/* A joint survey: its poles on a net, its sets, every pair ranked; a pair becomes a design. */
import { byId, el, factor, fill, svg, three } from "./dom.js";
import { ask, tell } from "./link.js";
import { leave, now, outdate, watch } from "./fresh.js";
import { faults } from "./jobs.js";
import { COLOURS, frame, place } from "./net.js";

let parts = null, file = null;

function own(name) {  // a strength of the survey's own; empty: that of the design
  const text = parts[name].value.trim();
  return text === "" ? {} : { [name]: Number(text) };
}

function question(found) {  // bad rows are left out only where that is agreed to
  faults(parts.job, found.faults);
  parts.job.append(el("p", {}, found.question, " ", el("button", { type: "button", onclick: () => read(true) }, "Leave them out")));
}

async function read(skip = false) {
  if (!file) { return; }
  fill(parts.job, el("p", { class: "soft" }, "reading …"));
  const of = now();
  const found = await ask("survey", { name: file.name, text: file.text, ...own("c"), ...own("phi"), columns: parts.columns.value.trim(), skip_bad: skip });
  if (!found.planes) { leave(parts.found); fill(parts.found); if (found.question) { question(found); } else { faults(parts.job, found.faults); } return; }
  fill(parts.job);
  show(found);
  watch(parts.found, of, "The pairs stand in the slope of an earlier design, or have another strength: press Again. Open takes them as they are here.");
  if (found.planes && found.faults?.length) { faults(parts.job, found.faults); }
}

async function taken(given) {
  if (!given) { return; }
  file = { name: given.name, text: await given.text() };
  read();
}

function netOf(found) {
  const names = found.sets.map((one) => one.name);
  const colour = (set) => (names.includes(set) ? COLOURS[names.indexOf(set) % COLOURS.length] : "#8a8f94");
  return svg("svg", { viewBox: "-122 -120 244 242", class: "net", role: "img", "aria-label": `Poles of ${found.planes.length} planes` }, frame(),
    found.planes.map((one) => {
      const [cx, cy] = place(one.dip_direction + 180, 90 - one.dip);
      return svg("circle", { cx, cy, r: found.planes.length > 150 ? 1.8 : 2.6, fill: colour(one.set), class: "seen" });
    }),
    found.sets.map((one) => {
      const [cx, cy] = place(one.dip_direction + 180, 90 - one.dip);
      return [svg("circle", { cx, cy, r: 6, fill: "none", stroke: colour(one.name), "stroke-width": 2 }), svg("text", { x: cx + 8, y: cy - 5, class: "name" }, one.name)];
    }));
}

async function open(pair) {
  const back = await ask("open", { pair: pair.n });
  if (back.faults && !back.fos) { tell("say", back.faults[0].message); return; }
  tell("goto", "design");
}

function show(found) {
  fill(parts.found, el("div", { class: "two" }, netOf(found), el("div", {}, el("h3", {}, `${found.planes.length} planes`),
    found.sets.length ? el("table", { class: "planes" }, el("thead", {}, el("tr", {}, ["set", "dip/direction", "planes"].map((name) => el("th", { scope: "col" }, name)))),
      el("tbody", {}, found.sets.map((one) => el("tr", {}, el("th", { scope: "row" }, one.name),
        el("td", { class: "num" }, `${Math.round(one.dip)}/${three(Math.round(one.dip_direction))}`), el("td", { class: "num" }, one.count))))) : null,
    found.left_out?.length ? el("p", { class: "soft" }, `Left out: ${found.left_out.map((one) => (typeof one === "string" ? one : JSON.stringify(one))).join("; ")}`) : null,
    (found.notices || []).map((one) => el("p", {}, el("code", {}, one.code), " ", one.text)))),
  el("h3", {}, `${found.pairs.length} pairs, the lowest factor first`), el("div", { class: "wide", tabindex: 0 }, el("table", { class: "pairs" },
    el("thead", {}, el("tr", {}, ["pair", "planes", "FoS", "status", ""].map((name) => el("th", { scope: "col" }, name)))),
    el("tbody", {}, found.pairs.slice(0, 300).map((pair) => el("tr", {}, el("th", { scope: "row" }, (pair.names || []).join(" + ")),
      el("td", {}, pair.planes.join("  ")), el("td", { class: "num" }, factor(pair.fos)), el("td", {}, pair.words || (pair.status || "").replaceAll("_", " ")),
      el("td", {}, el("button", { type: "button", onclick: () => open(pair), "aria-label": `Open the wedge of ${(pair.names || []).join(" and ")}` }, "Open"))))))));
}

export function start() {
  const input = el("input", { type: "file", accept: ".csv,.txt,.ags,text/csv", id: "survey-file", onchange: () => taken(input.files[0]) });
  const drop = el("div", { class: "drop" }, el("p", {}, el("strong", {}, "Drop a joint survey here"), " (CSV or AGS 4: dip and dip direction, strike, or alpha and beta on core)"),
    el("label", { class: "filed" }, "or choose a file ", input));
  for (const name of ["dragenter", "dragover"]) { drop.addEventListener(name, (event) => { event.preventDefault(); drop.classList.add("over"); }); }
  drop.addEventListener("dragleave", () => drop.classList.remove("over"));
  drop.addEventListener("drop", (event) => { event.preventDefault(); drop.classList.remove("over"); taken(event.dataTransfer.files[0]); });
  const c = el("input", { type: "number", class: "box", min: 0, placeholder: "design's" }), phi = el("input", { type: "number", class: "box", min: 0, max: 89, placeholder: "design's" });
  const columns = el("input", { type: "text", class: "box", placeholder: "header's", title: "what the columns hold, in order: dip_direction,dip" });
  for (const one of [c, phi, columns]) { one.addEventListener("input", () => outdate(parts.found)); }
  const job = el("div", { class: "job" }), found = el("div");
  fill(byId("screen-survey"), el("h2", {}, "Joint survey"), el("p", { class: "soft" }, "Every pair is set against the face and upper slope of the present design."), drop,
    el("div", { class: "form" }, el("label", {}, "cohesion, kPa ", c), el("label", {}, "friction angle, ° ", phi),
      el("label", {}, "columns ", columns), el("button", { type: "button", onclick: () => read() }, "Again")), job, found);
  parts = { c, phi, columns, job, found };
}
