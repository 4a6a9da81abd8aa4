#include "server/http_pages.h"

#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "proto/status.h"
#include "server/dashboard_files.h"
#include "server/http_metrics.h"

namespace penumbra {
namespace {

using Json = nlohmann::json;

constexpr const char* kJson = "application/json";

HttpReply failure(const absl::Status& status) {
  const int code = absl::IsNotFound(status) ? 404 : 503;
  return {code, "text/plain; charset=utf-8", message_of(status) + "\n"};
}

HttpReply json_reply(const Json& json) {
  return {200, kJson, json.dump(-1, ' ', false, Json::error_handler_t::replace)};
}

Json status_json(const JobStatus& s) {
  return {{"job", s.job},
          {"state", name_of(s.state)},
          {"scene", s.scene},
          {"message", s.message},
          {"fraction", s.fraction},
          {"tasks", {{"done", s.tasks_done}, {"total", s.tasks_total}, {"leased", s.tasks_leased}}},
          {"cpu_seconds", s.cpu_seconds},
          {"pilot_cpu_seconds", s.pilot_cpu_seconds},
          {"wall_seconds", s.wall_seconds},
          {"retries", s.retries},
          {"submitted", s.submitted_unix_seconds}};
}

Json worker_json(const WorkerView& w) {
  return {{"host", w.info.host},          {"name", w.name},          {"id", w.info.id},
          {"threads", w.info.cores},      {"isa", w.info.isa},       {"version", w.version},
          {"leases", w.leases},           {"draining", w.draining},  {"silence_seconds", w.silence_seconds},
          {"cpu_seconds", w.cpu_seconds}, {"set_aside", w.set_aside}};
}

Json detail_json(const JobDetail& detail, const Preview& preview) {
  Json json = status_json(detail.status);
  std::vector<Mix> mixes;
  for (const MixSummary& mix : detail.mixes) mixes.push_back(mix.mix);
  const std::vector<std::string> names = labels(mixes);
  json["mixes"] = Json::array();
  for (size_t m = 0; m < detail.mixes.size(); ++m) {
    Json curve = Json::array();
    if (m < preview.curves.size())
      for (const CurvePoint& point : preview.curves[m])
        curve.push_back({{"passes", point.passes},
                         {"cpu_seconds", point.cpu_seconds},
                         {"estimated_relmse", point.estimated_relmse}});
    const MixSummary& mix = detail.mixes[m];
    json["mixes"].push_back({{"mix", names[m]},
                             {"passes", mix.passes},
                             {"planned_passes", mix.planned_passes},
                             {"cpu_seconds", mix.cpu_seconds},
                             {"image", m < preview.images.size() && !preview.images[m].empty()},
                             {"curve", curve}});
  }
  json["why"] = detail.why;
  return json;
}

/// The reply with a file of the dashboard, if `path` names one.
std::optional<HttpReply> file(std::string_view path) {
  const auto reply = [](const char* type, std::string_view body) {
    return HttpReply{200, type, std::string(body)};
  };
  if (path == "/") return reply("text/html; charset=utf-8", embedded_dashboard_html());
  if (path == "/dashboard.css") return reply("text/css; charset=utf-8", embedded_dashboard_css());
  if (path == "/dashboard.js") return reply("text/javascript; charset=utf-8", embedded_dashboard_js());
  if (path == "/d3.js") return reply("text/javascript; charset=utf-8", embedded_dashboard_d3());
  return std::nullopt;
}

}  // namespace

HttpReply HttpPages::state() {
  const auto snapshot = snapshots_.latest();
  if (!snapshot.ok()) return failure(snapshot.status());
  Json json{{"version", PENUMBRA_VERSION},
            {"time", (*snapshot)->taken_unix},
            {"server_cpu_seconds", (*snapshot)->server_cpu_seconds},
            {"jobs", Json::array()},
            {"workers", Json::array()}};
  for (const JobView& job : (*snapshot)->jobs) {
    json["jobs"].push_back(status_json(job.status));
    json["jobs"].back()["mixes"] = job.mixes;
  }
  for (const WorkerView& worker : (*snapshot)->workers) json["workers"].push_back(worker_json(worker));
  return json_reply(json);
}

HttpReply HttpPages::job(const JobId& id) {
  const auto detail = snapshots_.detail(id);
  if (!detail.ok()) return failure(detail.status());
  const auto preview = previews_.of(id);
  if (!preview.ok()) return failure(preview.status());
  return json_reply(detail_json(**detail, **preview));
}

HttpReply HttpPages::image(const JobId& id, const std::string& mix) {
  if (const auto detail = snapshots_.detail(id); !detail.ok()) return failure(detail.status());
  const auto preview = previews_.of(id);
  if (!preview.ok()) return failure(preview.status());
  size_t index = 0;
  const auto parsed = std::from_chars(mix.data(), mix.data() + mix.size(), index);
  const bool number = mix.empty() || (parsed.ec == std::errc() && parsed.ptr == mix.data() + mix.size());
  if (!number || index >= (*preview)->images.size() || (*preview)->images[index].empty())
    return {404, "text/plain; charset=utf-8", "no picture of this mix yet\n"};
  return {200, "image/png", (*preview)->images[index]};
}

HttpReply HttpPages::answer(const HttpRequest& request) {
  const std::string& path = request.path;
  if (std::optional<HttpReply> found = file(path)) return *std::move(found);
  if (path == "/healthz")
    return coordinator_.failed() ? HttpReply{503, "text/plain; charset=utf-8", "the job store failed\n"}
                                 : HttpReply{200, "text/plain; charset=utf-8", "ok\n"};
  if (path == "/metrics") {
    const auto snapshot = snapshots_.latest();
    if (!snapshot.ok()) return failure(snapshot.status());
    return {200, "text/plain; version=0.0.4; charset=utf-8", metrics_text(**snapshot)};
  }
  if (path == "/api/state") return state();
  constexpr std::string_view kJobs = "/api/jobs/", kImage = "/image.png";
  if (path.starts_with(kJobs)) {
    const auto mix = request.variables.find("mix");
    const std::string rest = path.substr(kJobs.size());
    if (rest.ends_with(kImage))
      return image(rest.substr(0, rest.size() - kImage.size()),
                   mix == request.variables.end() ? "" : mix->second);
    return job(rest);
  }
  return {404, "text/plain; charset=utf-8", "not found\n"};
}

}  // namespace penumbra
