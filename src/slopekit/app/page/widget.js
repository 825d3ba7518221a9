/* The widgets of a notebook: a scene that turns, and a design under sliders. slopekitView stands before this text.
   One question is under way at a time; what is moved meanwhile is asked when it is answered, the newest alone. */
function made(tag, name, text) {
  const element = document.createElement(tag);
  if (name) { element.className = "slopekit-" + name; }
  if (text !== undefined) { element.textContent = text; }
  return element;
}

function sceneIn(el, height) {
  const box = made("div", "view");
  box.style.setProperty("--view-height", height + "px");
  el.appendChild(box);
  return slopekitView(box);
}

function look(el) {
  const style = made("style");
  style.textContent = `
    .slopekit-explore { display: grid; grid-template-columns: minmax(220px, 1fr) 2fr; gap: 16px; font-size: 13px; }
    @media (max-width: 640px) { .slopekit-explore { grid-template-columns: 1fr; } }
    .slopekit-row { display: grid; grid-template-columns: 1fr 8em; gap: 2px 8px; margin: 4px 0; }
    .slopekit-row label { grid-column: 1 / -1; }
    .slopekit-row.is-changed label { font-weight: 700; }
    .slopekit-row.is-default { opacity: 0.75; }
    .slopekit-lead { font-size: 32px; font-weight: 700; margin-right: 12px; }
    .slopekit-fault { color: #b3261e; }
    .slopekit-answer.is-old { opacity: 0.5; }`;
  el.appendChild(style);
}

function explore(model, el) {
  look(el);
  const root = made("div", "explore"), left = made("div", "controls"), right = made("div", "right");
  const answer = made("div", "answer"), rows = new Map();
  answer.setAttribute("aria-live", "polite");
  const button = made("button", "analyse", "Analyse");
  button.type = "button";
  right.append(answer, button);
  root.append(left, right);
  el.appendChild(root);
  const view = sceneIn(right, 320);
  let waiting = null, busy = false;

  function ask(path, value, final) {
    waiting = { do: "set", values: { ...(waiting ? waiting.values : {}), [path]: value }, final };
    next();
  }
  function next() {
    if (busy || !waiting) { return; }
    busy = true;
    model.send(waiting);
    waiting = null;
  }

  function row(control) {
    const line = made("div", "row"), label = made("label", "", control.label);
    const box = made("input"), back = made("button", "back", "back");
    label.title = [control.path, control.doc].filter(Boolean).join(": ");
    line.appendChild(label);
    let slider = null;
    if (control.type === "number" || control.type === "count") {
      slider = made("input");
      slider.type = "range";
      slider.setAttribute("aria-label", control.label);
      const scale = control.log ? Math.log : (x) => x, unscale = control.log ? Math.exp : (x) => x;
      slider.min = scale(control.low); slider.max = scale(control.high);
      slider.step = control.log ? "any" : control.step;
      const live = model.get("live") === "drag";
      slider.addEventListener("input", () => { if (live) { ask(control.path, unscale(+slider.value), false); } });
      slider.addEventListener("change", () => ask(control.path, unscale(+slider.value), true));
      line.appendChild(slider);
      slider.put = (value) => { if (value !== null && document.activeElement !== slider) { slider.value = scale(value); } };
    }
    box.type = "text";
    box.setAttribute("aria-label", control.label + (control.unit ? " in " + control.unit : ""));
    box.addEventListener("change", () => ask(control.path, box.value, true));
    line.appendChild(box);
    back.type = "button";
    back.addEventListener("click", () => { if (!busy) { busy = true; model.send({ do: "reset", path: control.path }); } });
    line.appendChild(back);
    rows.set(control.path, (now) => {
      line.classList.toggle("is-changed", now.changed);
      line.classList.toggle("is-default", now.is_default);
      back.hidden = !now.changed;
      back.textContent = "back to " + (now.opened || "what it was");
      if (slider) { slider.put(now.value); }
      if (document.activeElement !== box) { box.value = now.text; }
    });
    return line;
  }

  function furnish() {
    rows.clear();
    left.replaceChildren(...model.get("groups").map((group, k) => {
      const details = made("details");
      details.open = group.open;
      details.append(made("summary", "", group.label), ...group.controls.map(row));
      return details;
    }));
    put(model.get("groups"));
  }
  function put(groups) {
    groups.forEach((group) => group.controls.forEach((now) => { const set = rows.get(now.path); if (set) { set(now); } }));
  }

  function tell(now) {
    const lines = [];
    if (now.faults.length) {
      now.faults.forEach((one) => lines.push(made("p", "fault", one.code + " " + one.message + (one.advice ? ". " + one.advice : ""))));
    } else {
      const first = made("p");
      first.append(made("span", "lead", now.lead === null ? "–" : now.lead), made("span", "status", now.status_words || ""));
      lines.push(first);
      if (now.lead !== null) { lines.push(made("p", "of", "FoS, " + now.lead_of)); }
      if (now.fos.closed_form !== null) { lines.push(made("p", "closed", now.fos.closed_form.toFixed(3) + " closed form")); }
      if (now.agree_words) { lines.push(made("p", "agree", (now.moments_govern ? "forces only: " : "") + now.agree_words)); }
      now.moments.forEach((line) => lines.push(made("p", "moments", line)));
      now.notices.forEach((one) => lines.push(made("p", "notice", one.code + " " + one.text)));
    }
    answer.replaceChildren(...lines);
    answer.classList.toggle("is-old", !!now.stale);
    button.hidden = !now.stale;
    if (now.scene) { view.show(now.scene); }
  }

  function heard(message) {
    if (message.of !== "answer") { return; }
    busy = false;
    if (!waiting) {
      if (message.groups) { put(message.groups); }
      tell(message.answer);
    }
    next();
  }
  button.addEventListener("click", () => { busy = true; model.send({ do: "analyse" }); });
  model.on("msg:custom", heard);
  model.on("change:groups", furnish);
  furnish();
  tell(model.get("answer"));
  return () => { model.off("msg:custom", heard); model.off("change:groups", furnish); view.stop(); };
}

export default {
  render({ model, el }) {
    if (model.get("what") === "explore") { return explore(model, el); }
    const view = sceneIn(el, 420), draw = () => view.show(model.get("scene"));
    model.on("change:scene", draw);
    draw();
    return () => { model.off("change:scene", draw); view.stop(); };
  },
};
