// What every chart shares: its frame, logarithmic axes, grids.
const isDecade = (v) => { const l = Math.log10(v); return Math.abs(l - Math.round(l)) < 1e-9; };
const padded = ([low, high], by) => [low / by, high * by];

/** An svg as wide as its box; drawn again when the box gets another width. */
function responsive(box, draw) {
  let width = 0;
  const redraw = () => { box.replaceChildren(); draw(box, width); };
  new ResizeObserver(() => {
    const now = Math.round(box.clientWidth);
    if (now > 0 && now !== width) { width = now; redraw(); }
  }).observe(box);
  return () => { if (width > 0) redraw(); };
}

function svgIn(box, width, height, label) {
  return d3.select(box).append("svg").attr("viewBox", `0 0 ${width} ${height}`).attr("role", "img").attr("aria-label", label);
}

/** Tick labels of a log axis: decades, and 2 and 5 where there are few decades. */
function logLabels(scale) {
  const narrow = Math.abs(Math.log10(scale.domain()[1] / scale.domain()[0])) < 2.3;
  return (v) => {
    const lead = Math.round(v / 10 ** Math.floor(Math.log10(v) + 1e-9));
    return isDecade(v) || (narrow && [2, 5].includes(lead)) ? significant(v) : "";
  };
}

/** Grid and axes of a log-log plot over the scales' ranges. */
function logAxes(svg, x, y, xName, yName) {
  const [x0, x1] = x.range(), [y0, y1] = y.range();
  const grid = (scale, axis, size, place) => svg.append("g").attr("class", "grid").attr("transform", place)
    .call(axis(scale).ticks(20).tickSize(-size).tickFormat("")).call((g) => g.select(".domain").remove())
    .selectAll(".tick").classed("minor", (v) => !isDecade(v));
  grid(x, d3.axisBottom, y0 - y1, `translate(0,${y0})`);
  grid(y, d3.axisLeft, x1 - x0, `translate(${x0},0)`);
  svg.append("g").attr("class", "axis").attr("transform", `translate(0,${y0})`)
    .call(d3.axisBottom(x).ticks(20).tickFormat(logLabels(x)).tickSizeOuter(0));
  svg.append("g").attr("class", "axis").attr("transform", `translate(${x0},0)`)
    .call(d3.axisLeft(y).ticks(20).tickFormat(logLabels(y)).tickSizeOuter(0));
  svg.append("text").attr("class", "axis-name").attr("text-anchor", "middle").attr("x", (x0 + x1) / 2).attr("y", y0 + 36).text(xName);
  svg.append("text").attr("class", "axis-name").attr("text-anchor", "middle")
    .attr("transform", `translate(14,${(y0 + y1) / 2}) rotate(-90)`).text(yName);
}

/** Moves the items' y apart by `pitch`, inside [top, bottom]; items are sorted by y. */
function spread(items, pitch, top, bottom) {
  items.sort((a, b) => a.y - b.y);
  items.forEach((item, i) => { item.y = Math.max(item.y, i ? items[i - 1].y + pitch : top); });
  for (let i = items.length - 1, limit = bottom; i >= 0; --i, limit -= pitch) items[i].y = Math.min(items[i].y, limit);
  return items;
}
