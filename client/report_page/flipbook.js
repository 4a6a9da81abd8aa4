// When light arrives: the bins of path length, one after the other.
const flipbook = { bin: 0, timer: null, views: [] };

function flipTo(bin) {
  const book = data.flipbook, edge = (b) => book.t0 + ((book.t1 - book.t0) * b) / book.bins;
  flipbook.bin = bin;
  document.getElementById("bin").value = bin;
  document.getElementById("bin-value").textContent =
    `bin ${bin} of ${book.bins}: path length ${significant(edge(bin), 4)} to ${significant(edge(bin + 1), 4)}`;
  for (const { image, frames } of flipbook.views) image.src = `data:image/png;base64,${frames[bin]}`;
}

function flipPlay(playing) {
  clearInterval(flipbook.timer);
  flipbook.timer = playing ? setInterval(() => flipTo((flipbook.bin + 1) % data.flipbook.bins), 100) : null;
  const button = document.getElementById("flip");
  button.textContent = playing ? "pause" : "play";
  button.setAttribute("aria-pressed", String(playing));
}

function flipBook() {
  const book = data.flipbook;
  if (!book) { document.getElementById("flip-section").remove(); return; }
  const slider = el("input", { type: "range", id: "bin", min: 0, max: book.bins - 1, step: 1, value: 0 });
  const button = el("button", { type: "button", class: "plain", id: "flip", "aria-pressed": "false" }, "play");
  slider.addEventListener("input", () => { flipPlay(false); flipTo(+slider.value); });
  button.addEventListener("click", () => flipPlay(flipbook.timer === null));
  const figures = book.mixes.map((mix, i) => {
    if (!mix) return null;
    const image = el("img", { width: book.width, height: book.height, alt: `${run.mixes[i].mix}: light that arrives in the chosen bin` });
    flipbook.views.push({ image, frames: mix.frames });
    return el("figure", { class: "image" }, el("figcaption", {}, el("span", { class: "name", title: run.mixes[i].mix }, swatch(i), run.mixes[i].mix)), image);
  });
  document.getElementById("flips").append(...figures.filter(Boolean));
  document.getElementById("flip-controls").append(button,
    el("span", { class: "slider" }, el("label", { htmlFor: "bin" }, "bin"), slider, el("output", { id: "bin-value" })));
  document.getElementById("flips").after(el("p", { class: "note" },
    "Light by the length of its path from the camera, in scene units; all pictures have one exposure."
    + (book.scale > 1 ? ` Shown at 1/${book.scale} of the resolution; the EXR files have all of it, in parts of their own.` : "")));
  flipTo(0);
}
