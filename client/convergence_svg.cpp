// The plot of `converge`: variance over light samples, log-log, a line per mix with its slope.
#include <algorithm>
#include <array>
#include <cmath>

#include "client/convergence.h"
#include "proto/status.h"

namespace penumbra {
namespace {

constexpr double kWidth = 720, kHeight = 480, kLeft = 80, kTop = 48, kRight = 24, kBottom = 56, kRow = 18;
// Okabe & Ito's colours, told apart by the colour-blind.
constexpr std::array<const char*, 8> kColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                 "#e69f00", "#56b4e9", "#000000", "#999933"};

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
  return out;
}

/// One axis: whole decades around the data.
struct Decades {
  double low, high, from, to;  ///< exponents, and where they lie on the page
  double at(double value) const { return from + (std::log10(value) - low) / (high - low) * (to - from); }
};

Decades around(double least, double most, double from, double to) {
  const double low = std::floor(std::log10(least)), high = std::ceil(std::log10(most));
  return {low, high > low ? high : low + 1, from, to};
}

std::string axes(const Decades& x, const Decades& y) {
  std::string out;
  for (double d = x.low; d <= x.high; ++d) {
    const double at = x.at(std::pow(10, d));
    out += fmt::format(
        "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/>"
        "<text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4:g}</text>\n",
        at, y.to, y.from, y.from + kRow, std::pow(10, d));
  }
  for (double d = y.low; d <= y.high; ++d) {
    const double at = y.at(std::pow(10, d));
    out += fmt::format(
        "<line class=\"grid\" x1=\"{1}\" x2=\"{2}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\"/>"
        "<text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">1e{5:g}</text>\n",
        at, x.from, x.to, x.from - 8, at + 4, d);
  }
  return out;
}

std::string curve_svg(const ConvergenceCurve& curve, const char* colour, const Decades& x, const Decades& y,
                      double legend_y) {
  std::string dots, name = escaped(curve.mix);
  for (const ConvergencePoint& p : curve.points)
    if (p.variance > 0)
      dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>", x.at(p.samples),
                          y.at(p.variance), colour);
  std::string line;
  if (curve.law) {
    const double first = curve.points.front().samples, last = curve.points.back().samples;
    const auto value = [&](double n) {
      return std::exp(curve.law->intercept) * std::pow(n, curve.law->slope);
    };
    line = fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>",
                       x.at(first), y.at(value(first)), x.at(last), y.at(value(last)), colour);
    name += fmt::format(": slope {:.2f} [{:.2f}, {:.2f}]", curve.law->slope, curve.law->ci.low,
                        curve.law->ci.high);
  }
  return line + dots +
         fmt::format("<text x=\"{}\" y=\"{:.1f}\" fill=\"{}\">{}</text>\n", kLeft, legend_y, colour, name);
}

}  // namespace

std::string convergence_svg(const std::vector<ConvergenceCurve>& curves, const std::string& title) {
  double least_x = INFINITY, most_x = 0, least_y = INFINITY, most_y = 0;
  for (const ConvergenceCurve& curve : curves)
    for (const ConvergencePoint& p : curve.points) {
      if (!(p.variance > 0)) continue;
      least_x = std::min(least_x, p.samples);
      most_x = std::max(most_x, p.samples);
      least_y = std::min(least_y, p.variance);
      most_y = std::max(most_y, p.variance);
    }
  const double height = kHeight + kRow * static_cast<double>(curves.size());
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<style>.grid{{stroke:#ccc}}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
      "<text x=\"{2}\" y=\"28\" font-size=\"15\">{3}</text>\n",
      kWidth, height, kLeft, escaped(title));
  if (most_x > 0) {
    const Decades x = around(least_x, most_x, kLeft, kWidth - kRight);
    const Decades y = around(least_y, most_y, kHeight - kBottom, kTop);
    out += axes(x, y);
    out += fmt::format(
        "<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">light samples</text>\n"
        "<text transform=\"translate(20,{:.1f}) rotate(-90)\" text-anchor=\"middle\">variance of one "
        "estimate</text>\n",
        (x.from + x.to) / 2, kHeight - kBottom + 2.1 * kRow, (y.from + y.to) / 2);
    for (size_t i = 0; i < curves.size(); ++i)
      out +=
          curve_svg(curves[i], kColours[i % kColours.size()], x, y, kHeight + kRow * static_cast<double>(i));
  }
  return out + "</svg>\n";
}

}  // namespace penumbra
