// Time, settings, what the scene called for, warnings; and who rendered.
function facts(rows) {
  return el("dl", { class: "facts" }, ...rows.filter(Boolean).flatMap(([name, value, meaning]) =>
    [el("dt", {}, name), explained(el("dd", {}, value), meaning)]));
}

function workerTable() {
  const box = document.getElementById("workers"), workers = run.workers || [];
  if (!workers.length) { document.getElementById("worker-section").remove(); return; }
  const spent = (w) => d3.sum((run.tiles || []).filter((t) => t.worker === w.id), (t) => t.cpu_seconds);
  const total = d3.sum(workers, spent);
  const columns = [["worker", "Host and incarnation: a worker that was started again has another."], ["threads", "threads"], ["instructions", "isa"],
    ["tiles", "tiles"], ["CPU s", "cpu_seconds"], ["share", "share"]];
  const rows = workers.map((w) => {
    const share = total > 0 ? spent(w) / total : 0;
    const touched = new Set((run.tiles || []).filter((t) => t.worker === w.id).map((t) => t.rect.join()));
    return [el("td", {}, w.host, " ", el("code", {}, w.id.slice(0, 8))), cell(grouped(w.cores), "threads"), cell(w.isa, "isa"),
      cell(grouped(touched.size), "tiles"), cell(significant(spent(w), 4), "cpu_seconds"),
      explained(el("td", {}, el("span", { class: "share", style: `--share:${share}` }), percent(share)), "share")];
  });
  box.append(table(columns, rows));
}

function theRun() {
  const load = run.load || {}, spec = run.spec || {}, cores = d3.sum(run.workers || [], (w) => w.cores);
  const busy = number(run.worker_cpu_seconds) && run.render_wall_seconds > 0 && cores > 0
    ? `${percent(run.worker_cpu_seconds / (cores * run.render_wall_seconds), 0)} of ${cores} threads` : "–";
  const pilot = d3.sum(run.mixes, (m) => m.pilot_cpu_seconds || 0);
  const time = facts([["wall", seconds(run.wall_seconds), "wall"], ["rendering", seconds(run.render_wall_seconds), "render_wall"],
    ["until the first tile", seconds(run.first_result_seconds), "first_result"], ["reading the scene", seconds(load.parse_seconds), "parse"],
    ["building it", seconds(load.build_seconds), "build"], ["pilots", seconds(pilot), "pilot"], ["workers busy", busy, "busy"],
    ["server CPU", seconds((run.scheduler || {}).cpu_seconds), "server_cpu"], ["leases given out again", grouped(run.retries), "retries"]]);
  const settings = facts([["sampler", spec.sampler || "–", "How the samples of a pixel are spread."],
    ["depth", String(spec.max_depth ?? "–"), "Vertices with direct light; more than 1 follows specular chains."],
    ["tile", spec.tile ? `${spec.tile} pixels` : "–", "Edge of a tile."], ["crop", (spec.crop || []).join(", "), "Pixels that were rendered, half-open."],
    run.transient ? ["bins of path length", `${run.transient.bins} over ${significant(run.transient.t0, 6)} to ${significant(run.transient.t1, 6)}`,
      "Light is sorted by the length of its path from the camera, in scene units."] : null,
    ["reference", run.reference || "none", "What relMSE is measured against."]]);
  const needs = (run.needs || []).length ? facts(run.needs.map((n) => [n.effect, n.why, "An effect that the scene calls for, and where."]))
    : el("p", { class: "note" }, "Nothing beyond surfaces and lights.");
  const warnings = [...(data.notes || []), ...(run.warnings || [])];
  document.getElementById("run").append(el("div", { class: "columns" },
    el("div", {}, el("h3", {}, "Time"), time), el("div", {}, el("h3", {}, "Settings"), settings, el("h3", {}, "What the scene calls for"), needs)),
  ...(warnings.length ? [el("h3", {}, "Warnings"), el("ul", { class: "plain warnings" }, ...warnings.map((w) => el("li", {}, w)))] : []));
}
