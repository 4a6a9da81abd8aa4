// Draws the page: figures first, images as they are unpacked.

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
}, (fault) => {
  document.getElementById("images").append(el("p", { class: "note" }, `The images cannot be shown: ${fault.message}`));
});
