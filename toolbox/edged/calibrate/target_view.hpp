// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a camera saw of the target, and the free parameters of a lens.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "edged/camera/lens_model.hpp"
#include "edged/measurement.hpp"
#include "edged/se3.hpp"
#include "edged/target/detect.hpp"

namespace edged {

/// The corners in one picture.
struct TargetView {
  Timestamp t;  ///< camera clock
  std::vector<TargetCorner> corners;
};

/// All pictures of one camera in which the target was found.
struct TargetViews {
  std::string name;
  Modality modality = Modality::Frames;
  int width = 0, height = 0;  ///< [px]
  std::vector<TargetView> views;
  std::size_t pictures = 0;  ///< that were searched
};

/// fx, fy, cx, cy, then the coefficients of the lens in their order.
inline constexpr int kLensParameters = 4 + static_cast<int>(kMaxLensCoefficients);
using LensParameters = std::array<double, kLensParameters>;

/// A lens while it is estimated: without the checks of CameraModel, which refuses what is not monotone over the image.
struct FreeLens {
  DistortionModel distortion = DistortionModel::None;
  LensParameters values{};

  LensCoefficients coefficients() const;
  /// Number of parameters that are estimated: all that the model has, but no k3 of radtan, which Kalibr lacks.
  int count() const;
  /// Throws InputError where that is no camera.
  CameraModel model(int width, int height) const;
};

using PixelByPoint = Eigen::Matrix<double, 2, 3>;
using PixelByLens = Eigen::Matrix<double, 2, kLensParameters>;

/// The pixel of a point in the camera frame; nothing where it is not in front, or more than 85 degrees off the axis.
/// The derivatives may be null.
std::optional<Eigen::Vector2d> project_free(const FreeLens& lens, const Eigen::Vector3d& p_C, PixelByPoint* by_point,
                                            PixelByLens* by_lens);

/// At most so many of them, evenly spread.
template <typename T>
std::vector<T> evenly(const std::vector<T>& from, std::size_t most) {
  std::vector<T> out;
  const std::size_t n = std::min(most, from.size());
  for (std::size_t i = 0; i < n; ++i) out.push_back(from[i * from.size() / n]);
  return out;
}

}  // namespace edged
