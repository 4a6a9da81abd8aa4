// The page's head: what was run, and what must be known before any figure is believed.
function banners() {
  const lines = [];
  if (run.partial) lines.push("This run did not finish: images and figures hold what was rendered until then.");
  if (run.state === "failed") lines.push("The job failed.");
  if (!errorKind)
    lines.push("Without a reference (--reference REF.exr), and with fewer than two passes or no checkpoint, this run cannot say how large its error is.");
  else if (errorKind.estimated)
    lines.push("No reference was given, so relMSE, the floor and the relative-error images are missing. In their place stands the run's "
      + "own estimate of relMSE from the scatter of its passes: good for comparing mixes, blind to bias and to what no sample found. "
      + "For relMSE render again with --reference REF.exr.");
  const bad = run.mixes.filter((m) => m.non_finite > 0);
  for (const m of bad) lines.push(`${m.mix}: ${grouped(m.non_finite)} samples were not finite and were refused.`);
  return lines.map((line) => el("p", { class: "banner", role: "note" }, line));
}

function themeButton() {
  const button = el("button", { type: "button", class: "head-button" }, "light / dark");
  button.addEventListener("click", () => {
    const root = document.documentElement;
    const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = dark ? "light" : "dark";
  });
  return button;
}

function printButton() {
  const button = el("button", { type: "button", class: "head-button" }, "print");
  button.addEventListener("click", () => window.print());
  return button;
}

function head() {
  document.title = `${baseName(run.scene)} – Penumbra`;
  const cpu = run.mixes.reduce((sum, m) => sum + (m.cpu_seconds || 0), 0);
  const facts = [
    ["budget", budgetText(run.budget), "What ends each mix."],
    ["image", `${run.resolution[0]} × ${run.resolution[1]}`, "Pixels of the full image."],
    ["mixes", String(run.mixes.length), "mix"],
    ["wall time", seconds(run.wall_seconds), "wall"],
    ["render CPU", seconds(cpu), "cpu_seconds"],
    ["seed", String(run.seed), "seed"],
    ["version", run.version, "Version of Penumbra."],
  ];
  const rows = facts.map(([name, value, meaning]) =>
    el("div", {}, el("dt", {}, name), explained(el("dd", {}, value), meaning)));
  document.getElementById("head").append(el("div", { class: "inner" },
    el("div", { class: "head-row" },
      el("div", {}, el("h1", {}, baseName(run.scene)), el("div", { class: "path" }, run.scene)),
      el("div", { class: "head-buttons" }, themeButton(), printButton())),
    el("dl", {}, ...rows), ...banners()));
}
