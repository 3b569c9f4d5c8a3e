// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/lens_start.hpp"

#include <algorithm>

#include "edged/camera/lens_table.hpp"

namespace edged {
namespace {

std::vector<LensCoefficients> shapes(DistortionModel distortion) {
  switch (distortion) {
    case DistortionModel::FieldOfView:
      return {{0.3}, {0.9}};
    case DistortionModel::Omni:
      return {{0.1}, {1.0}};
    case DistortionModel::DoubleSphere:
      return {{0.0, 0.3}, {0.0, 0.6}};
    case DistortionModel::ExtendedUnified:
      return {{0.3, 1.0}, {0.6, 1.0}};
    default:
      return {{}};
  }
}

}  // namespace

std::vector<FreeLens> lenses_to_try(DistortionModel distortion, int width, int height) {
  std::vector<FreeLens> out;
  const LensModel& model = lens_model(distortion);
  for (const LensCoefficients& k : shapes(distortion)) {
    const double slope = model.radius_of_angle != nullptr ? model.radius_of_angle(k, 0.0).slope : 1.0;
    for (double share = 0.25; share < 3.0; share *= 1.35) {
      const double focal = share * width / slope;
      FreeLens lens{distortion, {focal, focal, 0.5 * (width - 1), 0.5 * (height - 1)}};
      std::ranges::copy(k, lens.values.begin() + 4);
      out.push_back(lens);
    }
  }
  return out;
}

}  // namespace edged
