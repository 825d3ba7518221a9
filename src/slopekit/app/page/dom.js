/* Elements without markup: text is always text. */

export function el(tag, given = {}, ...children) {
  const element = document.createElement(tag);
  return filled(element, given, children);
}

export function svg(tag, given = {}, ...children) {
  return filled(document.createElementNS("http://www.w3.org/2000/svg", tag), given, children);
}

function filled(element, given, children) {
  for (const [name, value] of Object.entries(given)) {
    if (value === null || value === undefined || value === false) { continue; }
    if (name.startsWith("on")) { element.addEventListener(name.slice(2), value); }
    else if (name === "value" || name === "checked" || name === "textContent") { element[name] = value; }
    else { element.setAttribute(name, value === true ? "" : value); }
  }
  add(element, children);
  return element;
}

function add(element, children) {
  for (const child of children.flat(Infinity)) {
    if (child !== null && child !== undefined && child !== false) {
      element.append(child instanceof Node ? child : document.createTextNode(String(child)));
    }
  }
}

export function fill(element, ...children) {
  const fresh = document.createDocumentFragment();
  add(fresh, children);
  element.replaceChildren(fresh);
  return element;
}

export const byId = (id) => document.getElementById(id);

/** A number with so many figures, without tails of binary fractions. */
export function figure(value, digits = 5) {
  if (value === null || value === undefined || !Number.isFinite(value)) { return "–"; }
  if (value !== 0 && (Math.abs(value) >= 1e7 || Math.abs(value) < 1e-4)) { return String(Number(value.toPrecision(digits))); }
  return String(Number(value.toPrecision(digits)));
}

/** A factor of safety, three decimals as the sheet has them. */
export function factor(value) {
  return value === null || value === undefined ? "–" : value >= 1000 ? value.toExponential(3) : value < 1 - 1e-6 && value >= 0.9995 ? value.toFixed(Math.ceil(-Math.log10(1 - value))) : value.toFixed(3);
}

const ROSE = ["N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW"];

export function toward(bearing) {
  return ROSE[Math.round((((bearing % 360) + 360) % 360) / 22.5) % 16];
}

export function three(bearing) {
  const [whole, part] = figure(((bearing % 360) + 360) % 360, 6).split(".");
  return whole.padStart(3, "0") + (part ? `.${part}` : "");
}
