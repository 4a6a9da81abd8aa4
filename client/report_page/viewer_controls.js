// What is looked at and how: mode, exposure, grid or split, regions.
function switchOf(label, choices, value, choose) {
  const buttons = choices.map(([name, text, meaning]) => {
    const b = el("button", { type: "button", "aria-pressed": String(name === value), "data-choice": name }, text);
    if (meaning) explained(b, meaning);
    b.addEventListener("click", () => {
      buttons.forEach((other) => other.setAttribute("aria-pressed", String(other === b)));
      choose(name);
    });
    return b;
  });
  return el("span", { class: "switch", role: "group", "aria-label": label }, ...buttons);
}

function exposureControl() {
  const stops = el("output", { id: "exposure-value" });
  const slider = el("input", { type: "range", id: "exposure", min: -12, max: 12, step: 0.25, value: viewer.exposure });
  const tell = () => { stops.textContent = `${viewer.exposure > 0 ? "+" : ""}${viewer.exposure} EV`; };
  slider.addEventListener("input", () => { viewer.exposure = +slider.value; tell(); paintAll(); });
  tell();
  return el("span", { class: "slider" }, el("label", { htmlFor: "exposure" }, "exposure"), slider, stops);
}

function zoomButtons() {
  const button = (text, label, act) => {
    const b = el("button", { type: "button", class: "plain", "aria-label": label }, text);
    b.addEventListener("click", act);
    return b;
  };
  return el("span", { class: "buttons" }, button("−", "zoom out", () => zoomBy(1 / 1.5)), button("+", "zoom in", () => zoomBy(1.5)),
    button("whole image", "whole image", () => moveTo(1, 0, 0)));
}

function viewerControls() {
  const legend = el("div", { class: "legend" });
  const tellMode = () => {
    legend.replaceChildren(...(viewer.mode.plane ? scaleLegend(viewer.mode) : []),
      el("span", { class: "legend-text" }, viewer.mode.meaning));
  };
  const modes = switchOf("what the images show", viewer.modes.map((m) => [m.name, m.label, m.meaning]), viewer.mode.name, (name) => {
    viewer.mode = viewer.modes.find((m) => m.name === name);
    tellMode();
    paintAll();
    tellPixel(null);
  });
  modes.id = "modes";
  const split = splitControls();
  const layout = switchOf("layout", [["grid", "side by side"], ["split", "split"]], "grid", (name) => split.show(name === "split"));
  layout.id = "layout";
  document.getElementById("controls").append(modes, exposureControl(), viewer.shown.length > 1 ? layout : "", split.selects,
    zoomButtons(), regionControls(), el("output", { id: "pixel" }));
  document.getElementById("images").before(legend);
  document.getElementById("images").after(el("p", { class: "note screen-only" },
    "All images move together. Click one, then the wheel zooms and dragging moves (Ctrl + wheel without clicking; two fingers on a touch "
    + "screen; + − 0 and arrow keys). The captions tell every image's value at the pixel under the pointer."));
  tellMode();
}
