// Two images in one place, left and right of a line that can be moved.
const split = { on: false, left: null, right: null, at: 0.5 };

/** Lays the chosen two over one another, the right one cut at the line. */
function placeSplit() {
  const box = document.getElementById("images");
  box.classList.toggle("split", split.on);
  for (const s of viewer.shown) {
    const used = split.on && (s === split.left || s === split.right);
    s.figure.classList.toggle("unused", split.on && !used);
    s.figure.classList.toggle("over", split.on && s === split.right && split.right !== split.left);
    s.view.style.clipPath = split.on && s === split.right && split.right !== split.left ? `inset(0 0 0 ${100 * split.at}%)` : "";
  }
  const line = document.getElementById("split-line");
  if (line) {
    line.hidden = !split.on;
    if (split.on) {
      line.style.left = `${100 * split.at}%`;
      line.setAttribute("aria-valuenow", String(Math.round(100 * split.at)));
    }
  }
  placeAll();
}

function splitLine() {
  const line = el("div", { id: "split-line", tabIndex: 0, role: "slider", "aria-label": "where the images are split",
    "aria-valuemin": "0", "aria-valuemax": "100", hidden: true }, el("span", { class: "grip", "aria-hidden": "true" }, "⇔"));
  const moveLine = (at) => { split.at = Math.max(0, Math.min(1, at)); placeSplit(); };
  line.addEventListener("pointerdown", (event) => { line.setPointerCapture(event.pointerId); event.preventDefault(); line.focus(); });
  line.addEventListener("pointermove", (event) => {
    if (!line.hasPointerCapture(event.pointerId)) return;
    const box = document.getElementById("images").getBoundingClientRect();
    moveLine((event.clientX - box.left) / box.width);
  });
  line.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
    if (step) { moveLine(split.at + step); event.preventDefault(); }
  });
  return line;
}

function splitControls() {
  const choice = (side, label) => {
    const select = el("select", { "aria-label": label, id: `split-${side}` }, ...viewer.shown.map((s, i) => el("option", { value: i }, s.name)));
    select.value = String(viewer.shown.indexOf(split[side]));
    select.addEventListener("change", () => { split[side] = viewer.shown[+select.value]; placeSplit(); });
    return select;
  };
  split.left = viewer.shown[0];
  split.right = viewer.shown[viewer.shown.length - 1];
  const selects = el("span", { class: "slider", hidden: true }, choice("left", "left image"), "|", choice("right", "right image"));
  document.getElementById("images").append(splitLine());
  return {
    selects,
    show: (on) => {
      split.on = on;
      selects.hidden = !on;
      placeSplit();
    },
  };
}
