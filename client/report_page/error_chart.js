// Error against time, log-log: one curve per mix with its band, the reference's floor, and the chosen time and error.
const chosen = { time: null, error: null, hidden: new Set(), compared: 0 };

const series = run.mixes.map((mix, index) => ({ mix, index, points: curveOf(mix) })).filter((s) => s.points.length);
const shownSeries = () => series.filter((s) => !chosen.hidden.has(s.index));

/** The domains of all curves together, so that hiding one moves nothing. */
const errorDomain = (() => {
  const points = series.flatMap((s) => s.points);
  const errors = points.flatMap((p) => [p.e, p.lo, p.hi]).filter(number);
  const [least, most] = d3.extent(errors);
  // The floor is drawn where it says something: not if it lies decades below every point.
  const floor = referenceFloor && !errorKind.estimated && referenceFloor > least / 30 ? referenceFloor : null;
  return { times: d3.extent(points, (p) => p.t), errors: [Math.min(least, floor || least), most], floor };
})();

function drawCurve(svg, s, x, y, clip) {
  const g = svg.append("g").attr("clip-path", clip).attr("class", "curve");
  const banded = s.points.filter((p) => number(p.lo));
  if (banded.length > 1)
    g.append("path").attr("class", "band").style("fill", colour(s.index))
      .attr("d", d3.area().x((p) => x(p.t)).y0((p) => y(p.lo)).y1((p) => y(p.hi))(banded));
  else for (const p of banded)
    g.append("path").attr("class", "bar").style("stroke", colour(s.index))
      .attr("d", `M${x(p.t) - 4},${y(p.lo)}h8m-4,0V${y(p.hi)}m-4,0h8`);
  g.append("path").attr("class", "line").style("stroke", colour(s.index)).attr("stroke-dasharray", dash(s.index))
    .attr("d", d3.line().x((p) => x(p.t)).y((p) => y(p.e))(s.points));
  g.selectAll(".point").data(s.points).enter().append("path").attr("class", "point")
    .attr("transform", (p) => `translate(${x(p.t)},${y(p.e)})`).attr("d", markerPath(s.index)).style("fill", colour(s.index))
    .on("mousemove", (p) => showTip(d3.event, el("b", {}, s.mix.mix), `${significant(p.t, 4)} CPU s, ${grouped(p.passes)} passes`,
      `${errorKind.name} ${significant(p.e, 4)}`, number(p.lo) ? `95 % interval ${interval([p.lo, p.hi])}` : null))
    .on("mouseout", hideTip);
}

/** Names at the ends of the curves, pushed apart where they would overlap. */
function drawNames(svg, shown, x, y) {
  const x1 = x.range()[1], [bottom, top] = y.range();
  const names = shown.map((s) => ({ s, last: s.points[s.points.length - 1], y: y(s.points[s.points.length - 1].e) }));
  for (const l of spread(names, 17, top, bottom)) {
    svg.append("path").attr("class", "leader").style("stroke", colour(l.s.index))
      .attr("d", `M${x(l.last.t) + 6},${y(l.last.e)}L${x1 + 10},${l.y}h6`);
    svg.append("text").attr("class", "label").attr("x", x1 + 20).attr("y", l.y + 4).style("fill", colour(l.s.index)).text(l.s.mix.mix);
  }
}

function drawChosen(svg, x, y) {
  const [x0, x1] = x.range(), [y0, y1] = y.range(), g = svg.append("g").attr("class", "chosen screen-only");
  g.append("line").attr("id", "chosen-time").attr("x1", x(chosen.time)).attr("x2", x(chosen.time)).attr("y1", y0).attr("y2", y1);
  g.append("line").attr("id", "chosen-error").attr("x1", x0).attr("x2", x1).attr("y1", y(chosen.error)).attr("y2", y(chosen.error));
}

function drawErrorChart(box, width) {
  const shown = shownSeries(), named = width > 760;
  const longest = d3.max(series, (s) => s.mix.mix.length);
  const height = Math.round(Math.max(300, Math.min(500, 0.5 * width)));
  const margin = { top: 12, right: named ? Math.min(0.36 * width, 34 + 7.6 * longest) : 14, bottom: 46, left: 68 };
  const x = d3.scaleLog(padded(errorDomain.times, 1.15), [margin.left, width - margin.right]);
  const y = d3.scaleLog(padded(errorDomain.errors, 1.25), [height - margin.bottom, margin.top]);
  const svg = svgIn(box, width, height, `${errorKind.name} against CPU seconds, both logarithmic, one curve per mix; the table below has its values`);
  const [x0, x1] = x.range(), [y0, y1] = y.range();
  svg.append("clipPath").attr("id", "plot").append("rect").attr("x", x0).attr("y", y1 - 6).attr("width", x1 - x0 + 6).attr("height", y0 - y1 + 6);
  logAxes(svg, x, y, "CPU seconds of the mix, all cores together", errorKind.name);
  if (errorDomain.floor) {
    const at = y(errorDomain.floor);
    svg.append("line").attr("class", "floor").attr("x1", x0).attr("x2", x1).attr("y1", at).attr("y2", at);
    svg.append("text").attr("class", "floor-name").attr("x", x0 + 8).attr("y", at - 6).text("noise floor of the reference");
  }
  for (const s of shown) drawCurve(svg, s, x, y, "url(#plot)");
  if (named) drawNames(svg, shown, x, y);
  drawChosen(svg, x, y);
}

/** A chip per mix that hides and shows its curve. */
function curveLegend(redraw) {
  return el("div", { class: "chips" }, ...series.map((s) => {
    const chip = el("button", { type: "button", class: "chip", "aria-pressed": "true" }, swatch(s.index), s.mix.mix);
    chip.addEventListener("click", () => {
      const hide = !chosen.hidden.has(s.index);
      if (hide) chosen.hidden.add(s.index); else chosen.hidden.delete(s.index);
      chip.setAttribute("aria-pressed", String(!hide));
      redraw();
    });
    return chip;
  }));
}

function errorChart() {
  const section = document.getElementById("chart");
  if (!series.length) {
    section.append(el("p", { class: "note" }, errorKind ? "The run has no checkpoint to draw."
      : "There is nothing to draw: error needs a reference image (--reference REF.exr), or at least two passes for an own estimate."));
    return;
  }
  const plot = el("div", { class: "plot" });
  const redraw = responsive(plot, drawErrorChart);
  section.append(curveLegend(redraw), plot, el("p", { class: "note" },
    "Each point is the whole image after the same number of passes in every pixel (of auto: the same share of what each pixel gets); the band is the 95 % interval. "
    + "An unbiased estimator falls by a factor of ten for ten times the CPU seconds."
    + (errorKind.estimated ? " This is the run's own estimate, for want of a reference." : "")));
  document.getElementById("chart-tools").append(svgButton(plot, "error-against-time"),
    saveButton("CSV", fileName("error-against-time", "csv"), "text/csv", () => csvText(timelineRows())));
  readouts(section, redraw);
}
