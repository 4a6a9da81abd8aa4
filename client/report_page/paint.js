// Numbers -> colours on a canvas: the ways in which an image can be looked at.

/** Linear [0,1] -> sRGB byte, in 4,096 steps (finer than a byte everywhere but in the deepest shadows). */
const srgb = Uint8ClampedArray.from({ length: 4097 }, (_, i) => {
  const v = i / 4096;
  return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
});

function paintColour(image, canvas, exposure) {
  const context = canvas.getContext("2d"), pixels = context.createImageData(image.width, image.height), out = pixels.data;
  const scale = 4096 * 2 ** exposure;
  for (let c = 0; c < 3; ++c) {
    const plane = image.planes[c];
    for (let i = 0, o = c; i < plane.length; ++i, o += 4) out[o] = srgb[Math.max(0, Math.min(4096, (plane[i] * scale) | 0))];
  }
  for (let o = 3; o < out.length; o += 4) out[o] = 255;
  context.putImageData(pixels, 0, 0);
}

function paintHeat(plane, canvas, scale) {
  const context = canvas.getContext("2d"), pixels = context.createImageData(canvas.width, canvas.height), out = pixels.data;
  for (let i = 0, o = 0; i < plane.length; ++i, o += 4) {
    const k = 3 * scale.index(plane[i]);
    out[o] = scale.table[k];
    out[o + 1] = scale.table[k + 1];
    out[o + 2] = scale.table[k + 2];
    out[o + 3] = 255;
  }
  context.putImageData(pixels, 0, 0);
}

/** Exposure in stops that puts the 90th percentile of luminance at 0.7. */
function goodExposure(image) {
  const [r, g, b] = image.planes, step = Math.max(1, Math.floor(r.length / 20000)), values = [];
  for (let i = 0; i < r.length; i += step) values.push(0.2126 * r[i] + 0.7152 * g[i] + 0.0722 * b[i]);
  const bright = d3.quantile(values.filter(Number.isFinite).sort(d3.ascending), 0.9);
  return bright > 0 ? Math.max(-12, Math.min(12, Math.round(4 * Math.log2(0.7 / bright)) / 4)) : 0;
}

/** One scale for all images' planes: from the 1st to the 99th percentile of what is positive. */
function commonScale(planes, interpolate) {
  const values = [];
  for (const plane of planes) {
    const step = Math.max(1, Math.floor(plane.length / 5000));
    for (let i = 0; i < plane.length; i += step) if (plane[i] > 0 && Number.isFinite(plane[i])) values.push(plane[i]);
  }
  values.sort(d3.ascending);
  if (!values.length) return heatScale(1, 10, interpolate);
  const low = d3.quantile(values, 0.01), high = d3.quantile(values, 0.99);
  return high > 1.02 * low ? heatScale(low, high, interpolate) : heatScale(low / 2, high * 2, interpolate);
}

/**
 * The modes in which the shown images can be seen: {name, label, meaning, unit, plane(image), scale}. `plane` gives null
 * for an image that has no such values (the reference has no cost).
 */
function viewModes(shown, reference) {
  const mixes = shown.filter((s) => s.mix).map((s) => s.image), all = (name) => mixes.map((m) => m[name]).filter(Boolean);
  const modes = [{ name: "colour", label: "colour", meaning: "The image, brightened by the exposure and encoded as sRGB." }];
  if (reference) modes.push({ name: "error", label: "relative error", unit: "",
    meaning: "False colour of (I−R)²/(R²+0.01) per pixel, channels averaged, logarithmic: what relMSE averages.",
    plane: (image) => (image === reference ? null : errorPlane(image, reference)), scale: heatScale(1e-4, 1e1, d3.interpolateInferno) });
  if (all("noise").length) modes.push({ name: "noise", label: "own noise", unit: "",
    meaning: "What the run itself expects of the relative squared error per pixel: v/(S²+0.01), v the variance of the mean, S the image averaged over 5×5 pixels; logarithmic.",
    plane: (image) => image.noise || null, scale: heatScale(1e-4, 1e1, d3.interpolateInferno) });
  if (all("cost").length) modes.push({ name: "cost", label: "cost", unit: "µs",
    meaning: "CPU microseconds that each pixel took, all passes together; one logarithmic scale for all mixes.",
    plane: (image) => image.cost || null, scale: commonScale(all("cost"), d3.interpolateViridis) });
  if (all("samples").length) modes.push({ name: "samples", label: "samples", unit: "passes",
    meaning: "Camera samples of each pixel; one logarithmic scale for all mixes. Fixed mixes have the same in every pixel; auto spends more where the error is.",
    plane: (image) => image.samples || null, scale: commonScale(all("samples"), d3.interpolateCividis) });
  return modes;
}

/** The colours of a scale with its ends in numbers. */
function scaleLegend(mode) {
  const canvas = el("canvas", { width: 256, height: 1, "aria-hidden": "true" }), context = canvas.getContext("2d");
  const row = context.createImageData(256, 1);
  for (let i = 0; i < 256; ++i) row.data.set([...mode.scale.table.subarray(3 * i, 3 * i + 3), 255], 4 * i);
  context.putImageData(row, 0, 0);
  const unit = mode.unit ? ` ${mode.unit}` : "";
  return [`${significant(mode.scale.low)}${unit}`, canvas, `${significant(mode.scale.high)}${unit}`];
}
