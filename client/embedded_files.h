#pragma once
#include <string_view>

namespace penumbra {

/// The report's page, which the build put into the program (penumbra_embed).
std::string_view embedded_report_html();
std::string_view embedded_report_css();
std::string_view embedded_report_js();
std::string_view embedded_d3_js();

}  // namespace penumbra
