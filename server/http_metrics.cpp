#include "server/http_metrics.h"

#include <prometheus/metric_family.h>
#include <prometheus/text_serializer.h>

#include <array>
#include <utility>

namespace penumbra {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;
using Labels = std::vector<ClientMetric::Label>;

// A farm's history would drown its present: jobs that have ended are counted, not listed.
constexpr size_t kMostListedJobs = 200;

class Families {
 public:
  MetricFamily& add(const std::string& name, const std::string& help, MetricType type) {
    return families_.emplace_back(MetricFamily{name, help, type, {}});
  }
  void gauge(const std::string& name, const std::string& help, double value) {
    set(add(name, help, MetricType::Gauge), {}, value);
  }
  void counter(const std::string& name, const std::string& help, double value) {
    set(add(name, help, MetricType::Counter), {}, value);
  }
  static void set(MetricFamily& family, Labels labels, double value) {
    ClientMetric metric;
    metric.label = std::move(labels);
    (family.type == MetricType::Counter ? metric.counter.value : metric.gauge.value) = value;
    family.metric.push_back(std::move(metric));
  }
  std::string text() const { return prometheus::TextSerializer().Serialize(families_); }

 private:
  std::vector<MetricFamily> families_;
};

void jobs(const Snapshot& snapshot, Families& out) {
  std::array<double, 6> states{};
  double waiting = 0, leased = 0, retries = 0, cpu = 0, pilot = 0;
  for (const JobView& job : snapshot.jobs) {
    const JobStatus& s = job.status;
    ++states.at(static_cast<size_t>(s.state));
    retries += static_cast<double>(s.retries);
    cpu += s.cpu_seconds;
    pilot += s.pilot_cpu_seconds;
    if (is_final(s.state)) continue;
    leased += static_cast<double>(s.tasks_leased);
    waiting += static_cast<double>(s.tasks_total - s.tasks_done - s.tasks_leased);
  }
  MetricFamily& family = out.add("penumbra_jobs", "Jobs that the store holds, by state.", MetricType::Gauge);
  for (size_t i = 0; i < states.size(); ++i)
    Families::set(family, {{"state", std::string(name_of(static_cast<JobState>(i)))}}, states[i]);
  out.gauge("penumbra_tasks_waiting", "Tile tasks of unfinished jobs that no worker holds.", waiting);
  out.gauge("penumbra_tasks_leased", "Tile tasks that workers hold.", leased);
  // Scaled by those that wait alone, workers would be taken away from what they render.
  out.gauge("penumbra_tasks_unfinished", "The sum of these two: what to scale workers by.", waiting + leased);
  out.gauge("penumbra_lease_retries", "Leases given out again, summed over the jobs that the store holds.",
            retries);
  out.gauge("penumbra_render_cpu_seconds",
            "CPU seconds of accepted results, summed over the jobs that the store holds.", cpu);
  out.gauge("penumbra_pilot_cpu_seconds", "CPU seconds of accepted pilots, summed likewise.", pilot);
}

void running_jobs(const Snapshot& snapshot, Families& out) {
  MetricFamily fraction{
      "penumbra_job_fraction", "Part of an unfinished job that is done, 0 to 1.", MetricType::Gauge, {}};
  MetricFamily waiting{"penumbra_job_tasks_waiting",
                       "Tile tasks of an unfinished job that no worker holds.",
                       MetricType::Gauge,
                       {}};
  for (const JobView& job : snapshot.jobs) {
    const JobStatus& s = job.status;
    if (is_final(s.state) || fraction.metric.size() == kMostListedJobs) continue;
    const Labels labels{{"job", s.job}, {"scene", s.scene}};
    Families::set(fraction, labels, s.fraction);
    Families::set(waiting, labels, static_cast<double>(s.tasks_total - s.tasks_done - s.tasks_leased));
  }
  out.add(fraction.name, fraction.help, fraction.type).metric = std::move(fraction.metric);
  out.add(waiting.name, waiting.help, waiting.type).metric = std::move(waiting.metric);
}

void workers(const Snapshot& snapshot, Families& out) {
  double threads = 0, draining = 0;
  MetricFamily leases{"penumbra_worker_leases", "Tile tasks that the worker holds.", MetricType::Gauge, {}};
  MetricFamily silence{"penumbra_worker_silence_seconds",
                       "Since the worker called; at --silence its leases end.",
                       MetricType::Gauge,
                       {}};
  for (const WorkerView& worker : snapshot.workers) {
    threads += worker.info.cores;
    draining += worker.draining;
    const Labels labels{{"host", worker.info.host}, {"worker", worker.name}};
    Families::set(leases, labels, static_cast<double>(worker.leases));
    Families::set(silence, labels, worker.silence_seconds);
  }
  out.gauge("penumbra_workers", "Workers that are connected.", static_cast<double>(snapshot.workers.size()));
  out.gauge("penumbra_workers_draining", "Of these, those that take no more work.", draining);
  out.gauge("penumbra_worker_threads", "Threads that connected workers render with.", threads);
  out.add(leases.name, leases.help, leases.type).metric = std::move(leases.metric);
  out.add(silence.name, silence.help, silence.type).metric = std::move(silence.metric);
}

}  // namespace

std::string metrics_text(const Snapshot& snapshot) {
  Families out;
  MetricFamily& build =
      out.add("penumbra_build_info", "Always 1; the version is the label.", MetricType::Gauge);
  Families::set(build, {{"version", PENUMBRA_VERSION}}, 1);
  out.counter("penumbra_server_cpu_seconds_total", "CPU seconds of the server process.",
              snapshot.server_cpu_seconds);
  jobs(snapshot, out);
  running_jobs(snapshot, out);
  workers(snapshot, out);
  return out.text();
}

}  // namespace penumbra
