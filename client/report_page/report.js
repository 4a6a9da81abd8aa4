"use strict";
// The page's one datum: {run, images, reference, notes}, made by client/report_data.cpp.
const data = JSON.parse(document.getElementById("data").textContent);
const run = data.run;
const colours = ["#2457c5", "#d1495b", "#2a9d6f", "#e09f1f", "#7b4fc9", "#1797b3", "#b0508f", "#6b7a1e"];
const colour = (i) => colours[i % colours.length];

// ---------------------------------------------------------------- words and numbers
/** An element with properties and children; text is never parsed as HTML. */
function el(name, properties = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key === "class") node.className = value;
    else if (key in node) node[key] = value;
    else node.setAttribute(key, value);
  }
  node.append(...children.filter((c) => c !== null && c !== undefined));
  return node;
}
const number = (v) => typeof v === "number" && Number.isFinite(v);
const significant = (v, digits = 3) => {
  if (!number(v)) return "–";
  if (v === 0) return "0";
  const size = Math.abs(v);
  return size < 1e-3 || size >= 1e5 ? v.toExponential(digits - 1).replace("e+", "e") : String(+v.toPrecision(digits));
};
const seconds = (v) => (!number(v) ? "–" : v < 10 ? `${significant(v)} s` : v < 120 ? `${v.toFixed(1)} s` : `${(v / 60).toFixed(1)} min`);
const grouped = (v) => (number(v) ? v.toLocaleString("en-US").replace(/,/g, "\u2009") : "–");
const interval = (ci) => (Array.isArray(ci) ? `[${significant(ci[0])}, ${significant(ci[1])}]` : "");
const base = (path) => path.split("/").pop().replace(/\.[^.]*$/, "");
function budgetText(b) {
  if (number(b.cpu_seconds)) return `${seconds(b.cpu_seconds)} of CPU per mix`;
  if (number(b.spp)) return `${grouped(b.spp)} samples per pixel`;
  return `until relMSE ${significant(b.target_error)}`;
}

const tip = el("div", { class: "tip" });
document.body.append(tip);
function showTip(event, ...lines) {
  tip.replaceChildren(...lines.flatMap((line, i) => (i ? [el("br"), line] : [line])));
  tip.style.visibility = "visible";
  const x = Math.min(event.clientX + 16, window.innerWidth - tip.offsetWidth - 8);
  const y = Math.min(event.clientY + 16, window.innerHeight - tip.offsetHeight - 8);
  tip.style.left = `${x}px`;
  tip.style.top = `${y}px`;
}
const hideTip = () => { tip.style.visibility = "hidden"; };

// ---------------------------------------------------------------- head
const measured = run.mixes.filter((m) => number(m.relmse));
const best = measured.length ? measured.reduce((a, b) => (b.relmse < a.relmse ? b : a)) : null;

function head() {
  document.title = `${base(run.scene)} – Penumbra`;
  const facts = [
    ["budget", budgetText(run.budget)],
    ["image", `${run.resolution[0]} × ${run.resolution[1]}`],
    ["mixes", String(run.mixes.length)],
    ["wall time", seconds(run.wall_seconds)],
    ["render CPU", seconds(run.mixes.reduce((sum, m) => sum + (m.cpu_seconds || 0), 0))],
    ["seed", String(run.seed)],
    ["version", run.version],
  ];
  document.getElementById("head").append(el("div", { class: "inner" },
    el("h1", {}, base(run.scene)),
    el("div", { class: "path" }, run.scene),
    el("dl", {}, ...facts.map(([k, v]) => el("div", {}, el("dt", {}, k), el("dd", {}, v)))),
    run.partial ? el("div", { class: "banner" }, "This run did not finish: images and figures hold what was rendered until then.") : null));
}

// ---------------------------------------------------------------- tables
function cell(value, ci) {
  return el("td", {}, value, ci ? el("span", { class: "ci" }, ci) : null);
}
function mixCell(m, i) {
  return el("td", { class: "mix" }, el("span", { class: "swatch", style: `background:${colour(i)}` }), m.mix,
    m === best && measured.length > 1 ? el("span", { class: "badge" }, "least error") : null);
}
function headCell([name, meaning]) {
  return meaning ? el("th", { title: meaning }, name) : el("th", {}, name);
}

