// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Corrections of a camera's intrinsics, and what they do to a point of its unit plane.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "edged/rig.hpp"

namespace edged {

/// ln of fx and of fy, principal point over the given focal lengths, the first two coefficients of the lens: all are
/// shares of the field of view.
inline constexpr int kIntrinsics = 6;
inline constexpr int kCorrectedCoefficients = 2, kCoefficientsAt = kIntrinsics - kCorrectedCoefficients;
using IntrinsicsCorrection = Eigen::Matrix<double, kIntrinsics, 1>;
using ByIntrinsics = Eigen::Matrix<double, 2, kIntrinsics>;

/// The derivative by the corrections of the point at which a pixel lies (C8); `model`: the given one with corrections,
/// `point`: by that model. Zero for coefficients that the lens lacks.
ByIntrinsics point_by_intrinsics(const CameraModel& given, const CameraModel& model, const Eigen::Vector2d& point);

/// How many coefficients of the lens are corrected.
int corrected_coefficients(const CameraModel& camera);

/// The point by `model` of the pixel that `given` sees at `point`; the two are within a few percent of each other.
Eigen::Vector2d point_by(const CameraModel& model, const CameraModel& given, const Eigen::Vector2d& point);

/// The model with corrections; nothing where no lens has them, such as a distortion that is not monotone.
std::optional<CameraModel> corrected_model(const CameraModel& given, const IntrinsicsCorrection& correction);

/// The model of an image that shows what a lens sees, such as an undistorted one, where the lens has corrections. A
/// radtan fit to the points of its pixels, to a pixel at the corners of corrections of 1 %. Nothing where no lens has
/// them.
std::optional<CameraModel> corrected_image_model(const CameraModel& image, const CameraModel& given,
                                                 const IntrinsicsCorrection& correction);

}  // namespace edged
