// Figures and tables for papers: SVG with its styles inside, CSV, LaTeX.
function download(name, type, text) {
  const link = el("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
const fileName = (what, ending) => `${baseName(run.scene)}-${what}.${ending}`;

const paintedProperties = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-opacity", "stroke-dasharray", "stroke-linejoin",
  "font-family", "font-size", "font-weight", "text-anchor"];

/** Writes at `to` what the page's styles make of `from`, as far as it does not inherit it in the file. */
function inlineStyle(from, to) {
  const style = getComputedStyle(from), inherited = from.nodeName === "svg" ? null : getComputedStyle(from.parentNode);
  to.removeAttribute("style");
  for (const property of paintedProperties) {
    to.removeAttribute(property);
    const value = style.getPropertyValue(property);
    if (!inherited || value !== inherited.getPropertyValue(property)) to.setAttribute(property, value.replace(/"/g, "'"));
  }
  if (style.opacity === "1") to.removeAttribute("opacity");
}

/** The figure as a file of its own: in the colours of paper, every style written at its element. */
function svgText(svg) {
  const root = document.documentElement, theme = root.dataset.theme;
  root.dataset.theme = "light";
  const copy = svg.cloneNode(true), copies = [copy, ...copy.querySelectorAll("*")];
  [svg, ...svg.querySelectorAll("*")].forEach((node, i) => inlineStyle(node, copies[i]));
  if (theme) root.dataset.theme = theme; else delete root.dataset.theme;
  copy.querySelectorAll(".screen-only").forEach((node) => node.remove());
  copies.forEach((node) => { for (const name of ["class", "role", "aria-label"]) node.removeAttribute(name); });
  const [, , width, height] = svg.getAttribute("viewBox").split(/[ ,]+/);
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  copy.setAttribute("width", width);
  copy.setAttribute("height", height);
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(copy)}\n`;
}

const csvCell = (v) => {
  const text = v === null || v === undefined ? "" : String(v);
  return /[",\n\r]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
};
/** RFC 4180, one row per array. */
const csvText = (rows) => rows.map((row) => row.map(csvCell).join(",") + "\r\n").join("");

/** One row per mix: the figures of run.json, unrounded. */
function mixRows() {
  const regions = [...new Set(run.mixes.flatMap((m) => Object.keys(m.regions || {})))];
  const figure = (v) => (number(v) ? v : null);
  const ci = (v) => (Array.isArray(v) ? v : [null, null]);
  const head = ["mix", "passes", "cpu_seconds", "budget_ratio", "pilot_cpu_seconds", "relmse", "relmse_ci_low", "relmse_ci_high",
    "trimmed_relmse", "mse", "reference_floor", "estimated_relmse", "rays", "line_queries",
    ...regions.flatMap((r) => [`relmse[${r}]`, `relmse_ci_low[${r}]`, `relmse_ci_high[${r}]`])];
  return [head, ...run.mixes.map((m) => [m.mix, m.passes, figure(m.cpu_seconds), figure(m.budget_ratio), figure(m.pilot_cpu_seconds),
    figure(m.relmse), ...ci(m.relmse_ci), figure(m.trimmed_relmse), figure(m.mse), figure(m.reference_floor), figure(m.estimated_relmse),
    m.rays, m.line_queries, ...regions.flatMap((r) => {
      const at = (m.regions || {})[r] || {};
      return [figure(at.relmse), ...ci(at.relmse_ci)];
    })])];
}
/** One row per point of every curve. */
function timelineRows() {
  const head = ["mix", "passes", "cpu_seconds", "relmse", "relmse_ci_low", "relmse_ci_high", "estimated_relmse"];
  return [head, ...run.mixes.flatMap((m) => (m.timeline || []).map((p) =>
    [m.mix, p.passes, p.cpu_seconds, p.relmse, ...(p.relmse_ci || [null, null]), p.estimated_relmse]))];
}

const latexEscapes = { "\\": "\\textbackslash{}", "&": "\\&", "%": "\\%", "$": "\\$", "#": "\\#", "_": "\\_", "{": "\\{", "}": "\\}",
  "~": "\\textasciitilde{}", "^": "\\textasciicircum{}" };
const latexText = (text) => String(text).replace(/[\\&%$#_{}~^]/g, (c) => latexEscapes[c]);
/** $1.23 \times 10^{-4}$ */
function latexNumber(v, digits = 3) {
  if (!number(v)) return "--";
  if (v === 0) return "$0$";
  const exponent = Math.floor(Math.log10(Math.abs(v)));
  if (exponent >= -2 && exponent < 4) return `$${+v.toPrecision(digits)}$`;
  const [mantissa, power] = v.toExponential(digits - 1).split("e");
  return `$${mantissa} \\times 10^{${+power}}$`;
}

/** A table of booktabs; the least error is bold. */
function latexTable() {
  const regions = [...new Set(run.mixes.flatMap((m) => Object.keys(m.regions || {})))];
  const name = errorKind && errorKind.estimated ? "relMSE (estimated)" : "relMSE";
  const head = ["Mix", "Passes", "CPU s", name, "95\\,\\% interval", ...regions.map((r) => latexText(r))];
  const rows = run.mixes.map((m) => {
    const e = errorOf(m), ci = errorIntervalOf(m), value = latexNumber(e);
    const bold = m === bestMix ? `\\textbf{${value.replace(/^\$(.*)\$$/, "$\\boldsymbol{$1}$")}}` : value;
    return [`\\texttt{${latexText(m.mix)}}`, latexNumber(m.passes, 6), latexNumber(m.cpu_seconds, 4), bold,
      Array.isArray(ci) ? `[${latexNumber(ci[0])}, ${latexNumber(ci[1])}]` : "--",
      ...regions.map((r) => latexNumber(((m.regions || {})[r] || {}).relmse))].join(" & ");
  });
  const behind = errorKind && errorKind.estimated ? "from resampled $16 \\times 16$ blocks"
    : "for other seeds, from the scatter within cells of $2 \\times 2$ pixels";
  return [
    "% Needs \\usepackage{booktabs,amsmath}. Made by Penumbra's report.html from run.json.",
    "\\begin{table}", "  \\centering",
    `  \\caption{${latexText(baseName(run.scene))}, ${run.resolution[0]}$\\times$${run.resolution[1]}, ${latexText(budgetText(run.budget))}.`
      + ` relMSE with $\\varepsilon = 10^{-2}$; intervals ${behind}.}`,
    `  \\begin{tabular}{l${"r".repeat(head.length - 1)}}`, "    \\toprule", `    ${head.join(" & ")} \\\\`, "    \\midrule",
    ...rows.map((row) => `    ${row} \\\\`), "    \\bottomrule", "  \\end{tabular}", "\\end{table}", ""].join("\n");
}

/** A button that saves what `make` returns. */
function saveButton(label, name, type, make) {
  const button = el("button", { type: "button", class: "plain save" }, label);
  button.addEventListener("click", () => download(name, type, make()));
  return button;
}
const svgButton = (box, what) => saveButton("SVG", fileName(what, "svg"), "image/svg+xml", () => svgText(box.querySelector("svg")));