function mixTable() {
  const columns = [
    ["mix", "light samples per strategy and how they are combined"],
    ["passes", "camera samples in every pixel"],
    ["CPU s", "thread CPU seconds of the tile loop, summed over the cores; loading and building apart"],
    ["spent / budget", "CPU seconds over the budget of the mix"],
    ["relMSE", "mean over pixels and channels of (I−R)²/(R²+0.01), with its 95 % interval from resampled 16×16 blocks"],
    ["trimmed", "relMSE without the worst 0.1 % of pixels"],
    ["floor", "the relMSE that a perfect image would show, because the reference is noisy itself"],
    ["relMSE × s", "error times CPU seconds: less is better; constant in time for an unbiased estimator"],
    ["rays / s", "camera, specular and shadow rays per CPU second"],
    ["lines / s", "visible-interval queries per CPU second"],
  ];
  const rate = (count, m) => (count && m.cpu_seconds > 0 ? significant(count / m.cpu_seconds) : "–");
  const rows = run.mixes.map((m, i) => el("tr", m === best && measured.length > 1 ? { class: "best" } : {},
    mixCell(m, i), cell(grouped(m.passes)), cell(significant(m.cpu_seconds, 4)),
    cell(number(m.budget_ratio) ? m.budget_ratio.toFixed(3) : "–"), cell(significant(m.relmse), interval(m.relmse_ci)),
    cell(significant(m.trimmed_relmse)), cell(significant(m.reference_floor, 2)),
    cell(number(m.relmse) ? significant(m.relmse * m.cpu_seconds) : "–"), cell(rate(m.rays, m)), cell(rate(m.line_queries, m))));
  const box = document.getElementById("table");
  box.append(el("div", { class: "scroll" }, el("table", {}, el("thead", {}, el("tr", {}, ...columns.map(headCell))),
    el("tbody", {}, ...rows))));
  const bad = run.mixes.filter((m) => m.non_finite > 0);
  if (bad.length) box.append(el("ul", { class: "plain warnings" }, ...bad.map((m) => el("li", {},
    `${m.mix}: ${grouped(m.non_finite)} samples were not finite and were refused`))));
  const substituted = run.mixes.flatMap((m) => (m.substitutions || []).map((s) => `${m.mix}: ${s}`));
  if (substituted.length) box.append(el("h3", {}, "Strategies that do not fit every light"),
    el("ul", { class: "plain" }, ...substituted.map((s) => el("li", {}, s))));
}

function regionTable() {
  const names = [...new Set(run.mixes.flatMap((m) => Object.keys(m.regions || {})))];
  if (!names.length) { document.getElementById("region-section").remove(); return; }
  const columns = [["mix"], ...names.map((n) => [n, `relMSE of the pixels ${(run.mixes.find((m) => m.regions[n]).regions[n].rect || []).join(",")}`])];
  const rows = run.mixes.map((m, i) => el("tr", {}, mixCell(m, i), ...names.map((n) => {
    const r = (m.regions || {})[n];
    return r ? cell(significant(r.relmse), interval(r.relmse_ci)) : cell("–");
  })));
  document.getElementById("regions").append(el("div", { class: "scroll" }, el("table", {},
    el("thead", {}, el("tr", {}, ...columns.map(headCell))), el("tbody", {}, ...rows))));
}

