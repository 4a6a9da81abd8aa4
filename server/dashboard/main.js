// Asks the coordinator once a second while somebody can see the page, and shows what it says.
const period = 1000, patience = 15000;

function jobRow(job) {
  const open = el("button", { type: "button" }, job.job);
  const bar = el("progress", { max: 1, value: job.fraction, "aria-label": `progress of ${job.job}` });
  const row = el("tr", { "data-job": job.job, "aria-current": String(job.job === detail.job) },
    el("td", {}, open), el("td", { title: job.scene }, baseName(job.scene)), el("td", { class: job.state, title: job.message }, job.state),
    el("td", {}, bar, `${Math.floor(100 * job.fraction)} %`), el("td", {}, `${job.tasks.done} / ${job.tasks.total}, ${job.tasks.leased} held`),
    el("td", {}, seconds(job.cpu_seconds)), el("td", {}, seconds(job.wall_seconds)),
    el("td", {}, moment(job.submitted)));
  row.addEventListener("click", () => showJob(job.job).catch(tellLoss));
  return row;
}

function workerRow(worker) {
  return el("tr", {}, el("td", {}, worker.name), el("td", {}, worker.host), el("td", {}, String(worker.threads)), el("td", {}, worker.isa),
    el("td", { title: worker.set_aside }, `${worker.leases} tiles${worker.draining ? ", draining" : ""}${worker.set_aside ? ", set aside" : ""}`), el("td", {}, seconds(worker.cpu_seconds)),
    el("td", {}, `${worker.silence_seconds.toFixed(1)} s ago`));
}

/** Rows are made anew; the keyboard's place among them is kept. */
function fillTable(id, rows, nothing, columns) {
  const body = document.querySelector(`#${id} tbody`), row = document.activeElement.closest ? document.activeElement.closest(`#${id} tr`) : null;
  const focused = row && row.dataset.job;
  body.replaceChildren(...(rows.length ? rows : [el("tr", {}, el("td", { colspan: columns }, nothing))]));
  const again = focused && [...body.rows].find((r) => r.dataset.job === focused);
  if (again) again.querySelector("button").focus();
}

function tellState(state) {
  const running = state.jobs.filter((j) => !["done", "failed", "cancelled"].includes(j.state)).length;
  const threads = state.workers.reduce((sum, w) => sum + w.threads, 0), summary = document.getElementById("summary");
  summary.className = "";
  summary.textContent = `${running} of ${state.jobs.length} jobs unfinished · ${state.workers.length} workers, ${threads} threads · `
    + `server ${seconds(state.server_cpu_seconds)} of CPU · version ${state.version}`;
  fillTable("jobs", state.jobs.map(jobRow), "none", 8);
  fillTable("workers", state.workers.map(workerRow), "none is connected: start penumbra-worker", 7);
  document.body.setAttribute("data-ready", "");
}

function tellLoss(fault) {
  const summary = document.getElementById("summary");
  summary.className = "lost";
  summary.textContent = `the coordinator does not answer: ${fault.message}`;
}

async function refresh() {
  if (document.hidden) {
    document.addEventListener("visibilitychange", refresh, { once: true });
    return;
  }
  try {
    const reply = await fetch("/api/state", { signal: AbortSignal.timeout(patience) });
    if (!reply.ok) throw new Error(await reply.text());
    const state = await reply.json();
    tellState(state);
    if (!detail.job && state.jobs.length) {
      const asked = decodeURIComponent(location.hash.slice(1));
      await showJob(state.jobs.some((j) => j.job === asked) ? asked : state.jobs[0].job);
    } else await refreshDetail();
  } catch (fault) {
    tellLoss(fault);
  }
  setTimeout(refresh, period);
}
refresh();
