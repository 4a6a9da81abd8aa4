"use strict";
// Elements, and numbers as people read them.

/** An element with attributes and children; text is never parsed as HTML. */
function el(name, attributes = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

const significant = (v) => (v >= 1e-3 && v < 1e5 ? String(+v.toPrecision(3)) : v.toExponential(2));

function seconds(v) {
  if (!(v >= 0)) return "–";
  if (v < 120) return `${v < 10 ? +v.toPrecision(2) : Math.round(v)} s`;
  return v < 7200 ? `${Math.round(v / 60)} min` : `${(v / 3600).toFixed(1)} h`;
}

/** The time of day; with the date unless it is today's. */
function moment(unix) {
  const at = new Date(1000 * unix);
  return at.toDateString() === new Date().toDateString() ? at.toLocaleTimeString() : at.toLocaleString();
}

const baseName = (path) => path.split("/").pop();
const colour = (i) => `var(--c${i % 8})`;