// ---------------------------------------------------------------- chart
function chart() {
  const series = run.mixes.map((m, i) => ({
    mix: m, index: i,
    points: (m.timeline || []).filter((p) => number(p.relmse) && p.relmse > 0 && p.cpu_seconds > 0),
  })).filter((s) => s.points.length);
  const box = document.getElementById("chart");
  if (!series.length) {
    box.append(el("p", { class: "note" }, run.reference ? "The run has no checkpoint to draw." :
      "Error needs a reference image: give one with --reference."));
    return;
  }
  const longest = d3.max(series, (s) => s.mix.mix.length);
  const width = 1200, height = 500, margin = { top: 14, right: Math.min(480, 34 + 7.8 * longest), bottom: 46, left: 74 };
  const all = series.flatMap((s) => s.points);
  const floors = run.mixes.map((m) => m.reference_floor).filter((v) => number(v) && v > 0);
  const padded = ([lo, hi], by) => [lo / by, hi * by];
  const errors = all.map((p) => p.relmse).concat(series.flatMap((s) => (s.mix.relmse_ci || []).filter((v) => v > 0)));
  const [least, most] = d3.extent(errors);
  // The floor is drawn where it says something: not if it lies decades below every point.
  const floor = floors.length && floors[0] > least / 30 ? floors[0] : null;
  const x = d3.scaleLog(padded(d3.extent(all, (p) => p.cpu_seconds), 1.15), [margin.left, width - margin.right]);
  const y = d3.scaleLog(padded([Math.min(least, floor || least), most], 1.25), [height - margin.bottom, margin.top]);
  const svg = d3.select(box).append("svg").attr("viewBox", `0 0 ${width} ${height}`).attr("role", "img")
    .attr("aria-label", "relMSE against CPU seconds, both logarithmic, one line per mix");

  const decade = (v) => { const l = Math.log10(v); return Math.abs(l - Math.round(l)) < 1e-9; };
  const narrow = (scale) => Math.log10(scale.domain()[1] / scale.domain()[0]) < 2.3;
  const labelled = (scale) => (v) => {
    const lead = Math.round(v / 10 ** Math.floor(Math.log10(v) + 1e-9));
    return decade(v) || (narrow(scale) && [2, 5].includes(lead)) ? significant(v) : "";
  };
  const grid = (scale, axis, size, place) => svg.append("g").attr("class", "grid").attr("transform", place)
    .call(axis(scale).ticks(20).tickSize(-size).tickFormat("")).call((g) => g.select(".domain").remove())
    .selectAll(".tick").classed("minor", (v) => !decade(v));
  grid(x, d3.axisBottom, height - margin.top - margin.bottom, `translate(0,${height - margin.bottom})`);
  grid(y, d3.axisLeft, width - margin.left - margin.right, `translate(${margin.left},0)`);
  svg.append("g").attr("transform", `translate(0,${height - margin.bottom})`)
    .call(d3.axisBottom(x).ticks(20).tickFormat(labelled(x)).tickSizeOuter(0));
  svg.append("g").attr("transform", `translate(${margin.left},0)`)
    .call(d3.axisLeft(y).ticks(20).tickFormat(labelled(y)).tickSizeOuter(0));
  svg.append("text").attr("class", "axis-name").attr("text-anchor", "middle")
    .attr("x", (margin.left + width - margin.right) / 2).attr("y", height - 6).text("CPU seconds of the mix, all cores together");
  svg.append("text").attr("class", "axis-name").attr("text-anchor", "middle")
    .attr("transform", `translate(16,${(margin.top + height - margin.bottom) / 2}) rotate(-90)`).text("relMSE");

  const [x0, x1] = x.range();
  if (floor) {
    svg.append("line").attr("class", "floor").attr("x1", x0).attr("x2", x1).attr("y1", y(floor)).attr("y2", y(floor));
    svg.append("text").attr("x", x1 - 6).attr("y", y(floor) - 6).attr("text-anchor", "end").text("noise floor of the reference");
  }
  const line = d3.line().x((p) => x(p.cpu_seconds)).y((p) => y(p.relmse));
  for (const s of series) {
    const g = svg.append("g");
    g.append("path").attr("d", line(s.points)).attr("fill", "none").attr("stroke", colour(s.index)).attr("stroke-width", 2.2)
      .attr("stroke-linejoin", "round");
    const last = s.points[s.points.length - 1], ci = s.mix.relmse_ci;
    if (Array.isArray(ci) && ci[0] > 0) {
      const cx = x(last.cpu_seconds);
      g.append("path").attr("stroke", colour(s.index)).attr("stroke-width", 1.4).attr("fill", "none")
        .attr("d", `M${cx - 4},${y(ci[0])}h8m-4,0V${y(ci[1])}m-4,0h8`);
    }
    g.selectAll("circle").data(s.points).enter().append("circle").attr("cx", (p) => x(p.cpu_seconds))
      .attr("cy", (p) => y(p.relmse)).attr("r", 3.6).attr("fill", "#fff").attr("stroke", colour(s.index)).attr("stroke-width", 2)
      .on("mousemove", (p) => showTip(d3.event, el("b", {}, s.mix.mix), `${significant(p.cpu_seconds, 4)} CPU s, ${grouped(p.passes)} passes`,
        `relMSE ${significant(p.relmse, 4)}`))
      .on("mouseout", hideTip);
  }
  // Labels at the ends of the lines, pushed apart where they would overlap.
  const labels = series.map((s) => ({ s, y: y(s.points[s.points.length - 1].relmse) })).sort((a, b) => a.y - b.y);
  const pitch = 17;
  labels.forEach((l, i) => { if (i) l.y = Math.max(l.y, labels[i - 1].y + pitch); });
  const excess = labels[labels.length - 1].y - (height - margin.bottom);
  if (excess > 0) labels.slice().reverse().forEach((l, i, r) => { l.y = i ? Math.min(l.y, r[i - 1].y - pitch) : l.y - excess; });
  for (const l of labels) {
    const last = l.s.points[l.s.points.length - 1];
    svg.append("path").attr("fill", "none").attr("stroke", colour(l.s.index)).attr("stroke-opacity", 0.45)
      .attr("d", `M${x(last.cpu_seconds) + 6},${y(last.relmse)}L${x1 + 10},${l.y}h6`);
    svg.append("text").attr("class", "label").attr("x", x1 + 21).attr("y", l.y + 4).style("fill", colour(l.s.index)).text(l.s.mix.mix);
  }
  box.append(el("p", { class: "note" }, "Each point is the whole image after the same number of passes in every pixel; the bar at the end is the 95 % interval. " +
    "An unbiased estimator falls by a factor of ten for ten times the CPU seconds."));
}

