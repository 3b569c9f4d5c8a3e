// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/dimmed_frames.hpp"

#include <algorithm>
#include <opencv2/core.hpp>
#include <utility>

#include "edged/sim/sensors/frame_camera.hpp"

namespace edged {
namespace {

constexpr std::uint64_t kSeed = 1, kStream = 9;
constexpr double kElectronsPerLevel = 10000.0 / 255.0;
constexpr double kReadNoiseLevels = 1.2;

}  // namespace

DimmedFrames::DimmedFrames(std::unique_ptr<Dataset> bright, double factor)
    : bright_(std::move(bright)), factor_(factor) {}

std::optional<Measurement> DimmedFrames::next() {
  std::optional<Measurement> measurement = bright_->next();
  if (!measurement) return measurement;
  if (auto* frame = std::get_if<Frame>(&*measurement)) frame->image = dim(*frame);
  return measurement;
}

cv::Mat DimmedFrames::dim(const Frame& frame) const {
  Random random(kSeed + static_cast<std::uint64_t>(to_ns(frame.t)), kStream);
  cv::Mat_<std::uint8_t> dimmed(frame.image.size());
  const cv::Mat_<std::uint8_t> bright(frame.image);
  std::transform(bright.begin(), bright.end(), dimmed.begin(), [&](std::uint8_t level) {
    return grey_level(factor_ * level * kElectronsPerLevel, kReadNoiseLevels * kElectronsPerLevel, kElectronsPerLevel,
                      random);
  });
  return dimmed;
}

}  // namespace edged
