// Colours and shapes. A mix is told by its colour, its marker and its dashes, so that none of them is needed alone.
const dashes = ["", "7 3", "2 3", "9 3 2 3", "4 2", "12 4", "2 2 6 2", "1 4"];
const markers = [d3.symbolCircle, d3.symbolSquare, d3.symbolTriangle, d3.symbolDiamond, d3.symbolCross, d3.symbolStar, d3.symbolWye];

/** A CSS colour that follows light and dark. */
const colour = (i) => `var(--c${((i % 8) + 8) % 8})`;
const dash = (i) => dashes[i % dashes.length];
const markerPath = (i, area = 46) => d3.symbol().type(markers[i % markers.length]).size(area)();

/** The mix's sign as it stands in tables, captions and legends. */
function swatch(i) {
  const node = el("span", { class: "swatch" });
  d3.select(node).append("svg").attr("viewBox", "-7 -7 14 14").attr("aria-hidden", "true")
    .append("path").attr("d", markerPath(i, 74)).style("fill", colour(i));
  return node;
}

/** 256 RGB triples of a colour map. */
function colourTable(interpolate) {
  const table = new Uint8ClampedArray(3 * 256);
  for (let i = 0; i < 256; ++i) {
    const c = d3.color(interpolate(i / 255));
    table.set([c.r, c.g, c.b], 3 * i);
  }
  return table;
}

/** A logarithmic false-colour scale. */
function heatScale(low, high, interpolate) {
  const table = colourTable(interpolate), base = Math.log(low), span = Math.log(high) - base || 1;
  return {
    low, high, table,
    index: (v) => (v > 0 ? Math.max(0, Math.min(255, Math.round((255 * (Math.log(v) - base)) / span))) : 0),
    css: (v) => {
      const k = 3 * (v > 0 ? Math.max(0, Math.min(255, Math.round((255 * (Math.log(v) - base)) / span))) : 0);
      return `rgb(${table[k]},${table[k + 1]},${table[k + 2]})`;
    },
  };
}
