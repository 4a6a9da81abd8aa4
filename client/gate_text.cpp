// What `gate` says, for people and for programs.
#include <cmath>

#include "client/gate_run.h"
#include "proto/status.h"

namespace penumbra {

std::string gate_text(const GateResult& result) {
  size_t width = 3;
  for (const GateRow& row : result.rows) width = std::max(width, row.mix.size());
  std::string text = fmt::format("{:{}}  {:14}  {:>7}  {:15}  {:>9}  verdict\n", "mix", width, "figure",
                                 "new/old", "95 % interval", "tolerance");
  for (const GateRow& row : result.rows) {
    std::string ratio = "–", ci = "–";
    if (row.log_ratio) {
      const ConfidenceInterval i = exp_interval(*row.log_ratio, 0.95);
      ratio = fmt::format("{:.3f}", std::exp(row.log_ratio->value));
      ci = fmt::format("[{:.3f}, {:.3f}]", i.low, i.high);
    }
    text +=
        fmt::format("{:{}}  {:14}  {:>7}  {:15}  {:>9}  {}", row.mix, width, row.figure, ratio, ci,
                    fmt::format("{:.3g} %", 100 * row.tolerance), row.verdict ? name_of(*row.verdict) : "–");
    text += row.note.empty() ? "\n" : fmt::format("  ({})\n", row.note);
  }
  for (const std::string& note : result.notes) text += fmt::format("note: {}\n", note);
  return text + fmt::format("gate: {}\n", name_of(result.verdict));
}

Json gate_json(const GateResult& result) {
  Json rows = Json::array();
  for (const GateRow& row : result.rows) {
    Json json = {{"mix", row.mix}, {"figure", row.figure}, {"tolerance", row.tolerance}};
    if (row.log_ratio) {
      const ConfidenceInterval i = exp_interval(*row.log_ratio, 0.95);
      json["ratio"] = std::exp(row.log_ratio->value);
      json["ratio_ci"] = Json::array({i.low, i.high});
    } else {
      json["ratio"] = json["ratio_ci"] = nullptr;
    }
    json["verdict"] = row.verdict ? Json(name_of(*row.verdict)) : Json(nullptr);
    json["note"] = row.note;
    rows.push_back(json);
  }
  return {{"verdict", name_of(result.verdict)}, {"figures", rows}, {"notes", result.notes}};
}

}  // namespace penumbra
