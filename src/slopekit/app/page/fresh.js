/* Numbers of an earlier design are marked, wherever they stand: a box is watched from the answer that fills it. */
import { el } from "./dom.js";
import { on } from "./link.js";

let age = 0, rev = null;
const watched = new Map();  // boxes: the age of the design that they are of

/** How often the design has changed: what is asked for now is of this one. */
export const now = () => age;

/** A box holds numbers of the design of that age; `words` say what to do once they are old, `but` what they do not rest on. */
export function watch(box, of, words, but = null) {
  watched.set(box, { of, words, but });
  look(box);
}

/** The box holds nothing of a design any more. */
export function leave(box) {
  watched.delete(box);
  box.classList.remove("earlier");
}

/** What the numbers rest on has changed, though the design has not. */
export function outdate(box) {
  if (watched.has(box)) { watched.get(box).of = -1; look(box); }
}

function look(box) {
  const { of, words } = watched.get(box), old = of !== age;
  box.classList.toggle("earlier", old);
  if (old && !box.querySelector(":scope > .stale")) { box.prepend(el("p", { class: "stale", role: "status" }, words)); }
}

function older(values) {
  age += 1;
  for (const [box, one] of watched) {
    if (values && one.of === age - 1 && Object.keys(values).every((path) => path === one.but)) { one.of = age; }
    look(box);
  }
}

export function start() {
  on("touched", older);
  on("design", (design) => { if (design.rev !== rev) { rev = design.rev; older(null); } });
}
