// Regions: those the run was asked about, and one drawn on the page. Drawn over every image, and tabulated.
const regionNames = [...new Set(run.mixes.flatMap((m) => Object.keys(m.regions || {})))];
/** Without a reference a run has no figures of the regions it was asked about; where they are, its spec says. */
const regionRects = { ...(run.spec || {}).regions, ...Object.fromEntries(regionNames.map((name) =>
  [name, (run.mixes.find((m) => (m.regions || {})[name]).regions[name] || {}).rect])) };

function drawRect(s, [x0, y0, x1, y1], name, css) {
  const at = (v, origin) => (v - origin) / s.image.scale;
  s.overlay.append("g").attr("class", css).append("rect").attr("x", at(x0, s.image.x0)).attr("y", at(y0, s.image.y0))
    .attr("width", (x1 - x0) / s.image.scale).attr("height", (y1 - y0) / s.image.scale);
  const node = el("span", { class: `region-name ${css}` }, name);
  s.view.append(node);
  s.labels.push({ node, x: at(x0, s.image.x0) / s.image.width, y: at(y0, s.image.y0) / s.image.height });
}

/** Names stand beside the layer that is zoomed, so that they keep their size. */
function placeLabels(s) {
  for (const { node, x, y } of s.labels) {
    node.style.left = `${100 * (viewer.x + viewer.zoom * x)}%`;
    node.style.top = `${100 * (viewer.y + viewer.zoom * y)}%`;
  }
}

function drawRegions(s) {
  if (!s.overlay)
    s.overlay = d3.select(s.layer).append("svg").attr("class", "overlay").attr("preserveAspectRatio", "none").attr("aria-hidden", "true")
      .attr("viewBox", `0 0 ${s.image.width} ${s.image.height}`);
  s.overlay.selectAll("*").remove();
  for (const { node } of s.labels || []) node.remove();
  s.labels = [];
  for (const [name, rect] of Object.entries(regionRects)) if (rect) drawRect(s, rect, name, "named");
  if (viewer.selection) drawRect(s, viewer.selection, "drawn", "drawn");
  placeLabels(s);
}

/** Shift + drag (or the button, then a drag) draws a region. */
function connectSelection(s) {
  let start = null;
  // The last pixels of an image shown smaller may stand for fewer than the others.
  const corner = ([x, y], far) => [Math.min(s.image.x1, s.image.x0 + (x + far) * s.image.scale),
    Math.min(s.image.y1, s.image.y0 + (y + far) * s.image.scale)];
  s.view.addEventListener("pointerdown", (event) => {
    if (!viewer.drawing && !event.shiftKey) return;
    start = pixelAt(s, event);
    if (start) s.view.setPointerCapture(event.pointerId);
  });
  s.view.addEventListener("pointermove", (event) => {
    const end = start && pixelAt(s, event);
    if (!end) return;
    const low = [Math.min(start[0], end[0]), Math.min(start[1], end[1])], high = [Math.max(start[0], end[0]), Math.max(start[1], end[1])];
    viewer.selection = [...corner(low, 0), ...corner(high, 1)];
    viewer.shown.forEach(drawRegions);
  });
  s.view.addEventListener("pointerup", () => {
    if (!start) return;
    start = null;
    endDrawing();
    regionTable();
  });
}

let endDrawing = () => {};
function regionControls() {
  const button = el("button", { type: "button", class: "plain", id: "draw-region", "aria-pressed": "false" }, "draw a region");
  explained(button, "The next drag over an image marks a region; the table of regions then has its error for every mix. Shift + drag does the same.");
  const set = (on) => {
    viewer.drawing = on;
    button.setAttribute("aria-pressed", String(on));
    document.getElementById("images").classList.toggle("drawing", on);
  };
  button.addEventListener("click", () => set(!viewer.drawing));
  endDrawing = () => set(false);
  return button;
}

/** What the drawn region has: relMSE by the page's own planes, or else the mean of the own noise. */
function selectionValue(i) {
  const s = viewer.shown.find((one) => one.index === i);
  if (!s) return null;
  const plane = viewer.reference ? errorPlane(s.image, viewer.reference) : s.image.noise;
  return plane ? meanOver(s.image, plane, viewer.selection) : null;
}

function regionTable() {
  const box = document.getElementById("regions");
  const unknown = Object.keys(regionRects).filter((name) => !regionNames.includes(name));
  const notes = unknown.length ? [el("p", { class: "note", id: "regions-unknown" },
    `Asked for: ${unknown.join(", ")}. The error of regions needs a reference: render again with --reference REF.exr.`)] : [];
  if (!regionNames.length && !viewer.selection) {
    box.replaceChildren(...notes, el("p", { class: "note" }, notes.length ? "Draw one over an image to see what the run expects of its error."
      : "None was asked for (--region NAME=X0,Y0,X1,Y1). Draw one over an image to see its error."));
    return;
  }
  const columns = [["mix", "mix"], ...regionNames.map((n) => [n, `${meanings.region} Pixels ${(regionRects[n] || []).join(",")}.`]),
    ...(viewer.selection ? [["drawn", meanings.selection]] : [])];
  const rows = run.mixes.map((m, i) => [mixCell(m, i), ...regionNames.map((n) => {
    const r = (m.regions || {})[n];
    return r ? cell(significant(r.relmse), "region", interval(r.relmse_ci)) : cell("–");
  }), ...(viewer.selection ? [cell(significant(selectionValue(i)), "selection")] : [])]);
  box.replaceChildren(...notes, table(columns, rows));
  if (viewer.selection) box.append(el("p", { class: "note", id: "selection-flag" }, "The drawn region as an option: ",
    el("code", {}, `--region drawn=${viewer.selection.join(",")}`)));
}
