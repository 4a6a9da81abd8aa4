// One job: its picture, its error as it falls, and why it is (not) running.
const detail = { job: null, mix: 0, seen: "" };

function showJob(job) {
  detail.job = job;
  detail.mix = 0;
  detail.seen = "";
  document.getElementById("picture").hidden = true;
  location.hash = job;
  document.querySelectorAll("#jobs tbody tr").forEach((row) => row.setAttribute("aria-current", String(row.dataset.job === job)));
  return refreshDetail();
}

function offerMixes(mixes) {
  const select = document.getElementById("mix"), names = mixes.map((m) => m.mix);
  if (select.dataset.names === names.join("\n")) return;
  select.dataset.names = names.join("\n");
  select.replaceChildren(...names.map((name, i) => el("option", { value: i }, name)));
}

/** A new picture is asked for only when more has been accepted; the old one stays until it is there. */
function showPicture(job) {
  const picture = document.getElementById("picture"), there = job.mixes[detail.mix] && job.mixes[detail.mix].image;
  document.getElementById("no-picture").hidden = there;
  if (!there) { picture.hidden = true; return; }
  const seen = `${job.job} ${detail.mix} ${job.cpu_seconds}`;
  if (seen === detail.seen) return;
  detail.seen = seen;
  const next = new Image();
  next.onload = () => {
    picture.src = next.src;
    picture.alt = `${job.mixes[detail.mix].mix}, ${job.mixes[detail.mix].passes} passes`;
    picture.hidden = false;
  };
  next.src = `/api/jobs/${encodeURIComponent(job.job)}/image.png?mix=${detail.mix}&of=${job.cpu_seconds}`;
}

async function refreshDetail() {
  if (!detail.job) return;
  const reply = await fetch(`/api/jobs/${encodeURIComponent(detail.job)}`, { signal: AbortSignal.timeout(patience) });
  if (reply.status === 404) { detail.job = null; document.getElementById("detail").hidden = true; return; }
  if (!reply.ok) throw new Error(await reply.text());
  const job = await reply.json();
  document.getElementById("detail").hidden = false;
  document.getElementById("detail-title").textContent = `${baseName(job.scene)} (${job.job}), ${job.state}${job.message ? `: ${job.message}` : ""}`;
  offerMixes(job.mixes);
  showPicture(job);
  const mix = job.mixes[detail.mix];
  document.getElementById("passes").textContent = mix ? `${mix.passes} of ${mix.planned_passes || "?"} passes in every pixel, ${seconds(mix.cpu_seconds)} of CPU` : "";
  drawCurve(document.getElementById("curve"), job.mixes);
  document.getElementById("why").replaceChildren(...job.why.map((line) => el("li", {}, line)));
}

document.getElementById("mix").addEventListener("change", (event) => {
  detail.mix = +event.target.value;
  detail.seen = "";
  refreshDetail().catch(tellLoss);
});
