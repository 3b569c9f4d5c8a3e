// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/stereo_agreement.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/frontend/detector.hpp"
#include "edged/frontend/stereo_matcher.hpp"

namespace edged {
namespace {

constexpr int kComparisons = 6, kCornersCompared = 40;
constexpr Duration kBetween = std::chrono::seconds(1), kOneInstant = std::chrono::milliseconds(1);
constexpr Duration kExposure = std::chrono::milliseconds(30);
constexpr int kGreyOfEvent = 60;
// By chance a corner matches along a wrong epipolar line, too.
constexpr int kFewestMatches = 30, kTimesMore = 3;

}  // namespace

StereoAgreement::StereoAgreement(std::span<const RigCamera> cameras) {
  for (const RigCamera& camera : cameras) {
    if (std::ranges::count(cameras, camera.modality, &RigCamera::modality) < 2) continue;
    const auto first =
        std::ranges::find(cameras_, camera.modality, [](const Camera& one) { return one.given.modality; });
    cameras_.push_back({camera, static_cast<std::size_t>(first - cameras_.begin())});
  }
}

void StereoAgreement::add(const Measurement& measurement) {
  const std::string* name = camera_of(measurement);
  if (name == nullptr) return;
  const auto camera = std::ranges::find(cameras_, *name, [](const Camera& one) { return one.given.name; });
  if (camera == cameras_.end()) return;
  if (const auto* frame = std::get_if<Frame>(&measurement)) show(*camera, *frame);
  if (const auto* batch = std::get_if<EventBatch>(&measurement)) count(*camera, *batch);
}

/// The images of events begin with the seconds of the IMU clock, in all cameras.
void StereoAgreement::count(Camera& camera, const EventBatch& batch) {
  if (batch.events.empty()) return;
  const auto since_begin = [&](const Event& event) {
    return (event.t + camera.given.time_offset).time_since_epoch() % kBetween;
  };
  const bool within = since_begin(batch.events.front()) < kExposure;
  if (!within && camera.counts.empty()) return;
  if (!within) {
    const Event& event = batch.events.front();
    return show(camera, {event.t - since_begin(event), camera.given.name, std::exchange(camera.counts, {})});
  }
  if (camera.counts.empty())
    camera.counts = cv::Mat::zeros(camera.given.model.height(), camera.given.model.width(), CV_8U);
  for (const Event& event : batch.events)
    if (event.x < camera.counts.cols && event.y < camera.counts.rows && since_begin(event) < kExposure)
      camera.counts.at<std::uint8_t>(event.y, event.x) =
          cv::saturate_cast<std::uint8_t>(camera.counts.at<std::uint8_t>(event.y, event.x) + kGreyOfEvent);
}

void StereoAgreement::show(Camera& camera, Frame image) {
  camera.image = std::move(image);
  for (Camera& other : cameras_) {
    const Camera& first = cameras_[other.first];
    if (&other != &first && (&other == &camera || &first == &camera)) compare(first, other);
  }
}

void StereoAgreement::compare(const Camera& one, Camera& other) {
  const cv::Size size(one.given.model.width(), one.given.model.height());
  const Duration apart = other.image.t + other.given.time_offset - (one.image.t + one.given.time_offset);
  if (std::chrono::abs(apart) > kOneInstant || other.image.t < other.due || other.compared == kComparisons) return;
  if (one.image.image.size() != size || other.image.image.size() != size) return;
  if (other.given.model.width() != size.width || other.given.model.height() != size.height) return;
  other.due = other.image.t + kBetween;
  ++other.compared;
  const SE3 T_other_one = other.given.T_B_C.inverse() * one.given.T_B_C;
  const StereoMatcher given({one.given.model, one.image.image}, {other.given.model, other.image.image}, T_other_one,
                            {});
  const StereoMatcher exchanged({other.given.model, one.image.image}, {one.given.model, other.image.image},
                                T_other_one.inverse(), {});
  for (const Corner& corner : detect_corners(one.image.image, {}, kCornersCompared, {})) {
    other.as_given += given.match(corner.pixel, std::nullopt).has_value();
    other.exchanged += exchanged.match(corner.pixel, std::nullopt).has_value();
  }
}

std::vector<std::string> StereoAgreement::exchanged() const {
  std::vector<std::string> pairs;
  for (const Camera& other : cameras_) {
    if (other.exchanged >= kFewestMatches && other.exchanged > kTimesMore * other.as_given)
      pairs.push_back(fmt::format("{} and {}", cameras_[other.first].given.name, other.given.name));
  }
  return pairs;
}

}  // namespace edged
