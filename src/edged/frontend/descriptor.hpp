// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Binary descriptors of features, which tell whether two images show the same place of the scene.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <vector>

namespace edged {

/// 256 comparisons of grey levels around a feature (ORB, by OpenCV).
using Descriptor = std::array<std::uint64_t, 4>;

/// Descriptors of one point differ by fewer bits.
inline constexpr int kMaxDescriptorBits = 64;

/// Number of bits that differ.
int distance(const Descriptor& a, const Descriptor& b);

/// One for each feature; nothing nearer to the image border than border_px, and where the angle is unknown. angles_deg:
/// the direction in the image that the comparisons are turned to, one for each feature.
std::vector<std::optional<Descriptor>> describe(const cv::Mat& image, std::span<const Eigen::Vector2d> pixels,
                                                std::span<const std::optional<float>> angles_deg, int border_px);

}  // namespace edged
