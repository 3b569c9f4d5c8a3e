// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Outlier rejection between two views: two-point RANSAC with a known rotation, five-point RANSAC without.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "edged/options/frontend.hpp"

namespace edged {

/// A feature in two views, on the unit plane of the camera.
struct Correspondence {
  Eigen::Vector2d reference;
  Eigen::Vector2d current;
};

enum class OutlierModel {
  None,          ///< too few pairs, or no model with enough support: nothing is rejected
  RotationOnly,  ///< the parallax is too small to estimate a translation
  Translation,   ///< rotation given, direction of translation found from two pairs
  FivePoint,     ///< rotation and direction of translation from five pairs
};

struct OutlierResult {
  OutlierModel model = OutlierModel::None;
  std::vector<char> inlier;  ///< one per pair; all 1 with OutlierModel::None
  int inliers = 0;           ///< how many of them are 1
};

/// Which pairs fit one rigid motion. R_ref_cur, from the gyro, turns rays of the current camera into the reference
/// camera's axes; without it (gyro saturated) five-point RANSAC (Nister 2004) is used, and also when the given rotation
/// has less support than fallback_share. focal_px turns the thresholds into angles. RANSAC by OpenGV (Kneip and
/// Furgale 2014) with a fixed seed: same input, same result.
OutlierResult find_inliers(std::span<const Correspondence> pairs, const std::optional<Eigen::Matrix3d>& R_ref_cur,
                           double focal_px, const OutlierConfig& config);

}  // namespace edged
