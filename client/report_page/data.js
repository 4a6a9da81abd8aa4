// The page's one datum: {run, images, reference, flipbook, notes}, made by client/report_data.cpp from the run's folder.
const data = JSON.parse(document.getElementById("data").textContent);
const run = data.run;

/** The figure of error that this run has: against a reference, or else its own estimate. */
const errorKind = (() => {
  const has = (key) => run.mixes.some((m) => number(m[key]) || (m.timeline || []).some((p) => number(p[key])));
  if (has("relmse"))
    return { key: "relmse", name: "relMSE", estimated: false, meaning: "relmse" };
  if (has("estimated_relmse"))
    return { key: "estimated_relmse", name: "own estimate of relMSE", estimated: true, meaning: "estimated_relmse" };
  return null;
})();

const errorOf = (mix) => (errorKind ? mix[errorKind.key] : undefined);
const errorIntervalOf = (mix) => (errorKind ? mix[`${errorKind.key}_ci`] : undefined);

/** The mix with the least error; nothing where there is nothing to choose from. */
const bestMix = (() => {
  const measured = run.mixes.filter((m) => number(errorOf(m)));
  return measured.length > 1 ? measured.reduce((a, b) => (errorOf(b) < errorOf(a) ? b : a)) : null;
})();

/**
 * 95 % interval of the ratio of two mixes' errors. Mixes share no samples and both intervals are symmetric in the logarithm
 * (film/metrics.h), so their half widths add in squares there. Null without both. Those of the run's own estimate are about
 * the picture's blocks, which all mixes share, and not about seeds: of them nothing can be made here.
 */
function ratioInterval(mix, other) {
  if (!errorKind || errorKind.estimated) return null;
  const half = (ci) => (Array.isArray(ci) && ci[0] > 0 && number(ci[1]) ? Math.log(ci[1] / ci[0]) / 2 : NaN);
  const width = Math.hypot(half(errorIntervalOf(mix)), half(errorIntervalOf(other)));
  const ratio = errorOf(mix) / errorOf(other);
  return number(width) && ratio > 0 ? [ratio * Math.exp(-width), ratio * Math.exp(width)] : null;
}

/** The relMSE that a perfect image would show against this reference. */
const referenceFloor = (() => {
  const floors = run.mixes.map((m) => m.reference_floor).filter((v) => number(v) && v > 0);
  return floors.length ? floors[0] : null;
})();
