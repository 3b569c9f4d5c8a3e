// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/distortion.hpp"

#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/io/text_parsing.hpp"

namespace edged {
namespace {

constexpr std::array<std::string_view, 14> kRadialNames = {"k1", "k2", "p1", "p2", "k3", "k4", "k5",
                                                           "k6", "s1", "s2", "s3", "s4", "tx", "ty"};
constexpr std::array<std::string_view, 4> kEquidistantNames = {"k1", "k2", "k3", "k4"};

/// Throws where one behind the first `most` is not zero.
void refuse_others(std::string_view model, const std::vector<double>& k, std::size_t most) {
  const auto from = k.begin() + static_cast<std::ptrdiff_t>(std::min(most, k.size()));
  const auto first = std::find_if(from, k.end(), [](double x) { return x != 0.0; });
  if (first == k.end()) return;
  const auto place = static_cast<std::size_t>(first - k.begin());
  const bool radial = model == "radtan" && place < kRadialNames.size();
  throw InputError::format(
      "distortion {} has {} coefficients, here are {}, and {} = {} is not supported: calibrate with radtan (k1 k2 p1 "
      "p2 "
      "[k3]) or equidistant",
      model, most, k.size(), radial ? std::string(kRadialNames[place]) : fmt::format("number {}", place + 1), *first);
}

Distortion checked(DistortionModel model, std::string_view name, const std::vector<double>& k, std::size_t least,
                   std::size_t most) {
  if (!k.empty() && k.size() < least)
    throw InputError::format("{} takes {} numbers, here are {}", name,
                             name == "radtan" ? "4 or 5 (k1 k2 p1 p2 [k3])" : "4 (k1 k2 k3 k4)", k.size());
  refuse_others(name, k, most);
  Distortion out{model, {}};
  std::copy_n(k.begin(), std::min(most, k.size()), out.k.begin());
  return out;
}

}  // namespace

Distortion make_distortion(std::string_view name, const std::vector<double>& coefficients) {
  const std::string model = lower_case(name);
  const auto is_one_of = [&model](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), model) != names.end();
  };
  if (is_one_of({"radtan", "radial-tangential", "radialtangential", "plumb_bob", "rational_polynomial", "rational",
                 "thin_prism"}))
    return checked(DistortionModel::RadTan, "radtan", coefficients, 4, 5);
  if (is_one_of({"equidistant", "fisheye", "kannala_brandt", "kb4"}))
    return checked(DistortionModel::Equidistant, "equidistant", coefficients, kEquidistantNames.size(),
                   kEquidistantNames.size());
  const bool zeros = std::all_of(coefficients.begin(), coefficients.end(), [](double x) { return x == 0.0; });
  if (is_one_of({"none", "no", ""}) && zeros) return {};
  if (is_one_of({"none", "no", ""}))
    throw InputError::format("distortion none with {} coefficients that are not zero: name its model",
                             coefficients.size());
  if (zeros && !coefficients.empty()) return {};
  throw InputError::format("distortion {} is not supported; radtan, equidistant and none are", model);
}

}  // namespace edged
