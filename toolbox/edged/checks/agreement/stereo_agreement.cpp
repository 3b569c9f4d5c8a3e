// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/stereo_agreement.hpp"

#include <spdlog/fmt/fmt.h>

#include "edged/frontend/detector.hpp"
#include "edged/frontend/stereo_matcher.hpp"

namespace edged {
namespace {

constexpr int kComparisons = 6, kCornersCompared = 40;
constexpr Duration kBetween = std::chrono::seconds(1), kOneInstant = std::chrono::milliseconds(1);
// By chance a corner matches along a wrong epipolar line, too.
constexpr int kFewestMatches = 30, kTimesMore = 3;

}  // namespace

StereoAgreement::StereoAgreement(std::span<const RigCamera> cameras) {
  for (const RigCamera& camera : cameras) {
    if (camera.modality != Modality::Frames) continue;
    if (first_)
      others_.push_back({camera});
    else
      first_ = camera;
  }
}

void StereoAgreement::add(const Measurement& measurement) {
  const auto* frame = std::get_if<Frame>(&measurement);
  if (frame == nullptr || others_.empty()) return;
  if (frame->camera == first_->name) image_ = *frame;
  for (Other& other : others_)
    if (frame->camera == other.camera.name) compare(*frame, other);
}

void StereoAgreement::compare(const Frame& frame, Other& other) const {
  const CameraModel &one = first_->model, &two = other.camera.model;
  const cv::Size size(one.width(), one.height());
  const Duration apart = frame.t + other.camera.time_offset - (image_.t + first_->time_offset);
  if (std::chrono::abs(apart) > kOneInstant || frame.t < other.due || other.compared == kComparisons) return;
  if (image_.image.size() != size || frame.image.size() != size || cv::Size(two.width(), two.height()) != size) return;
  other.due = frame.t + kBetween;
  ++other.compared;
  const SE3 T_two_one = other.camera.T_B_C.inverse() * first_->T_B_C;
  const StereoMatcher given({one, image_.image}, {two, frame.image}, T_two_one, {});
  const StereoMatcher exchanged({two, image_.image}, {one, frame.image}, T_two_one.inverse(), {});
  for (const Corner& corner : detect_corners(image_.image, {}, kCornersCompared, {})) {
    other.as_given += given.match(corner.pixel, std::nullopt).has_value();
    other.exchanged += exchanged.match(corner.pixel, std::nullopt).has_value();
  }
}

std::vector<std::string> StereoAgreement::exchanged() const {
  std::vector<std::string> pairs;
  for (const Other& other : others_)
    if (other.exchanged >= kFewestMatches && other.exchanged > kTimesMore * other.as_given)
      pairs.push_back(fmt::format("{} and {}", first_->name, other.camera.name));
  return pairs;
}

}  // namespace edged
