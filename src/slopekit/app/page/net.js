/* The stereonet: equal-area, lower hemisphere. A pole of a plane dip/direction lies at trend direction + 180, plunge
   90 - dip; poles with a path can be dragged, or moved by the arrow keys. */
import { el, figure, fill, svg, three, toward } from "./dom.js";

const R = 100, RAD = Math.PI / 180;
export const COLOURS = ["#4272b0", "#92549c", "#489854", "#2aa3a3", "#bf5b5b", "#e4912f", "#7a6a00"];  // as the scene has its joints

/** Where a line of given trend and plunge lies on the paper. */
export function place(trend, plunge) {
  const r = R * Math.SQRT2 * Math.sin((90 - plunge) / 2 * RAD);
  return [r * Math.sin(trend * RAD), -r * Math.cos(trend * RAD)];
}

/** The plane whose pole lies there. */
export function planeAt(x, y) {
  const r = Math.min(Math.hypot(x, y), R);
  const dip = 2 * Math.asin(r / (R * Math.SQRT2)) / RAD;
  return { dip, dip_direction: ((Math.atan2(x, -y) / RAD + 180) % 360 + 360) % 360 };
}

/** The great circle of a plane as a path. */
export function greatCircle(dip, direction) {
  const points = [];
  for (let t = 0; t <= 180; t += 3) {
    const s = Math.cos(t * RAD), d = Math.sin(t * RAD);
    const a = (direction - 90) * RAD, b = direction * RAD;
    const east = s * Math.sin(a) + d * Math.sin(b) * Math.cos(dip * RAD);
    const north = s * Math.cos(a) + d * Math.cos(b) * Math.cos(dip * RAD);
    points.push(place(Math.atan2(east, north) / RAD, Math.asin(Math.min(d * Math.sin(dip * RAD), 1)) / RAD));
  }
  return path(points);
}

function path(points, closed) {
  return `M${points.map(([x, y]) => `${x.toFixed(2)} ${y.toFixed(2)}`).join("L")}${closed ? "Z" : ""}`;
}

/** Where lines steeper than friction daylight in the face: what slides without cohesion. */
function zone(face, friction) {
  const outer = [], inner = [];
  for (let turn = -90; turn <= 90; turn += 2) {
    const seen = Math.atan(Math.tan(Math.min(face.dip, 89.9) * RAD) * Math.cos(turn * RAD)) / RAD;
    if (seen > friction) {
      outer.push(place(face.dip_direction + turn, friction));
      inner.unshift(place(face.dip_direction + turn, seen));
    }
  }
  return outer.length > 1 ? path([...outer, ...inner], true) : "";
}

export function frame() {
  const ticks = [];
  for (let a = 0; a < 360; a += 10) {
    const [x, y] = place(a, 0), long = a % 90 === 0 ? 1.05 : 1.025;
    ticks.push(svg("line", { x1: x, y1: y, x2: x * long, y2: y * long, class: "tick" }));
  }
  const grid = [30, 60].map((dip) => svg("circle", { r: R * Math.SQRT2 * Math.sin(dip / 2 * RAD), class: "grid" }));
  return [svg("circle", { r: R, class: "rim" }), grid, svg("path", { d: `M-3 0H3M0 -3V3`, class: "tick" }), ticks,
    [["N", 0, -108], ["E", 111, 3.5], ["S", 0, 115], ["W", -111, 3.5]].map(([name, x, y]) =>
      svg("text", { x, y, class: "compass" }, name))];
}

