"use strict";
// Elements, and numbers as people read them.

/** An element with properties and children; text is never parsed as HTML. */
function el(name, properties = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (value === null || value === undefined) continue;
    if (key === "class") node.className = value;
    else if (key in node && key !== "list") node[key] = value;
    else node.setAttribute(key, value);
  }
  node.append(...children.filter((c) => c !== null && c !== undefined));
  return node;
}

const number = (v) => typeof v === "number" && Number.isFinite(v);

/** "0.0123", "1.23e-5", "–" for what is no number. */
function significant(v, digits = 3) {
  if (!number(v)) return "–";
  if (v === 0) return "0";
  const size = Math.abs(v);
  if (size < 1e-3 || size >= 1e5) return v.toExponential(digits - 1).replace("e+", "e");
  return String(+v.toPrecision(digits));
}

function seconds(v) {
  if (!number(v)) return "–";
  if (v < 10) return `${significant(v)} s`;
  return v < 120 ? `${v.toFixed(1)} s` : `${(v / 60).toFixed(1)} min`;
}

const grouped = (v) => (number(v) ? v.toLocaleString("en-US").replace(/,/g, "\u2009") : "–");
const interval = (ci) => (Array.isArray(ci) ? `[${significant(ci[0])}, ${significant(ci[1])}]` : "");
const percent = (v, digits = 1) => (number(v) ? `${(100 * v).toFixed(digits)} %` : "–");
const baseName = (path) => String(path).split("/").pop().replace(/\.[^.]*$/, "");

function budgetText(b = {}) {
  if (number(b.cpu_seconds)) return `${seconds(b.cpu_seconds)} of CPU per mix`;
  if (number(b.spp)) return `${grouped(b.spp)} samples per pixel`;
  return `until relMSE ${significant(b.target_error)}`;
}
