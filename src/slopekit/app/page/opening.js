/* Open: a template, a file of one's own, what was not saved. */
import { byId, el, fill } from "./dom.js";
import { faults } from "./jobs.js";
import { ask, on, tell } from "./link.js";

let hello = { templates: [], unsaved: null };

async function take(given, dialog, box) {
  const back = await ask("open", given);
  if (back.faults && !back.fos && box) { faults(box, back.faults); return; }  // above the dialog nothing else is seen
  if (back.faults && !back.fos) { tell("say", back.faults.map((fault) => fault.message).join(" ")); return; }
  dialog?.close();
  tell("goto", "design");
}

export function open() {
  const box = el("div", { role: "status" });
  const kinds = [...new Set(hello.templates.map((one) => one.kind))];
  const input = el("input", { type: "file", accept: ".yaml,.yml", onchange: async () => {
    const file = input.files[0];
    if (file) { take({ yaml: await file.text(), name: file.name }, dialog, box); }
  } });
  const dialog = el("dialog", { class: "dialog open", "aria-label": "Open" }, el("h2", {}, "Open"),
    el("p", {}, el("label", { class: "filed" }, "A design file of yours ", input)), box,
    el("div", { class: "templates" }, kinds.map((kind) => [el("h3", {}, kind), hello.templates.filter((one) => one.kind === kind).map((one) =>
      el("button", { type: "button", class: "template", "data-template": one.name, onclick: () => take({ template: one.name }, dialog, box) },
        el("strong", {}, one.name), el("span", { class: "soft" }, one.title)))])),
    el("div", { class: "ends" }, el("button", { type: "button", onclick: () => dialog.close() }, "Cancel")));
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}

export function start() {
  on("hello", (own) => {
    hello = own;
    const box = byId("offered");
    box.hidden = !own.unsaved;
    if (own.unsaved) {
      fill(box, `Not saved: ${own.unsaved.title} (${own.unsaved.when}). `,
        el("button", { type: "button", onclick: () => take({ unsaved: own.unsaved.id }) }, "Restore"),
        el("button", { type: "button", onclick: () => { box.hidden = true; } }, "Not now"));
    }
  });
}