// ---------------------------------------------------------------- images
/** The 65,536 values of a half float. */
const halves = (() => {
  const table = new Float32Array(65536);
  for (let bits = 0; bits < 65536; ++bits) {
    const sign = bits & 0x8000 ? -1 : 1, exponent = (bits >> 10) & 31, fraction = bits & 1023;
    table[bits] = sign * (exponent === 0 ? fraction * 2 ** -24 : exponent === 31 ? (fraction ? NaN : Infinity) : (1 + fraction / 1024) * 2 ** (exponent - 15));
  }
  return table;
})();

/** base64 of zlib of byte planes -> three Float32Arrays. */
async function decode(image) {
  const packed = Uint8Array.from(atob(image.half), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const n = image.width * image.height;
  const planes = [0, 1, 2].map((c) => {
    const plane = new Float32Array(n);
    for (let i = 0; i < n; ++i) plane[i] = halves[bytes[2 * c * n + i] | (bytes[(2 * c + 1) * n + i] << 8)];
    return plane;
  });
  return { ...image, planes, half: null };
}

/** Linear [0,1] -> sRGB byte, in 4,096 steps (finer than a byte everywhere but in the deepest shadows). */
const srgb = Uint8ClampedArray.from({ length: 4097 }, (_, i) => {
  const v = i / 4096;
  return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
});
const errorRange = [1e-4, 1e1];
const errorColours = (() => {
  const table = new Uint8ClampedArray(3 * 256);
  for (let i = 0; i < 256; ++i) {
    const c = d3.color(d3.interpolateInferno(i / 255));
    table.set([c.r, c.g, c.b], 3 * i);
  }
  return table;
})();

function drawColour(image, canvas, exposure) {
  const pixels = canvas.getContext("2d").createImageData(image.width, image.height), out = pixels.data;
  const scale = 4096 * 2 ** exposure;
  for (let c = 0; c < 3; ++c) {
    const plane = image.planes[c];
    for (let i = 0, o = c; i < plane.length; ++i, o += 4) out[o] = srgb[Math.max(0, Math.min(4096, (plane[i] * scale) | 0))];
  }
  for (let o = 3; o < out.length; o += 4) out[o] = 255;
  canvas.getContext("2d").putImageData(pixels, 0, 0);
}
/** Relative squared error of a pixel, channels averaged: what relMSE averages. */
function pixelError(image, reference, i) {
  let sum = 0;
  for (let c = 0; c < 3; ++c) {
    const r = reference.planes[c][i], d = image.planes[c][i] - r;
    sum += (d * d) / (r * r + 1e-2);
  }
  return sum / 3;
}
function drawError(image, reference, canvas) {
  const pixels = canvas.getContext("2d").createImageData(image.width, image.height), out = pixels.data;
  const low = Math.log(errorRange[0]), span = Math.log(errorRange[1]) - low;
  for (let i = 0; i < image.width * image.height; ++i) {
    const t = (Math.log(pixelError(image, reference, i)) - low) / span;
    const k = 3 * Math.max(0, Math.min(255, Math.round(255 * t)));
    out[4 * i] = errorColours[k];
    out[4 * i + 1] = errorColours[k + 1];
    out[4 * i + 2] = errorColours[k + 2];
    out[4 * i + 3] = 255;
  }
  canvas.getContext("2d").putImageData(pixels, 0, 0);
}

/** Exposure in stops that puts the 90th percentile of luminance at 0.7. */
function goodExposure(image) {
  const [r, g, b] = image.planes, step = Math.max(1, Math.floor(r.length / 20000)), values = [];
  for (let i = 0; i < r.length; i += step) values.push(0.2126 * r[i] + 0.7152 * g[i] + 0.0722 * b[i]);
  const bright = d3.quantile(values.filter(Number.isFinite).sort(d3.ascending), 0.9);
  return bright > 0 ? Math.max(-8, Math.min(8, Math.round(4 * Math.log2(0.7 / bright)) / 4)) : 0;
}

async function images() {
  const box = document.getElementById("images"), controls = document.getElementById("controls");
  const shown = [];
  for (let i = 0; i < data.images.length; ++i)
    if (data.images[i]) shown.push({ name: run.mixes[i].mix, mix: run.mixes[i], index: i, image: await decode(data.images[i]) });
  if (!shown.length) { box.append(el("p", { class: "note" }, "The images are not there.")); return; }
  const reference = data.reference ? await decode(data.reference) : null;
  if (reference) shown.push({ name: "reference", mix: null, index: -1, image: reference });

  const state = { exposure: goodExposure((reference || shown[0].image)), mode: "colour", zoom: 1, x: 0, y: 0 };
  const aspect = shown[0].image.width / shown[0].image.height;
  box.style.setProperty("--tile", `${Math.round(Math.max(240, Math.min(600, shown.length < 3 ? 600 : 390)))}px`);

  for (const s of shown) {
    s.canvas = el("canvas", { width: s.image.width, height: s.image.height });
    s.layer = el("div", { class: "layer" }, s.canvas);
    const regions = s.mix ? Object.values(s.mix.regions || {}).map((r) => r.rect).filter(Boolean) : [];
    if (regions.length) {
      const svg = d3.select(s.layer).append("svg").attr("viewBox", `0 0 ${s.image.width} ${s.image.height}`).attr("preserveAspectRatio", "none");
      for (const [x0, y0, x1, y1] of regions)
        svg.append("rect").attr("x", (x0 - s.image.x0) / s.image.scale).attr("y", (y0 - s.image.y0) / s.image.scale)
          .attr("width", (x1 - x0) / s.image.scale).attr("height", (y1 - y0) / s.image.scale);
    }
    s.view = el("div", { class: "view", style: `aspect-ratio:${aspect}` }, s.layer);
    const figure = s.mix && number(s.mix.relmse) ? `relMSE ${significant(s.mix.relmse)}` : s.mix ? `${grouped(s.mix.passes)} passes` : "";
    box.append(el("figure", {}, el("figcaption", {},
      el("span", { class: "name", title: s.name }, s.mix ? el("span", { class: "swatch", style: `background:${colour(s.index)}` }) : null, s.name),
      el("span", { class: "fig" }, figure)), s.view));
  }
  const paint = () => shown.forEach((s) => (state.mode === "error" ? drawError(s.image, reference, s.canvas) : drawColour(s.image, s.canvas, state.exposure)));
  const place = () => shown.forEach((s) => {
    s.layer.style.transform = `translate(${state.x * 100}%,${state.y * 100}%) scale(${state.zoom})`;
    s.layer.style.setProperty("--stroke", `${1.4 / state.zoom}px`);
    s.canvas.classList.toggle("sharp", (state.zoom * s.view.clientWidth) / s.image.width > 2);
  });
  const clamp = () => {
    state.x = Math.min(0, Math.max(1 - state.zoom, state.x));
    state.y = Math.min(0, Math.max(1 - state.zoom, state.y));
  };

  // Controls.
  const stops = el("output", {}, "");
  const slider = el("input", { type: "range", min: -8, max: 8, step: 0.25, value: state.exposure });
  const tellStops = () => { stops.textContent = `${state.exposure > 0 ? "+" : ""}${state.exposure} EV`; };
  slider.addEventListener("input", () => { state.exposure = +slider.value; tellStops(); paint(); });
  tellStops();
  controls.append(el("label", {}, "exposure", slider, stops));
  if (reference) {
    const buttons = [["colour", "colour"], ["error", "relative error"]].map(([mode, text]) => {
      const b = el("button", { type: "button" }, text);
      b.addEventListener("click", () => { state.mode = mode; tellMode(); paint(); });
      return [mode, b];
    });
    const legend = el("div", { class: "legend" });
    const scale = el("canvas", { width: 256, height: 1 });
    const row = scale.getContext("2d").createImageData(256, 1);
    for (let i = 0; i < 256; ++i) row.data.set([errorColours[3 * i], errorColours[3 * i + 1], errorColours[3 * i + 2], 255], 4 * i);
    scale.getContext("2d").putImageData(row, 0, 0);
    legend.append(significant(errorRange[0]), scale, significant(errorRange[1]), " (I−R)²/(R²+0.01) per pixel, logarithmic");
    const tellMode = () => {
      buttons.forEach(([mode, b]) => b.setAttribute("aria-pressed", String(mode === state.mode)));
      legend.style.display = state.mode === "error" ? "" : "none";
    };
    controls.append(el("span", { class: "switch" }, ...buttons.map(([, b]) => b)));
    document.getElementById("image-section").append(legend);
    tellMode();
  }
  const reset = el("button", { type: "button", class: "plain" }, "whole image");
  reset.addEventListener("click", () => { Object.assign(state, { zoom: 1, x: 0, y: 0 }); place(); });
  controls.append(reset, el("label", {}, "wheel zooms, dragging moves, all images together"));

  // Zoom about the pointer, drag, and the values under the pointer.
  const fraction = (view, event) => {
    const r = view.getBoundingClientRect();
    return [(event.clientX - r.left) / r.width, (event.clientY - r.top) / r.height];
  };
  for (const s of shown) {
    s.view.addEventListener("wheel", (event) => {
      event.preventDefault();
      const [fx, fy] = fraction(s.view, event);
      const zoom = Math.max(1, Math.min(64, state.zoom * 2 ** (-event.deltaY / 300)));
      state.x = fx - (fx - state.x) * (zoom / state.zoom);
      state.y = fy - (fy - state.y) * (zoom / state.zoom);
      state.zoom = zoom;
      clamp();
      place();
    }, { passive: false });
    s.view.addEventListener("pointerdown", (event) => { s.view.setPointerCapture(event.pointerId); s.view.classList.add("dragging"); });
    s.view.addEventListener("pointerup", () => s.view.classList.remove("dragging"));
    s.view.addEventListener("pointerleave", hideTip);
    s.view.addEventListener("pointermove", (event) => {
      if (s.view.classList.contains("dragging")) {
        const r = s.view.getBoundingClientRect();
        state.x += event.movementX / r.width;
        state.y += event.movementY / r.height;
        clamp();
        place();
      }
      const [fx, fy] = fraction(s.view, event);
      const px = Math.floor(((fx - state.x) / state.zoom) * s.image.width), py = Math.floor(((fy - state.y) / state.zoom) * s.image.height);
      if (px < 0 || py < 0 || px >= s.image.width || py >= s.image.height) return hideTip();
      const i = py * s.image.width + px;
      const lines = [el("b", {}, s.name), `pixel ${s.image.x0 + px * s.image.scale}, ${s.image.y0 + py * s.image.scale}`,
        s.image.planes.map((p) => significant(p[i])).join("  ")];
      if (reference && s.mix) lines.push(`relative squared error ${significant(pixelError(s.image, reference, i))}`);
      showTip(event, ...lines);
    });
  }
  paint();
  place();
  if (shown[0].image.scale > 1) document.getElementById("image-section").append(
    el("p", { class: "note" }, `Shown at 1/${shown[0].image.scale} of the resolution (means of pixels); the EXR files have all of it.`));
}

// ---------------------------------------------------------------- the run
function theRun() {
  const facts = (pairs) => el("dl", { class: "facts" }, ...pairs.flatMap(([k, v]) => [el("dt", {}, k), el("dd", {}, v)]));
  const load = run.load || {}, spec = run.spec || {}, cores = (run.workers || []).reduce((sum, w) => sum + w.cores, 0);
  const busy = number(run.worker_cpu_seconds) && run.render_wall_seconds > 0 && cores > 0
    ? `${(100 * run.worker_cpu_seconds / (cores * run.render_wall_seconds)).toFixed(0)} % of ${cores} cores` : "–";
  const left = el("div", {}, el("h3", {}, "Time"), facts([
    ["wall", seconds(run.wall_seconds)], ["rendering", seconds(run.render_wall_seconds)],
    ["until the first tile", seconds(run.first_result_seconds)],
    ["reading the scene", seconds(load.parse_seconds)], ["building it", seconds(load.build_seconds)],
    ["workers busy", busy], ["server CPU", seconds((run.scheduler || {}).cpu_seconds)],
    ["leases given out again", grouped(run.retries)]]),
    el("h3", {}, "Settings"), facts([["sampler", spec.sampler || "–"], ["depth", String(spec.max_depth ?? "–")],
      ["tile", `${spec.tile ?? "–"} pixels`], ["crop", (spec.crop || []).join(", ")], ["reference", run.reference || "none"]]));
  const needs = (run.needs || []).length ? el("dl", { class: "facts" }, ...run.needs.flatMap((n) => [el("dt", {}, n.effect), el("dd", {}, n.why)]))
    : el("p", { class: "note" }, "Nothing beyond surfaces and lights.");
  const workers = el("ul", { class: "plain" }, ...(run.workers || []).map((w) => {
    const tiles = (run.tiles || []).filter((t) => t.worker === w.id);
    return el("li", {}, `${w.host}: ${w.cores} threads, ${w.isa}, ${seconds(tiles.reduce((sum, t) => sum + t.cpu_seconds, 0))} of rendering `,
      el("code", {}, w.id.slice(0, 8)));
  }));
  const right = el("div", {}, el("h3", {}, "What the scene calls for"), needs, el("h3", {}, "Workers"), workers);
  const warnings = [...(data.notes || []), ...(run.warnings || [])];
  document.getElementById("run").append(el("div", { class: "columns" }, left, right),
    ...(warnings.length ? [el("h3", {}, "Warnings"), el("ul", { class: "plain warnings" }, ...warnings.map((w) => el("li", {}, w)))] : []));
}

head();
mixTable();
regionTable();
chart();
theRun();
images().then(() => document.body.setAttribute("data-ready", ""), (fault) => {
  document.getElementById("images").append(el("p", { class: "note" }, `The images cannot be shown: ${fault.message}`));
});
