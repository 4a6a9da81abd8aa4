#pragma once
#include <string_view>

namespace penumbra {

/// The dashboard, which the build put into the program (penumbra_embed).
std::string_view embedded_dashboard_html();
std::string_view embedded_dashboard_css();
std::string_view embedded_dashboard_js();
std::string_view embedded_dashboard_d3();

}  // namespace penumbra