/** A net in a box: `show(net)` draws; `moved(plane, angles, final)` is called while a pole is dragged. */
export function netIn(box, table, moved) {
  const back = svg("g"), circles = svg("g"), marks = svg("g"), poles = svg("g");
  const sheet = svg("svg", { viewBox: "-122 -120 244 242", class: "net", role: "group",
    "aria-label": "Stereonet, equal-area, lower hemisphere. Poles of planes can be moved." }, back, circles, marks, poles);
  fill(back, frame());
  box.append(sheet);
  const known = new Map();
  let now = null, held = null;

  function at(event) {
    const matrix = sheet.getScreenCTM().inverse();
    return new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix);
  }

  function poleOf(name, index) {
    const colour = COLOURS[index % COLOURS.length];
    const mark = svg("g", { class: "pole", tabindex: 0, role: "slider", "aria-valuemin": 0, "aria-valuemax": 90, "data-name": name },
      svg("circle", { r: 13, class: "reach" }), svg("circle", { r: 6, fill: colour, class: "spot" }),
      svg("text", { x: 8.5, y: -7, class: "name" }, name));
    const circle = svg("path", { class: "great", stroke: colour });
    const own = { name, mark, circle, colour, plane: null };
    mark.addEventListener("pointerdown", (event) => {
      if (!own.plane.path) { return; }
      event.preventDefault(); mark.focus();
      try { mark.setPointerCapture(event.pointerId); } catch { /* a made-up pointer */ }
      const [x, y] = place(own.plane.dip_direction + 180, 90 - own.plane.dip), from = at(event);
      held = { own, dx: x - from.x, dy: y - from.y, moved: false };
      mark.classList.add("held");
    });
    mark.addEventListener("pointermove", (event) => {
      if (held?.own !== own) { return; }
      const to = at(event), found = planeAt(to.x + held.dx, to.y + held.dy), grain = event.altKey ? 10 : 2;
      held.moved = true;
      turn(own, Math.round(found.dip * grain) / grain, Math.round(found.dip_direction * grain) / grain % 360, false);
    });
    for (const name of ["pointerup", "pointercancel"]) {
      mark.addEventListener(name, () => {
        if (held?.own !== own) { return; }
        mark.classList.remove("held");
        const was = held;
        held = null;
        if (was.moved) { turn(own, own.plane.dip, own.plane.dip_direction, true); }
      });
    }
    const keys = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] };
    mark.addEventListener("keydown", (event) => {
      const step = keys[event.key];
      if (!step || !own.plane.path) { return; }
      event.preventDefault();
      const size = event.shiftKey ? 5 : event.altKey ? 0.5 : 1;
      turn(own, Math.min(Math.max(own.plane.dip + size * step[0], 0), 90),
        (own.plane.dip_direction + size * step[1] + 360) % 360, false);
    });
    mark.addEventListener("keyup", (event) => {
      if (keys[event.key] && own.plane.path) { turn(own, own.plane.dip, own.plane.dip_direction, true); }
    });
    return own;
  }

  function turn(own, dip, direction, final) {
    own.plane = { ...own.plane, dip, dip_direction: direction };
    draw(own);
    moved(own.plane, final);
  }

  function draw(own) {
    const { dip, dip_direction: direction, path: settable } = own.plane;
    const [x, y] = place(direction + 180, 90 - dip);
    own.mark.setAttribute("transform", `translate(${x.toFixed(2)} ${y.toFixed(2)})`);
    own.mark.querySelector(".name").setAttribute("transform", x > 70 ? "translate(-24 0)" : "");
    own.mark.classList.toggle("fixed", !settable);
    own.mark.setAttribute("aria-disabled", settable ? "false" : "true");
    own.mark.setAttribute("aria-label", `Pole of ${own.name}; up and down change its dip, left and right its direction`);
    own.mark.setAttribute("aria-valuenow", dip);
    own.mark.setAttribute("aria-valuetext", `${own.name} dips ${figure(dip, 4)} degrees toward ${three(direction)}`);
    own.circle.setAttribute("d", greatCircle(dip, direction));
    if (own.cell) { own.cell.textContent = `${figure(dip, 4)}/${three(direction)}`; own.words.textContent = toward(direction); }
  }

  function show(net) {
    now = net;
    const planes = net ? net.planes : [];
    for (const [name, own] of known) {
      if (!planes.some((plane) => plane.name === name)) { own.mark.remove(); own.circle.remove(); known.delete(name); }
    }
    let fresh = known.size !== planes.length;
    planes.forEach((plane, index) => {
      let own = known.get(plane.name);
      if (!own) {
        own = poleOf(plane.name, index);
        known.set(plane.name, own); poles.append(own.mark); circles.append(own.circle);
        fresh = true;
      }
      if (held?.own !== own) { own.plane = plane; }
    });
    if (fresh) { list(planes); }
    known.forEach(draw);
    const parts = [], { face, upper, friction, line } = net || {};
    if (face && friction !== null && friction !== undefined) {
      const d = zone(face, friction);
      if (d) { parts.push(svg("path", { d, class: "zone" }, svg("title", {}, "Lines here daylight in the face and are steeper than friction"))); }
    }
    if (face) { parts.push(svg("path", { d: greatCircle(face.dip, face.dip_direction), class: "face" })); }
    if (upper && upper.dip > 0) { parts.push(svg("path", { d: greatCircle(upper.dip, upper.dip_direction), class: "upper" })); }
    if (friction > 0) { parts.push(svg("circle", { r: R * Math.SQRT2 * Math.sin((90 - friction) / 2 * RAD), class: "friction" })); }
    if (line) {
      const [x, y] = place(line.trend, line.plunge);
      parts.push(svg("path", { d: `M${x - 5} ${y}H${x + 5}M${x} ${y - 5}V${y + 5}`, class: "line" }),
        svg("text", { x: x + 6, y: y + 10, class: "name" }, `${three(Math.round(line.trend * 10) / 10)}/${figure(line.plunge, 3)}`));
    }
    fill(marks, parts);
    if (key) {
      fill(key, face && el("span", { class: "k-face" }, `face ${figure(face.dip, 4)}/${three(face.dip_direction)}`),
        upper && el("span", { class: "k-upper" }, `upper ${figure(upper.dip, 4)}/${three(upper.dip_direction)}`),
        friction > 0 && el("span", { class: "k-friction" }, `friction ${figure(friction, 4)}°`),
        line && el("span", { class: "k-line" }, `intersection ${three(Math.round(line.trend * 10) / 10)}/${line.plunge.toFixed(1)}`),
        face && friction > 0 && el("span", { class: "k-zone" }, "daylights, steeper than friction"));
    }
  }

  let key = null;
  function list(planes) {
    if (!table) { return; }
    key = el("p", { class: "key" });
    fill(table, el("h3", {}, "Planes"), el("table", { class: "planes" },
      el("tbody", {}, planes.map((plane) => {
        const own = known.get(plane.name);
        own.cell = el("td", { class: "num" }); own.words = el("td", { class: "soft" });
        const spot = el("i", { class: "spot" });
        spot.style.background = own.colour;
        return el("tr", {}, el("th", { scope: "row" }, spot, plane.name), own.cell, own.words);
      }))), key, el("p", { class: "soft hint" }, "Drag a pole, or put the focus on it and use the arrow keys (Shift: 5°, Alt: finer)."));
  }
  return { show, get net() { return now; } };
}
