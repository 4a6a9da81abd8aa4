// What each mix reached.
function cell(value, meaning, ci) {
  return explained(el("td", {}, value, ci ? el("span", { class: "ci" }, ci) : null), meaning);
}
function mixCell(m, i) {
  return el("td", { class: "mix" }, el("span", { class: "mix-name" }, swatch(i), m.mix),
    m === bestMix ? el("span", { class: "badge" }, "least error") : null);
}
/** A column's head; it can be reached by keyboard and tells its meaning. */
function headCell([name, meaning]) {
  const node = el("th", { scope: "col" }, meaning ? el("span", { class: "explained", tabIndex: 0 }, name) : name);
  if (meaning) explained(node.firstChild, meaning);
  return node;
}
/** rows: arrays of td; the first names the row. */
function table(columns, rows, best = -1) {
  return el("div", { class: "scroll", tabIndex: 0, role: "region", "aria-label": "table" }, el("table", {},
    el("thead", {}, el("tr", {}, ...columns.map(headCell))),
    el("tbody", {}, ...rows.map((cells, i) => el("tr", i === best ? { class: "best" } : {}, ...cells)))));
}

/** Error over the least error. */
function timesLeast(m) {
  if (!bestMix || !number(errorOf(m))) return "–";
  return m === bestMix ? "1" : significant(errorOf(m) / errorOf(bestMix));
}

function mixTable() {
  const withReference = errorKind && !errorKind.estimated;
  const rate = (count, m) => (count && m.cpu_seconds > 0 ? significant(count / m.cpu_seconds) : "–");
  const columns = [
    ["mix", "mix", null],
    ["passes", "passes", (m) => grouped(m.passes)],
    ["CPU s", "cpu_seconds", (m) => significant(m.cpu_seconds, 4)],
    ["spent / budget", "budget_ratio", (m) => (number(m.budget_ratio) ? m.budget_ratio.toFixed(3) : "–")],
    errorKind ? [errorKind.estimated ? "own estimate of relMSE" : "relMSE", errorKind.meaning, (m) => significant(errorOf(m)), errorIntervalOf] : null,
    errorKind ? ["× least", "ratio", timesLeast, (m) => (m === bestMix || !bestMix ? null : ratioInterval(m, bestMix))] : null,
    withReference ? ["trimmed", "trimmed_relmse", (m) => significant(m.trimmed_relmse)] : null,
    withReference ? ["floor", "reference_floor", (m) => significant(m.reference_floor, 2)] : null,
    withReference && run.mixes.some((m) => number(m.estimated_relmse)) ? ["own estimate", "estimated_relmse", (m) => significant(m.estimated_relmse)] : null,
    errorKind ? ["error × s", "efficiency", (m) => (number(errorOf(m)) ? significant(errorOf(m) * m.cpu_seconds) : "–")] : null,
    ["rays / s", "rays", (m) => rate(m.rays, m)],
    ["lines / s", "line_queries", (m) => rate(m.line_queries, m)],
  ].filter(Boolean);
  const rows = run.mixes.map((m, i) => columns.map(([name, meaning, value, ci]) => {
    if (!value) return mixCell(m, i);
    return cell(value(m), meaning, ci ? interval(ci(m)) : null);
  }));
  const box = document.getElementById("table");
  box.append(table(columns, rows, run.mixes.indexOf(bestMix)));
  const substituted = run.mixes.flatMap((m) => (m.substitutions || []).map((s) => `${m.mix}: ${s}`));
  if (substituted.length) box.append(el("h3", {}, "Strategies that do not fit every light"),
    el("ul", { class: "plain" }, ...substituted.map((s) => el("li", {}, s))));
  document.getElementById("table-tools").append(
    saveButton("CSV", fileName("mixes", "csv"), "text/csv", () => csvText(mixRows())),
    saveButton("LaTeX", fileName("mixes", "tex"), "application/x-tex", latexTable));
}
