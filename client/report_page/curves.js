// Error against time as a function: what it is at a time, and when it reaches a value.
// Between measured points a curve is straight in log-log. Past the last one it goes on as
// floor + (e - floor)·t_last/t: variance falls as 1/t, the reference's own noise does not.

/**
 * [{t, passes, e, lo, hi}], ascending in t, of a mix's timeline; lo and hi are null without an interval. Boundaries are
 * common to all mixes, so a slow one may have two with the same passes: one is enough.
 */
function curveOf(mix, kind = errorKind) {
  if (!kind) return [];
  return (mix.timeline || [])
    .filter((p, i, all) => number(p[kind.key]) && p[kind.key] > 0 && p.cpu_seconds > 0 && !(i && all[i - 1].passes === p.passes))
    .map((p, i, all) => {
      const ci = p[`${kind.key}_ci`] || (i === all.length - 1 ? mix[`${kind.key}_ci`] : null);
      const known = Array.isArray(ci) && ci[0] > 0;
      return { t: p.cpu_seconds, passes: p.passes, e: p[kind.key], lo: known ? ci[0] : null, hi: known ? ci[1] : null };
    });
}

const logMix = (a, b, w) => Math.exp((1 - w) * Math.log(a) + w * Math.log(b));

/** One edge of the curve at t: {value, how}; how is "measured", "extrapolated" or "none". */
function edgeAt(curve, edge, t, floor) {
  const points = curve.filter((p) => number(p[edge]));
  if (!points.length || t < points[0].t) return { value: null, how: "none" };
  const last = points[points.length - 1];
  if (t > last.t) {
    const base = floor && floor < last[edge] ? floor : 0;
    return { value: base + ((last[edge] - base) * last.t) / t, how: "extrapolated" };
  }
  const i = Math.max(1, points.findIndex((p) => p.t >= t));
  if (points.length === 1) return { value: last[edge], how: "measured" };
  const a = points[i - 1], b = points[i];
  return { value: logMix(a[edge], b[edge], Math.log(t / a.t) / Math.log(b.t / a.t)), how: "measured" };
}

/** {value, lo, hi, how} at t CPU seconds. */
function errorAt(curve, t, floor = 0) {
  const mid = edgeAt(curve, "e", t, floor);
  return { ...mid, lo: edgeAt(curve, "lo", t, floor).value, hi: edgeAt(curve, "hi", t, floor).value };
}

/** When one edge first falls to `error`: {value, how}. */
function edgeReaches(curve, edge, error, floor) {
  const points = curve.filter((p) => number(p[edge]));
  if (!points.length) return { value: null, how: "none" };
  if (points[0][edge] <= error) return { value: points[0].t, how: points[0][edge] === error ? "measured" : "before" };
  for (let i = 1; i < points.length; ++i) {
    const a = points[i - 1], b = points[i];
    if (b[edge] > error) continue;
    return { value: logMix(a.t, b.t, Math.log(error / a[edge]) / Math.log(b[edge] / a[edge])), how: "measured" };
  }
  const last = points[points.length - 1], base = floor && floor < last[edge] ? floor : 0;
  if (error <= base) return { value: null, how: "below the floor" };
  return { value: (last.t * (last[edge] - base)) / (error - base), how: "extrapolated" };
}

/** {value, lo, hi, how}: CPU seconds until the curve first falls to `error`; "before": earlier than the first point. */
function timeTo(curve, error, floor = 0) {
  const mid = edgeReaches(curve, "e", error, floor);
  if (curve.filter((p) => number(p.lo)).length < 2) return { ...mid, lo: null, hi: null };  // a bar is no band
  return { ...mid, lo: edgeReaches(curve, "lo", error, floor).value, hi: edgeReaches(curve, "hi", error, floor).value };
}

/**
 * How much sooner `mine` is there than `base`, both from timeTo(): {value, bound, how}. A curve that begins below the error
 * gives only a latest time, so the ratio is at least ("≥ ") or at most ("≤ ") this, and of two such nothing is known.
 */
function speedUp(base, mine) {
  const early = (time) => time.how === "before";
  if (!number(base.value) || !number(mine.value) || (early(base) && early(mine))) return { value: null, bound: "", how: "none" };
  return { value: base.value / mine.value, bound: early(mine) ? "≥ " : early(base) ? "≤ " : "",
    how: base.how === "extrapolated" || mine.how === "extrapolated" ? "extrapolated" : "measured" };
}
