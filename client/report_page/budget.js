// How well each mix kept to its budget; for a budget in samples, what it cost.
const withBudget = run.mixes.some((m) => number(m.budget_ratio));

function drawBudget(box, width) {
  const rows = run.mixes.map((mix, index) => ({ mix, index })).filter((r) => number(withBudget ? r.mix.budget_ratio : r.mix.cpu_seconds));
  const value = (r) => (withBudget ? r.mix.budget_ratio : r.mix.cpu_seconds);
  const narrow = width < 620, pitch = narrow ? 46 : 30, longest = d3.max(rows, (r) => r.mix.mix.length);
  const margin = { top: 24, right: 24, bottom: 40, left: narrow ? 12 : Math.min(0.4 * width, 36 + 7.6 * longest) };
  const height = margin.top + margin.bottom + pitch * rows.length;
  // Passes are whole: half a pass is the least that can be missed.
  const half = (r) => (withBudget && r.mix.passes > 0 ? (0.5 * r.mix.budget_ratio) / r.mix.passes : 0);
  const far = withBudget ? Math.max(0.12, 1.1 * d3.max(rows, (r) => Math.max(Math.abs(value(r) - 1), Math.min(half(r), 0.5)))) : 0;
  const x = d3.scaleLinear(withBudget ? [Math.max(0, 1 - far), 1 + far] : [0, 1.08 * d3.max(rows, value)], [margin.left, width - margin.right]);
  const svg = svgIn(box, width, height, withBudget ? "CPU seconds spent over the budget, per mix" : "CPU seconds per mix");
  const bottom = height - margin.bottom, at = (i) => margin.top + pitch * (i + (narrow ? 0.72 : 0.5));
  if (withBudget) {
    for (const [tolerance, css] of [[0.1, "within-10"], [0.02, "within-2"]])
      svg.append("rect").attr("class", css).attr("x", x(Math.max(x.domain()[0], 1 - tolerance))).attr("y", margin.top)
        .attr("width", x(Math.min(x.domain()[1], 1 + tolerance)) - x(Math.max(x.domain()[0], 1 - tolerance))).attr("height", bottom - margin.top);
    svg.append("line").attr("class", "target").attr("x1", x(1)).attr("x2", x(1)).attr("y1", margin.top - 6).attr("y2", bottom);
    svg.append("text").attr("class", "tick-name").attr("text-anchor", "middle").attr("x", x(1)).attr("y", margin.top - 10).text("the budget");
  }
  svg.append("g").attr("class", "axis").attr("transform", `translate(0,${bottom})`)
    .call(d3.axisBottom(x).ticks(narrow ? 4 : 8, withBudget ? "~g" : "~s").tickSizeOuter(0));
  svg.append("text").attr("class", "axis-name").attr("text-anchor", "middle").attr("x", (margin.left + width - margin.right) / 2)
    .attr("y", height - 4).text(withBudget ? "CPU seconds spent / budget" : "CPU seconds");
  rows.forEach((r, i) => drawBudgetRow(svg, r, at(i), x, value(r), half(r), margin, narrow));
}

function drawBudgetRow(svg, r, y, x, value, half, margin, narrow) {
  const g = svg.append("g");
  g.append("text").attr("class", "label").style("fill", "var(--ink)").attr("text-anchor", narrow ? "start" : "end")
    .attr("x", narrow ? margin.left : margin.left - 12).attr("y", narrow ? y - 12 : y + 4).text(r.mix.mix);
  if (!withBudget) g.append("line").attr("class", "stem").style("stroke", colour(r.index)).attr("x1", x(0)).attr("x2", x(value)).attr("y1", y).attr("y2", y);
  const clamp = (v) => Math.max(x.domain()[0], Math.min(x.domain()[1], v));
  if (half > 0) g.append("line").attr("class", "half").style("stroke", colour(r.index))
    .attr("x1", x(clamp(value - half))).attr("x2", x(clamp(value + half))).attr("y1", y).attr("y2", y);
  g.append("path").attr("class", "point").attr("transform", `translate(${x(value)},${y})`).attr("d", markerPath(r.index, 70)).style("fill", colour(r.index));
  g.append("rect").attr("class", "hit screen-only").attr("x", margin.left).attr("width", x.range()[1] - margin.left).attr("y", y - 12).attr("height", 24)
    .on("mousemove", () => showTip(d3.event, el("b", {}, r.mix.mix), withBudget ? `spent / budget ${value.toFixed(4)}` : null,
      `${significant(r.mix.cpu_seconds, 4)} CPU s, ${grouped(r.mix.passes)} passes`, half > 0 ? `half a pass is ${percent(half)}` : null,
      r.mix.pilot_cpu_seconds > 0 ? `the pilot took ${significant(r.mix.pilot_cpu_seconds)} CPU s` : null))
    .on("mouseout", hideTip);
}

function budget() {
  const box = document.getElementById("budget"), plot = el("div", { class: "plot" });
  if (!run.mixes.some((m) => number(withBudget ? m.budget_ratio : m.cpu_seconds))) { document.getElementById("budget-section").remove(); return; }
  if (!withBudget) document.querySelector("#budget-section h2").firstChild.textContent = "CPU seconds per mix";
  responsive(plot, drawBudget);
  box.append(plot, el("p", { class: "note" }, withBudget
    ? "Shaded: within 2 % and within 10 %. The bar is half a pass, the least that whole passes can miss."
    : "The run had no budget in CPU seconds; its mixes are not at equal time."));
  document.getElementById("budget-tools").append(svgButton(plot, "budget"));
}
