#pragma once
#include <string_view>

namespace penumbra {

/// Files that the build put into the program.
std::string_view embedded_report_html();
std::string_view embedded_report_css();
std::string_view embedded_report_js();
std::string_view embedded_d3_js();

}  // namespace penumbra
