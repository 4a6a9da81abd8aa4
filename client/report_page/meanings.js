// What every number on the page means; shown on hover, on focus and to screen readers.
const meanings = {
  mix: "Light samples per strategy and shading point, and how they are combined. Strategies: bsdf (the material's lobe), "
    + "area (uniform on the light), sa (uniform in its solid angle), line-… (a chord of the light, its exactly visible part, a point on that).",
  passes: "Camera samples in every pixel (of auto: their mean over the pixels). A pilot whose samples are discarded turns the budget into this count before the run begins.",
  cpu_seconds: "Thread CPU seconds of the tile loop, summed over all cores and tiles. Loading the scene and building it are counted apart.",
  budget_ratio: "CPU seconds spent over the CPU seconds asked for. 1 is exact; passes are whole, so half a pass is the least that can be missed.",
  pilot: "CPU seconds of the pilot, which measures the cost of a pass. Its samples are discarded. For fixed mixes it is not part of CPU s; for auto it is.",
  relmse: "Relative mean squared error: mean over pixels and channels of (I−R)²/(R²+0.01), I the image, R the reference. Raw: the reference's floor is not subtracted.",
  relmse_ci: "95 % interval: what relMSE other seeds would give. From the scatter of the errors within cells of 2×2 pixels, which share no samples.",
  estimated_relmse: "What relMSE the run itself expects, for want of a reference: mean over pixels and channels of v/(S²+0.01), v the variance of the mean between "
    + "independent groups of passes, S the image averaged over 5×5 pixels. Blind to bias and to bright paths that no sample found. Its interval, from resampled 16×16 blocks, "
    + "counts how unevenly the error lies in the picture too.",
  trimmed_relmse: "relMSE without the worst 0.1 % of pixels: the error without its fireflies.",
  mse: "Mean squared error: mean over pixels and channels of (I−R)².",
  reference_floor: "The relMSE that a perfect image would show, because the reference itself is noisy: mean of s²/(R²+0.01), s its standard error.",
  efficiency: "Error times CPU seconds: less is better. Constant in time for an estimator whose error falls as 1/t.",
  ratio: "Error of this mix over that of the best. With a reference its 95 % interval: what ratio other seeds would give. Mixes share no samples, "
    + "so the intervals of both errors add, in squares and on a logarithmic scale. 1 inside it: this run cannot tell which of the two is better.",
  rays: "Camera, specular and shadow rays per CPU second.",
  line_queries: "Exact visible-interval queries per CPU second.",
  non_finite: "Samples that were not finite numbers and were refused at the film's door. Any is a fault of the renderer.",
  error_at: "The error at the chosen time, read off the curve (straight between measured points on both logarithmic axes), with its 95 % band.",
  time_to: "CPU seconds until the curve first falls to the chosen error. The range is where the 95 % band's two edges do.",
  extrapolated: "Beyond the last measured point: continued as 1/t above the reference's floor, as the error of an unbiased estimator falls. Not measured.",
  speedup: "Time to the chosen error of the mix compared with, over this mix's: 2× is twice as fast. ≥ or ≤: the first measured point of one of the two "
    + "is below that error already, so its time is a bound (of both: nothing is known). ≈: the time of one is extrapolated, not measured.",
  wall: "From submission to the last result, on the wall clock.",
  render_wall: "From the first leased tile to the last result, on the wall clock.",
  first_result: "From submission to the first accepted tile.",
  parse: "Reading and checking the scene's files, on the worker that took longest.",
  build: "Building meshes, trees and lights, on the worker that took longest.",
  busy: "CPU seconds of the workers' processes over cores × rendering time.",
  server_cpu: "CPU seconds of the coordinator during this job.",
  retries: "Leases that were given out again because a worker fell silent or failed. Results count once.",
  tiles: "Tiles of which this worker did at least one task.",
  share: "Part of all the run's rendering CPU seconds.",
  isa: "Widest vector instructions the worker used.",
  seed: "Random numbers are keyed by it: the same seed, plan and program give the same bits.",
  threads: "Threads that render.",
  region: "relMSE of the region's pixels alone, with its 95 % interval.",
  selection: "Computed on this page from the images it holds (half floats): the mean over the drawn pixels of the relative squared error, "
    + "without a reference of what the run itself expects of it. Errors of images shown smaller were taken at full resolution.",
};

/** Gives a node its meaning: a key of `meanings`, or text. */
function explained(node, meaning) {
  const text = meanings[meaning] || meaning;
  if (text) {
    node.dataset.meaning = text;
    node.setAttribute("aria-description", text);
  }
  return node;
}
