// Draws the page: figures first, images as they are unpacked.

/** Intervals of error ratios, from the images: possible at full resolution, with a reference. */
function ratiosFromImages() {
  if (!bestMix || errorKind.estimated || !viewer.reference || viewer.reference.scale > 1) return;
  const sums = new Map(viewer.shown.filter((s) => s.mix).map((s) => [s.index, blockSums(s.image, errorPlane(s.image, viewer.reference))]));
  fillRatios(document.getElementById("table"), (i, best) => (sums.has(i) && sums.has(best) ? pairedInterval(sums.get(i), sums.get(best)) : null));
}

head();
mixTable();
errorChart();
flipBook();
regionTable();
tiles();
budget();
workerTable();
theRun();
images().then(() => {
  document.body.setAttribute("data-ready", "");
  setTimeout(ratiosFromImages, 0);
}, (fault) => {
  document.getElementById("images").append(el("p", { class: "note" }, `The images cannot be shown: ${fault.message}`));
});
