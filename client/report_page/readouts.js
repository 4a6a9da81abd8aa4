// Move a slider, read both: the error at a chosen time, and the time to a chosen error.

/** A slider over [low, high] on a logarithmic scale. */
function logSlider(id, label, [low, high], value, show, chosenNow) {
  const steps = 400, at = (step) => low * (high / low) ** (step / steps);
  const step = (v) => Math.round((steps * Math.log(v / low)) / Math.log(high / low));
  const text = el("output", { id: `${id}-value`, htmlFor: id }, show(value));
  const input = el("input", { type: "range", id, min: 0, max: steps, step: 1, value: step(value) });
  const tell = (v) => { text.textContent = show(v); input.setAttribute("aria-valuetext", show(v)); };
  input.addEventListener("input", () => { const v = at(+input.value); tell(v); chosenNow(v); });
  tell(value);
  return el("div", { class: "slider" }, el("label", { htmlFor: id }, label), input, text);
}

const howTold = { extrapolated: "≈ ", before: "≤ " };
function readCell(read, show, meaning) {
  if (read.how === "below the floor") return cell("never: below the floor", "reference_floor");
  const range = number(read.lo) && number(read.hi) ? `[${show(Math.min(read.lo, read.hi))}, ${show(Math.max(read.lo, read.hi))}]` : null;
  const node = cell(`${howTold[read.how] || ""}${number(read.value) ? show(read.value) : "–"}`,
    read.how === "extrapolated" ? "extrapolated" : meaning, range);
  if (read.how === "extrapolated") node.classList.add("extrapolated");
  return node;
}

function speedUpCell(base, mine) {
  const { value, bound, how } = speedUp(base, mine), guessed = how === "extrapolated";
  const node = cell(number(value) ? `${bound}${guessed ? howTold.extrapolated : ""}${significant(value)}×` : "–", "speedup");
  if (guessed) node.classList.add("extrapolated");
  return node;
}

function readoutTable() {
  const floor = errorKind.estimated ? 0 : referenceFloor || 0;
  const base = series.find((s) => s.index === chosen.compared) || series[0];
  const baseTime = timeTo(base.points, chosen.error, floor);
  const columns = [["mix", "mix"], [`${errorKind.estimated ? "own estimate" : "relMSE"} at ${seconds(chosen.time)}`, "error_at"],
    [`CPU s to ${significant(chosen.error)}`, "time_to"], ["speed-up", "speedup"]];
  const rows = series.map((s) => {
    const time = timeTo(s.points, chosen.error, floor);
    return [mixCell(s.mix, s.index), readCell(errorAt(s.points, chosen.time, floor), (v) => significant(v), "error_at"),
      readCell(time, (v) => significant(v), "time_to"),
      speedUpCell(baseTime, time)];
  });
  return table(columns, rows);
}

function readouts(section, redrawChart) {
  const [t0, t1] = errorDomain.times, [e0, e1] = errorDomain.errors;
  const last = series.map((s) => s.points[s.points.length - 1]);
  chosen.time = d3.median(last, (p) => p.t);
  chosen.error = d3.median(last, (p) => p.e);
  chosen.compared = series[0].index;
  const box = el("div", { id: "readout-table" });
  const tell = () => { box.replaceChildren(readoutTable()); redrawChart(); };
  const select = el("select", { id: "compared" }, ...series.map((s) => el("option", { value: s.index }, s.mix.mix)));
  select.addEventListener("change", () => { chosen.compared = +select.value; tell(); });
  section.append(el("div", { class: "readouts" }, el("div", { class: "sliders" },
    logSlider("time", "error at this time", [t0, 4 * t1], chosen.time, (v) => seconds(v), (v) => { chosen.time = v; tell(); }),
    logSlider("error", "time to this error", [e0 / 2, e1], chosen.error, (v) => significant(v), (v) => { chosen.error = v; tell(); }),
    el("div", { class: "slider" }, el("label", { htmlFor: "compared" }, "speed-up over"), select)), box));
  tell();
}
