// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/lens_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "edged/camera/lenses/double_sphere.hpp"
#include "edged/camera/lenses/equidistant.hpp"
#include "edged/camera/lenses/extended_unified.hpp"
#include "edged/camera/lenses/fov.hpp"
#include "edged/camera/lenses/omni.hpp"
#include "edged/camera/lenses/omni_equidistant.hpp"
#include "edged/camera/lenses/radtan.hpp"
#include "edged/camera/lenses/rational.hpp"

namespace edged {
namespace {

constexpr LensModel kNoDistortion{
    .model = DistortionModel::None, .name = "none", .coefficients = "", .aliases = {"no"}};

constexpr std::array kLensModels{kNoDistortion, kRadTan,       kEquidistant,     kRational,       kFieldOfView,
                                 kOmni,         kDoubleSphere, kExtendedUnified, kOmniEquidistant};

}  // namespace

std::span<const LensModel> lens_models() { return kLensModels; }

const LensModel& lens_model(DistortionModel model) {
  for (const LensModel& lens : kLensModels)
    if (lens.model == model) return lens;
  return kNoDistortion;
}

const LensModel* find_lens_model(std::string_view name) {
  const auto found = std::ranges::find_if(kLensModels, [name](const LensModel& lens) {
    return lens.name == name || (!name.empty() && std::ranges::find(lens.aliases, name) != lens.aliases.end());
  });
  return found == kLensModels.end() ? nullptr : &*found;
}

std::vector<std::string_view> coefficient_names(const LensModel& lens) {
  constexpr std::string_view kBetween = " []";
  std::vector<std::string_view> names;
  for (std::string_view rest = lens.coefficients; !rest.empty();) {
    const std::size_t begin = std::min(rest.find_first_not_of(kBetween), rest.size()),
                      end = std::min(rest.find_first_of(kBetween, begin), rest.size());
    if (end > begin) names.push_back(rest.substr(begin, end - begin));
    rest.remove_prefix(end);
  }
  return names;
}

std::string lens_model_names() {
  std::string names;
  for (const LensModel& lens : kLensModels) names.append(names.empty() ? "" : ", ").append(lens.name);
  return names;
}

Distorted distorted(const LensModel& lens, const LensCoefficients& k, const Eigen::Vector2d& p) {
  Distorted out{p, Eigen::Matrix2d::Identity()};
  if (lens.radius_of_angle) {
    const double r = p.norm();
    const ValueAndSlope of_angle = lens.radius_of_angle(k, std::atan(r));
    out = moved_to_radius(p, {of_angle.value, of_angle.slope / (1.0 + r * r)});
  }
  if (!lens.distort) return out;
  const Distorted second = lens.distort(k, out.point);
  return {second.point, second.d_point * out.d_point};
}

std::string to_string(DistortionModel model) { return std::string(lens_model(model).name); }

}  // namespace edged
