// Where the time went: every tile of a mix with its passes, CPU seconds, worker and, for `auto`, the mix it planned.

/** "mix:rect" -> the fixed mix that `auto` planned there (run.json's auto_plans). */
const plannedMixes = new Map((run.auto_plans || []).flatMap((plan) => plan.tiles.map((t) => [`${plan.mix}:${t.rect.join()}`, t.mix])));

/** One record per (mix, tile): what all its rows (one per worker) come to; `planned` is null for a fixed mix. */
const tileRecords = (() => {
  const records = new Map();
  for (const row of run.tiles || []) {
    const key = `${row.mix}:${row.rect.join()}`;
    const record = records.get(key)
      || { mix: row.mix, rect: row.rect, passes: 0, cpu_seconds: 0, workers: new Map(), planned: plannedMixes.get(key) || null };
    record.passes += row.passes;
    record.cpu_seconds += row.cpu_seconds;
    record.workers.set(row.worker, (record.workers.get(row.worker) || 0) + row.cpu_seconds);
    records.set(key, record);
  }
  for (const r of records.values()) {
    r.worker = [...r.workers].reduce((a, b) => (b[1] > a[1] ? b : a))[0];
    r.per_pixel = (1e6 * r.cpu_seconds) / ((r.rect[2] - r.rect[0]) * (r.rect[3] - r.rect[1]));
  }
  return [...records.values()];
})();

const hostOf = (id) => ((run.workers || []).find((w) => w.id === id) || { host: id }).host;
const workerName = (id) => `${hostOf(id)} ${id.slice(0, 8)}`;

/** The ways to colour tiles: {name, label, meaning, value(record), show(value), kind}. */
const tileViews = [
  { name: "planned", label: "planned mix", kind: "class", value: (r) => r.planned, show: (v) => v,
    meaning: "The fixed mix that auto's pilot chose for the tile." },
  { name: "passes", label: "passes", kind: "heat", value: (r) => r.passes, show: (v) => grouped(v), meaning: "Camera samples per pixel in the tile; of auto, in the block of 8×8 pixels with the most." },
  { name: "cost", label: "µs / pixel", kind: "heat", value: (r) => r.per_pixel, show: (v) => `${significant(v)} µs`,
    meaning: "CPU microseconds per pixel in the tile, all passes together." },
  { name: "worker", label: "worker", kind: "class", value: (r) => r.worker, show: workerName,
    meaning: "The worker that spent the most CPU seconds on the tile." },
];

/** Colours of a view's values, and the legend's entries. */
function tilePaint(view, records) {
  const values = records.map(view.value);
  if (view.kind === "class") {
    const names = [...new Set(values.filter((v) => v !== null))].sort();
    return { css: (v) => (v === null ? "none" : colour(names.indexOf(v))), names, scale: null };
  }
  const positive = values.filter((v) => v > 0), [low, high] = positive.length ? d3.extent(positive) : [1, 2];
  const scale = high > 1.001 * low ? heatScale(low, high, d3.interpolateViridis) : heatScale(low / 2, high * 2, d3.interpolateViridis);
  return { css: scale.css, names: null, scale: { ...scale, low, high } };
}

function drawTiles(box, width, mix, view) {
  const records = tileRecords.filter((r) => r.mix === mix), paint = tilePaint(view, records);
  const x0 = d3.min(records, (r) => r.rect[0]), y0 = d3.min(records, (r) => r.rect[1]);
  const x1 = d3.max(records, (r) => r.rect[2]), y1 = d3.max(records, (r) => r.rect[3]);
  const scale = Math.min(width, 640) / (x1 - x0), height = Math.round((y1 - y0) * scale);
  const svg = svgIn(box, Math.round((x1 - x0) * scale), height, `tiles of ${run.mixes[mix].mix}, coloured by ${view.label}`);
  svg.attr("class", "tiles").style("max-width", `${Math.round((x1 - x0) * scale)}px`);
  const g = svg.selectAll("g").data(records).enter().append("g")
    .attr("transform", (r) => `translate(${(r.rect[0] - x0) * scale},${(r.rect[1] - y0) * scale})`);
  g.append("rect").attr("class", "tile").attr("width", (r) => (r.rect[2] - r.rect[0]) * scale).attr("height", (r) => (r.rect[3] - r.rect[1]) * scale)
    .style("fill", (r) => paint.css(view.value(r)))
    .on("mousemove", (r) => showTip(d3.event, el("b", {}, `pixels ${r.rect.join(", ")}`), r.planned ? `planned ${r.planned}` : null,
      `${grouped(r.passes)} passes, ${seconds(r.cpu_seconds)} of CPU, ${significant(r.per_pixel)} µs per pixel`,
      `worker ${[...r.workers.keys()].map(workerName).join(", ")}`))
    .on("mouseout", hideTip);
  return paint;
}

function tileLegend(view, paint, records) {
  if (paint.names) return el("div", { class: "legend" }, ...paint.names.map((n, i) =>
    el("span", { class: "key" }, el("span", { class: "key-box", style: `background:${colour(i)}` }), view.show(n),
      ` · ${percent(records.filter((r) => view.value(r) === n).length / records.length, 0)} of the tiles`)));
  const [low, canvas, high] = scaleLegend({ scale: paint.scale });
  if (paint.scale.low === paint.scale.high) return el("div", { class: "legend" }, `every tile: ${view.show(paint.scale.low)}`);
  return el("div", { class: "legend" }, view.show(paint.scale.low), canvas, view.show(paint.scale.high), el("span", {}, "logarithmic"));
}

function tiles() {
  const section = document.getElementById("tile-section"), box = document.getElementById("tiles");
  if (!tileRecords.length) { section.remove(); return; }
  const mixes = [...new Set(tileRecords.map((r) => r.mix))].sort((a, b) => a - b);
  const planned = mixes.find((m) => tileRecords.some((r) => r.mix === m && r.planned));
  const state = { mix: planned === undefined ? mixes[0] : planned, view: planned === undefined ? "cost" : "planned" };
  const views = () => tileViews.filter((v) => v.name !== "planned" || tileRecords.some((r) => r.mix === state.mix && r.planned));
  const plot = el("div", { class: "plot" }), legend = el("div"), choices = el("span");
  const redraw = responsive(plot, (target, width) => {
    const view = views().find((v) => v.name === state.view) || views()[0];
    const paint = drawTiles(target, width, state.mix, view);
    legend.replaceChildren(tileLegend(view, paint, tileRecords.filter((r) => r.mix === state.mix)), el("p", { class: "note" }, view.meaning));
  });
  const offer = () => choices.replaceChildren(switchOf("what tiles show", views().map((v) => [v.name, v.label, v.meaning]), state.view,
    (name) => { state.view = name; redraw(); }));
  const select = el("select", { id: "tile-mix", "aria-label": "mix" }, ...mixes.map((m) => el("option", { value: m }, run.mixes[m].mix)));
  select.value = String(state.mix);
  select.addEventListener("change", () => {
    state.mix = +select.value;
    if (!views().some((v) => v.name === state.view)) state.view = views()[0].name;
    offer();
    redraw();
  });
  offer();
  box.append(el("div", { class: "controls" }, select, choices), plot, legend);
  document.getElementById("tile-tools").append(svgButton(plot, "tiles"));
}
