// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/descriptor.hpp"

#include <cstring>
#include <opencv2/features2d.hpp>

namespace edged {

/// Without an instruction that counts bits, which not every x86-64 has: counts in fields of 2, 4 and 8 bits side by
/// side.
int distance(const Descriptor& a, const Descriptor& b) {
  constexpr std::uint64_t kTwos = 0x3333333333333333, kFours = 0x0f0f0f0f0f0f0f0f, kEights = 0x00ff00ff00ff00ff;
  std::uint64_t eights = 0;  // at most 32 in each
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::uint64_t bits = a[i] ^ b[i];
    bits -= (bits >> 1) & 0x5555555555555555;
    bits = (bits & kTwos) + ((bits >> 2) & kTwos);
    eights += (bits + (bits >> 4)) & kFours;
  }
  const std::uint64_t sixteens = (eights & kEights) + ((eights >> 8) & kEights);
  return static_cast<int>((sixteens * 0x0001000100010001) >> 48);
}

std::vector<std::optional<Descriptor>> describe(const cv::Mat& image, std::span<const Eigen::Vector2d> pixels,
                                                std::span<const std::optional<float>> angles_deg, int border_px) {
  constexpr float kSize_px = 31.0F;
  std::vector<cv::KeyPoint> features;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (angles_deg[i])
      features.emplace_back(static_cast<float>(pixels[i].x()), static_cast<float>(pixels[i].y()), kSize_px,
                            *angles_deg[i], 0.0F, 0, static_cast<int>(i));
  }
  cv::Mat rows;
  if (!features.empty()) cv::ORB::create(500, 1.2F, 1, border_px)->compute(image, features, rows);
  std::vector<std::optional<Descriptor>> descriptors(pixels.size());
  for (int row = 0; row < rows.rows; ++row) {
    Descriptor& descriptor = descriptors[static_cast<std::size_t>(features[row].class_id)].emplace();
    std::memcpy(descriptor.data(), rows.ptr(row), sizeof(Descriptor));
  }
  return descriptors;
}

}  // namespace edged
