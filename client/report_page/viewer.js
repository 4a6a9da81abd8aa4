// All images side by side (or two, split), moved and zoomed together.
const viewer = {
  shown: [],            // {name, mix, index, image, canvas, layer, view, caption, overlay}
  reference: null,      // decoded, or null
  modes: [], mode: null, exposure: 0,
  zoom: 1, x: 0, y: 0,  // of all views: shift in fractions of a view's size
  selection: null,      // [x0, y0, x1, y1], pixels of the full image, drawn on the page
  drawing: false,       // the next drag draws a region
};

const figureOf = (s) => {
  if (!s.mix) return "";
  return number(errorOf(s.mix)) ? `${errorKind.estimated ? "estimate" : "relMSE"} ${significant(errorOf(s.mix))}` : `${grouped(s.mix.passes)} passes`;
};

/** What the mode shows of pixel (x, y) of the page's image. */
function valueText(s, x, y) {
  const i = y * s.image.width + x, plane = viewer.mode.plane ? viewer.mode.plane(s.image) : null;
  if (!viewer.mode.plane) return s.image.planes.map((p) => significant(p[i])).join(" ");
  return plane ? `${significant(plane[i])} ${viewer.mode.unit || ""}` : "";
}

function paintOne(s) {
  const plane = viewer.mode.plane ? viewer.mode.plane(s.image) : null;
  if (viewer.mode.plane && plane) paintHeat(plane, s.canvas, viewer.mode.scale);
  else paintColour(s.image, s.canvas, viewer.exposure);
  s.view.classList.toggle("unmeasured", Boolean(viewer.mode.plane && !plane));
}
const paintAll = () => viewer.shown.forEach(paintOne);

/** Puts every view where the state says. */
function placeAll() {
  for (const s of viewer.shown) {
    const w = s.view.clientWidth, h = s.view.clientHeight;
    if (!w) continue;
    s.view.__zoom = d3.zoomIdentity.translate(viewer.x * w, viewer.y * h).scale(viewer.zoom);
    s.layer.style.transform = `translate(${viewer.x * 100}%,${viewer.y * 100}%) scale(${viewer.zoom})`;
    s.canvas.classList.toggle("sharp", (viewer.zoom * w) / s.image.width > 2);
    s.view.style.setProperty("--stroke", `${1.4 / viewer.zoom}px`);
    placeLabels(s);
    s.view.classList.toggle("zoomed", viewer.zoom > 1);
  }
}

/** Sets the zoom and the shift (fractions of the view), kept inside the image. */
function moveTo(zoom, x, y) {
  viewer.zoom = Math.max(1, Math.min(64, zoom));
  viewer.x = Math.min(0, Math.max(1 - viewer.zoom, x));
  viewer.y = Math.min(0, Math.max(1 - viewer.zoom, y));
  placeAll();
}
/** Zooms by a factor about a point of the view, in fractions of its size. */
function zoomBy(factor, fx = 0.5, fy = 0.5) {
  const zoom = Math.max(1, Math.min(64, viewer.zoom * factor)), ratio = zoom / viewer.zoom;
  moveTo(zoom, fx - (fx - viewer.x) * ratio, fy - (fy - viewer.y) * ratio);
}

/** Page pixel under a pointer, or null. */
function pixelAt(s, event) {
  const box = s.view.getBoundingClientRect();
  const x = Math.floor((((event.clientX - box.left) / box.width - viewer.x) / viewer.zoom) * s.image.width);
  const y = Math.floor((((event.clientY - box.top) / box.height - viewer.y) / viewer.zoom) * s.image.height);
  return x >= 0 && y >= 0 && x < s.image.width && y < s.image.height ? [x, y] : null;
}

/** The same pixel, told in every caption and marked in every view. */
function tellPixel(pixel) {
  for (const s of viewer.shown) {
    s.caption.textContent = pixel ? valueText(s, ...pixel) : figureOf(s);
    s.cross.style.display = pixel ? "" : "none";
    if (!pixel) continue;
    s.cross.style.left = `${(viewer.x + (viewer.zoom * (pixel[0] + 0.5)) / s.image.width) * 100}%`;
    s.cross.style.top = `${(viewer.y + (viewer.zoom * (pixel[1] + 0.5)) / s.image.height) * 100}%`;
  }
  const s = viewer.shown[0], place = document.getElementById("pixel");
  place.textContent = pixel ? `pixel ${s.image.x0 + pixel[0] * s.image.scale}, ${s.image.y0 + pixel[1] * s.image.scale}` : "";
}

