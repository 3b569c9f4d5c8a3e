// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/lens_table.hpp"

#include <algorithm>
#include <array>

#include "edged/camera/lenses/equidistant.hpp"
#include "edged/camera/lenses/radtan.hpp"

namespace edged {
namespace {

constexpr LensModel kNoDistortion{.model = DistortionModel::None, .name = "none", .coefficients = "", .also = {"no"}};

constexpr std::array kLensModels{kNoDistortion, kRadTan, kEquidistant};

}  // namespace

std::span<const LensModel> lens_models() { return kLensModels; }

const LensModel& lens_model(DistortionModel model) {
  for (const LensModel& lens : kLensModels)
    if (lens.model == model) return lens;
  return kNoDistortion;
}

const LensModel* find_lens_model(std::string_view name) {
  const auto found = std::ranges::find_if(kLensModels, [name](const LensModel& lens) {
    return lens.name == name || (!name.empty() && std::ranges::find(lens.also, name) != lens.also.end());
  });
  return found == kLensModels.end() ? nullptr : &*found;
}

std::string lens_model_names() {
  std::string names;
  for (const LensModel& lens : kLensModels) names.append(names.empty() ? "" : ", ").append(lens.name);
  return names;
}

std::string to_string(DistortionModel model) { return std::string(lens_model(model).name); }

}  // namespace edged
