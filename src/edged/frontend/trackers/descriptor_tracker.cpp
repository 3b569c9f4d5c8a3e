// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/trackers/descriptor_tracker.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "edged/frontend/descriptor.hpp"
#include "edged/frontend/tuning.hpp"

namespace edged {
namespace {

struct DescribedPixels {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<std::optional<Descriptor>> descriptors;  ///< one for each
};

DescribedPixels described(const cv::Mat& image, std::vector<Eigen::Vector2d> pixels) {
  const std::vector<std::optional<float>> upright(pixels.size(), 0.0F);
  std::vector<std::optional<Descriptor>> descriptors = describe(image, pixels, upright, 0);
  return {std::move(pixels), std::move(descriptors)};
}

/// The candidate near the seed that is clearly the most similar one; nothing if there is none.
std::optional<Eigen::Vector2d> best_match(const Descriptor& descriptor, const Eigen::Vector2d& seed, double radius_px,
                                          const DescribedPixels& candidates) {
  double best = std::numeric_limits<double>::infinity(), second = best;
  Eigen::Vector2d found = seed;
  for (std::size_t i = 0; i < candidates.pixels.size(); ++i) {
    if (!candidates.descriptors[i] || (candidates.pixels[i] - seed).norm() > radius_px) continue;
    const double bits = distance(descriptor, *candidates.descriptors[i]);
    second = std::min(second, std::max(best, bits));
    if (bits < best) best = bits, found = candidates.pixels[i];
  }
  const bool clear = best < kMaxDescriptorBits && best < kFrontendTuning.max_descriptor_ratio * second;
  return clear ? std::optional(found) : std::nullopt;
}

}  // namespace

void DescriptorTracker::reset() {
  FeatureTracker::reset();
  previous_.release();
}

TrackMatches DescriptorTracker::match(const TrackInput& input) {
  TrackMatches matches{input.seeds, std::vector<char>(input.seeds.size(), 0)};
  if (tracks().empty() || previous_.empty()) return matches;
  std::vector<Eigen::Vector2d> last, corners;
  for (const Track& track : tracks()) last.push_back(track.pixel);
  DetectorConfig dense = config().detector;  // a track's corner need not be the strongest of its cell
  dense.cell_px = kFrontendTuning.candidate_cell_px;
  dense.separation_px = kFrontendTuning.candidate_cell_px / 2.0;
  for (const Corner& corner : detect_corners(input.image, {}, std::numeric_limits<int>::max(), dense, unused_pixels()))
    corners.push_back(corner.pixel);
  const DescribedPixels before = described(previous_, std::move(last));
  const DescribedPixels candidates = described(input.image, std::move(corners));
  const double radius_px = (input.prediction ? kFrontendTuning.predicted_search_px : kFrontendTuning.search_px) *
                           camera().width() / kFrontendTuning.reference_width_px;
  for (std::size_t i = 0; i < matches.points.size(); ++i) {
    if (!before.descriptors[i]) continue;
    const auto match = best_match(*before.descriptors[i], to_eigen(input.seeds[i]), radius_px, candidates);
    matches.kept[i] = match.has_value();
    if (match) matches.points[i] = to_cv(*match);
  }
  return matches;
}

void DescriptorTracker::learn(const TrackInput& input, const TrackMatches&) { input.image.copyTo(previous_); }

}  // namespace edged