function keyOnView(event) {
  const steps = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
  if (event.key in steps) moveTo(viewer.zoom, viewer.x + steps[event.key][0], viewer.y + steps[event.key][1]);
  else if (event.key === "+" || event.key === "=") zoomBy(1.5);
  else if (event.key === "-") zoomBy(1 / 1.5);
  else if (event.key === "0") moveTo(1, 0, 0);
  else return;
  event.preventDefault();
}

/**
 * Wheel, drag and pinch, by d3.zoom. The wheel belongs to the page until a view has been clicked (or Ctrl is held), a
 * single finger until the image is larger than its view.
 */
function connectZoom(s) {
  const wanted = () => {
    const e = d3.event;
    if (viewer.drawing || e.shiftKey) return false;
    if (e.type === "wheel") return e.ctrlKey || e.metaKey || document.activeElement === s.view;
    if (e.type === "touchstart") return e.touches.length > 1 || viewer.zoom > 1;
    return !e.button;
  };
  const extent = () => [[0, 0], [s.view.clientWidth, s.view.clientHeight]];
  const zoom = d3.zoom().filter(wanted).scaleExtent([1, 64]).extent(extent)
    .on("zoom", () => {
      const t = d3.event.transform, source = d3.event.sourceEvent;
      if (source) moveTo(t.k, t.x / s.view.clientWidth, t.y / s.view.clientHeight);
    });
  d3.select(s.view).call(zoom).on("dblclick.zoom", null);
  s.view.addEventListener("keydown", keyOnView);
  s.view.addEventListener("pointermove", (event) => tellPixel(pixelAt(s, event)));
  s.view.addEventListener("pointerleave", () => tellPixel(null));
  connectSelection(s);
}

function makeView(s, aspect) {
  s.canvas = el("canvas", { width: s.image.width, height: s.image.height });
  s.layer = el("div", { class: "layer" }, s.canvas);
  s.cross = el("div", { class: "cross", style: "display:none" });
  s.view = el("div", { class: "view", style: `aspect-ratio:${aspect}`, tabIndex: 0, role: "img",
    "aria-label": `${s.name}. Click, then the wheel zooms; plus, minus and arrow keys zoom and move all images.` }, s.layer, s.cross);
  s.caption = el("span", { class: "fig" }, figureOf(s));
  s.figure = el("figure", { class: "image" }, el("figcaption", {},
    el("span", { class: "name", title: s.name }, s.mix ? swatch(s.index) : null, s.name), s.caption), s.view);
  drawRegions(s);
  connectZoom(s);
  return s.figure;
}

async function images() {
  const box = document.getElementById("images");
  for (let i = 0; i < data.images.length; ++i)
    if (data.images[i]) viewer.shown.push({ name: run.mixes[i].mix, mix: run.mixes[i], index: i, image: await decodeImage(data.images[i]) });
  if (!viewer.shown.length) { box.append(el("p", { class: "note" }, "The images are not there.")); return; }
  viewer.reference = data.reference ? await decodeImage(data.reference) : null;
  if (viewer.reference) viewer.shown.push({ name: "reference", mix: null, index: -1, image: viewer.reference });
  viewer.exposure = goodExposure(viewer.reference || viewer.shown[0].image);
  viewer.modes = viewModes(viewer.shown, viewer.reference);
  viewer.mode = viewer.modes[0];
  const aspect = viewer.shown[0].image.width / viewer.shown[0].image.height;
  box.style.setProperty("--tile", `${viewer.shown.length < 3 ? 600 : 380}px`);
  box.append(...viewer.shown.map((s) => makeView(s, aspect)));
  viewerControls();
  new ResizeObserver(placeAll).observe(box);
  paintAll();
  placeAll();
  const scale = viewer.shown[0].image.scale;
  if (scale > 1) box.after(el("p", { class: "note" },
    `Shown at 1/${scale} of the resolution (means of ${scale} × ${scale} pixels; error and own noise are means of what single `
      + "pixels have); the EXR files have all of it."));
}
