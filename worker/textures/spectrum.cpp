// Parameters that are colours of any kind, to linear RGB.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "proto/status.h"
#include "worker/textures/cie.h"
#include "worker/textures/named_spectra.h"
#include "worker/textures/textures.h"

namespace penumbra {
namespace {

/// Wavelength/value pairs one after the other. pbrt sorts them; we do too.
absl::StatusOr<Rgb> rgb_of_pairs(std::vector<double> numbers, const std::string& place) {
  if (numbers.empty() || numbers.size() % 2 != 0) {
    return invalid_input("{}: a spectrum needs wavelength/value pairs, not {} numbers", place,
                         numbers.size());
  }
  std::vector<std::pair<double, double>> pairs;
  for (size_t i = 0; i < numbers.size(); i += 2) {
    if (!std::isfinite(numbers[i]) || !std::isfinite(numbers[i + 1])) {
      return invalid_input("{}: a spectrum's numbers must be finite", place);
    }
    pairs.emplace_back(numbers[i], numbers[i + 1]);
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<double> wavelengths, values;
  for (const auto& [nm, value] : pairs) {
    wavelengths.push_back(nm);
    values.push_back(value);
  }
  return rgb_of_spectrum({wavelengths, values});
}

/// A .spd file: numbers separated by blanks; `#` starts a comment. Errors name the file's line.
absl::StatusOr<std::vector<double>> read_spd(const std::string& path, const std::string& name) {
  std::ifstream file(path);
  if (!file) return invalid_input("{}: cannot be read", name);
  std::vector<double> numbers;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    for (std::string word; words >> word;) {
      double value = 0;
      const char* start = word.data() + (word[0] == '+' ? 1 : 0);
      const auto [end, error] = std::from_chars(start, word.data() + word.size(), value);
      if (error != std::errc() || end != word.data() + word.size()) {
        return invalid_input("{}:{}: '{}' is not a number", name, number, word);
      }
      numbers.push_back(value);
    }
  }
  return numbers;
}

absl::StatusOr<Rgb> rgb_of_named(const Param& param, const std::string& place, const SceneFiles& files) {
  const std::string& name = param.strings[0];
  if (const auto named = named_spectrum(name)) return *named;
  const auto path = files.path_of(name);
  if (!path.ok()) {
    return make_status(absl::StatusCode::kNotFound, "{}: unknown spectrum or missing file '{}'", place, name);
  }
  const auto numbers = read_spd(*path, name);
  if (!numbers.ok()) return invalid_input("{}: {}", place, message_of(numbers.status()));
  return rgb_of_pairs(*numbers, fmt::format("{}: {}", place, name));
}

/// v3: [kelvin scale], the peak is 1; v4: one number, luminance 1 as its emitters have it.
absl::StatusOr<Rgb> rgb_of_blackbody_param(const Param& param, const std::string& place) {
  const size_t n = param.numbers.size();
  if (n == 0) return invalid_input("{}: blackbody '{}' needs a temperature", place, param.name);
  Rgb sum(0);
  for (size_t i = 0; i < n; i += 2) {
    const double kelvin = param.numbers[i];
    if (!(kelvin > 0) || !std::isfinite(kelvin)) {
      return invalid_input("{}: blackbody temperature {} is not above 0 kelvin", place, kelvin);
    }
    const Rgb color = rgb_of_blackbody(kelvin);
    if (n == 1) return color / luminance(color);
    if (i + 1 == n)
      return invalid_input("{}: blackbody '{}' needs temperature/scale pairs", place, param.name);
    sum += color * static_cast<float>(param.numbers[i + 1]);
  }
  return sum;
}

}  // namespace

absl::StatusOr<Rgb> to_rgb(const Param& param, const SceneDescription& description, const SceneFiles& files) {
  const std::string place = description.place(param.loc);
  const auto& v = param.numbers;
  if (param.type == "rgb" || param.type == "xyz") {
    if (v.size() != 3) return invalid_input("{}: '{}' needs 3 numbers, not {}", place, param.name, v.size());
    if (param.type == "xyz") return rgb_of_xyz({v[0], v[1], v[2]});
    return Rgb(static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]));
  }
  if (param.type == "float" && v.size() == 1) return Rgb(static_cast<float>(v[0]));
  if (param.type == "blackbody") return rgb_of_blackbody_param(param, place);
  if (param.type == "spectrum" && !param.strings.empty()) return rgb_of_named(param, place, files);
  // One number is a constant reflectance, index or intensity (pbrt-v4).
  if (param.type == "spectrum" && v.size() == 1) return Rgb(static_cast<float>(v[0]));
  if (param.type == "spectrum") return rgb_of_pairs(v, place);
  return invalid_input("{}: '{}' of type {} is not a colour", place, param.name, param.type);
}

}  // namespace penumbra
