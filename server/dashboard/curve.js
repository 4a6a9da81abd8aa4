// Error against CPU seconds, log-log, of the mixes of one job.

/** mixes: [{mix, curve: [{cpu_seconds, estimated_relmse}]}]; draws into `box`. */
function drawCurve(box, mixes) {
  const series = mixes.map((m, i) => ({ name: m.mix, i, points: m.curve.filter((p) => p.cpu_seconds > 0 && p.estimated_relmse > 0) }))
    .filter((s) => s.points.length);
  if (!series.length) {
    box.replaceChildren(el("p", { class: "note" }, "None yet: it takes two passes in every pixel."));
    return;
  }
  const width = Math.max(280, box.clientWidth), height = 270, margin = { top: 8, right: 12, bottom: 40, left: 56 };
  const all = series.flatMap((s) => s.points);
  const wide = ([low, high]) => [low / 1.3, high * 1.3];
  const x = d3.scaleLog(wide(d3.extent(all, (p) => p.cpu_seconds)), [margin.left, width - margin.right]);
  const y = d3.scaleLog(wide(d3.extent(all, (p) => p.estimated_relmse)), [height - margin.bottom, margin.top]);
  const svg = d3.create("svg").attr("viewBox", `0 0 ${width} ${height}`).attr("role", "img")
    .attr("aria-label", "estimated relMSE against CPU seconds, one curve per mix");
  const label = (scale) => (v) => {
    const lead = Math.round(v / 10 ** Math.floor(Math.log10(v) + 1e-9));
    const few = Math.abs(Math.log10(scale.domain()[1] / scale.domain()[0])) < 2;
    return lead === 1 || (few && [2, 5].includes(lead)) ? significant(v) : "";
  };
  svg.append("g").attr("transform", `translate(0,${height - margin.bottom})`).call(d3.axisBottom(x).ticks(9).tickFormat(label(x)));
  svg.append("g").attr("transform", `translate(${margin.left},0)`).call(d3.axisLeft(y).ticks(9).tickFormat(label(y)));
  svg.append("text").attr("text-anchor", "middle").attr("x", (margin.left + width) / 2).attr("y", height - 6).text("CPU seconds of the mix");
  for (const s of series) {
    svg.append("path").attr("class", "line").style("stroke", colour(s.i))
      .attr("d", d3.line().x((p) => x(p.cpu_seconds)).y((p) => y(p.estimated_relmse))(s.points));
    svg.selectAll(null).data(s.points).enter().append("circle").attr("r", 3).style("fill", colour(s.i))
      .attr("cx", (p) => x(p.cpu_seconds)).attr("cy", (p) => y(p.estimated_relmse))
      .append("title").text((p) => `${s.name}: ${significant(p.estimated_relmse)} after ${seconds(p.cpu_seconds)}, ${p.passes} passes`);
  }
  const keys = el("div", { class: "keys" });
  for (const s of series) {
    const key = el("span", {}, `● ${s.name} ${significant(s.points[s.points.length - 1].estimated_relmse)}`);
    key.style.color = colour(s.i);
    keys.append(key);
  }
  box.replaceChildren(svg.node(), keys);
}
