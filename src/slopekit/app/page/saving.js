/* Save: what would change is shown first. */
import { el, fill } from "./dom.js";
import { ask, on, tell } from "./link.js";
import { quiet } from "./live.js";

let design = null;

const lineOf = (line) => el("span", { class: line.startsWith("+++") || line.startsWith("---") ? "file" : line.startsWith("+") ? "plus" :
  line.startsWith("-") ? "minus" : line.startsWith("@@") ? "at" : "" }, `${line}\n`);

export async function save() {
  await quiet();
  const file = el("input", { type: "text", id: "save-file", class: "wide-box", "aria-label": "file", spellcheck: "false" });
  const shown = el("pre", { class: "diff", tabindex: 0, "aria-label": "what would change in the file" }), words = el("p", { class: "soft" });
  const box = el("div"), go = el("button", { type: "button", class: "main", id: "save-go" }, "Save");
  let seen = null;
  const dialog = el("dialog", { class: "dialog", "aria-label": "Save" }, el("h2", {}, "Save"), el("label", {}, "File ", file), words, shown, box,
    el("div", { class: "ends" }, el("button", { type: "button", onclick: () => dialog.close() }, "Cancel"), go));
  async function look() {
    seen = null; go.disabled = true;
    const back = await ask("diff", file.value ? { file: file.value } : {});
    if (back.faults) { say(back.faults); fill(shown); return; }
    fill(box);
    if (!file.value && back.file) { file.value = back.file; }
    seen = back.diff;
    go.disabled = false;
    fill(shown, back.diff ? back.diff.replace(/\n$/, "").split("\n").map(lineOf) : "nothing would change");
    words.textContent = back.changed_on_disk ? "The file has changed on disk since it was opened: saving is refused. Save under another name." :
      back.diff ? `${back.lines} line${back.lines === 1 ? "" : "s"} would change; the others stay as they are.` : "The file holds this design already.";
    words.classList.toggle("bad", Boolean(back.changed_on_disk));
  }
  function say(faults) {
    fill(box, faults.map((fault) => el("div", { class: "fault" }, el("p", { class: "what" }, fault.code ? el("code", {}, fault.code) : null, " ", fault.message),
      fault.advice ? el("p", { class: "advice" }, fault.advice) : null)));
  }
  go.addEventListener("click", async () => {
    const back = await ask("save", { ...(file.value ? { file: file.value } : {}), seen });
    if (back.faults) { say(back.faults); return; }
    dialog.close();
    tell("saved", back);
    tell("say", `Saved: ${back.file}`);
  });
  file.addEventListener("change", look);
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  file.value = design?.file || design?.name || "";
  dialog.showModal();
  await look();
  (go.disabled ? file : go).focus();
}

export function start() {
  on("design", (own) => { design = own; });
}
