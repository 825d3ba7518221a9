/* Charts as SVG: axes with round ticks, lines, bars. */
import { figure, svg } from "./dom.js";

const W = 640, H = 360, M = { left: 58, right: 18, top: 16, bottom: 46 };

function ticks(low, high, wanted = 6) {
  const raw = (high - low) / wanted || 1, power = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 5, 10].map((k) => k * power).find((one) => one >= raw) || raw;
  const found = [];
  for (let t = Math.ceil(low / step - 1e-9) * step; t <= high + 1e-9 * step; t += step) { found.push(Number(t.toPrecision(10))); }
  return found;
}

/** Paper with axes; gives x(value), y(value), the value at a place, and the group to draw in. */
export function paper(given) {
  const { x: [x0, x1], y: [y0, y1], xLabel, yLabel, label } = given;
  const wide = W - M.left - M.right, high = H - M.top - M.bottom;
  const lx = given.log ? Math.log : (v) => v;
  const x = (v) => M.left + wide * (lx(v) - lx(x0)) / (lx(x1) - lx(x0) || 1);
  const y = (v) => M.top + high * (1 - (v - y0) / (y1 - y0 || 1));
  const inner = svg("g");
  const sheet = svg("svg", { viewBox: `0 0 ${W} ${H}`, class: "chart", role: "img", "aria-label": label },
    ticks(y0, y1).map((t) => [svg("line", { x1: M.left, x2: W - M.right, y1: y(t), y2: y(t), class: "grid" }),
      svg("text", { x: M.left - 8, y: y(t) + 4, class: "tick end" }, figure(t, 10))]),
    (given.log ? decades(x0, x1) : ticks(x0, x1, 8)).map((t) => [svg("line", { x1: x(t), x2: x(t), y1: H - M.bottom, y2: H - M.bottom + 5, class: "axis" }),
      svg("text", { x: x(t), y: H - M.bottom + 19, class: "tick mid" }, figure(t, 10))]),
    svg("path", { d: `M${M.left} ${M.top}V${H - M.bottom}H${W - M.right}`, class: "axis" }),
    svg("text", { x: M.left + wide / 2, y: H - 6, class: "label mid" }, xLabel),
    svg("text", { transform: `translate(14 ${M.top + high / 2}) rotate(-90)`, class: "label mid" }, yLabel), inner);
  const valueAt = (event) => {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(sheet.getScreenCTM().inverse());
    const part = Math.min(Math.max((at.x - M.left) / wide, 0), 1);
    return given.log ? Math.exp(lx(x0) + part * (lx(x1) - lx(x0))) : x0 + part * (x1 - x0);
  };
  return { sheet, inner, x, y, valueAt, left: M.left, right: W - M.right, top: M.top, bottom: H - M.bottom };
}

function decades(low, high) {
  const found = [];
  for (let k = Math.ceil(Math.log10(low) - 1e-9); k <= Math.floor(Math.log10(high) + 1e-9); k += 1) { found.push(Math.pow(10, k)); }
  return found.length > 1 ? found : [low, high];
}

/** A line that is broken where there is no value. */
export function broken(on, xs, ys, name) {
  let d = "", open = false;
  xs.forEach((v, k) => {
    if (ys[k] === null || ys[k] === undefined) { open = false; return; }
    d += `${open ? "L" : "M"}${on.x(v).toFixed(1)} ${on.y(ys[k]).toFixed(1)}`;
    open = true;
  });
  return d ? svg("path", { d, class: name }) : null;
}
