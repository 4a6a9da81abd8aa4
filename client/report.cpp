#include "client/report.h"

#include <filesystem>

#include "client/embedded_files.h"
#include "client/report_data.h"
#include "film/atomic_file.h"
#include "proto/status.h"

namespace penumbra {
namespace {

/// JSON that may stand inside a <script> element: no `</script` and no `<!--` can occur in it.
std::string script_safe(std::string json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json) {
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

/// The page with each `{{name}}` of the template replaced by its part.
std::string fill(std::string_view page,
                 const std::vector<std::pair<std::string_view, std::string_view>>& parts) {
  std::string out;
  while (!page.empty()) {
    const size_t open = page.find("{{");
    out += page.substr(0, open);
    if (open == std::string_view::npos) break;
    const size_t close = page.find("}}", open);
    PENUMBRA_CHECK(close != std::string_view::npos);
    const std::string_view name = page.substr(open + 2, close - open - 2);
    bool known = false;
    for (const auto& [key, text] : parts)
      if (key == name) {
        out += text;
        known = true;
      }
    PENUMBRA_CHECK(known);
    page.remove_prefix(close + 2);
  }
  return out;
}

}  // namespace

absl::Status write_report(const std::string& folder) {
  ASSIGN_OR_RETURN(const Json data, report_data(folder));
  const std::string json = script_safe(data.dump(-1, ' ', false, Json::error_handler_t::replace));
  const std::string page = fill(embedded_report_html(), {{"style", embedded_report_css()},
                                                         {"d3", embedded_d3_js()},
                                                         {"data", json},
                                                         {"script", embedded_report_js()}});
  return write_file_atomically(std::filesystem::path(folder) / "report.html", page);
}

}  // namespace penumbra
