// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/trackers/klt_tracker.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/frontend/tuning.hpp"

namespace edged {
namespace {

template <typename T>
std::vector<T> select(const std::vector<T>& values, const std::vector<std::size_t>& indices) {
  std::vector<T> selected;
  selected.reserve(indices.size());
  for (const std::size_t i : indices) selected.push_back(values[i]);
  return selected;
}

}  // namespace

KltTracker::KltTracker(std::string camera_name, const CameraModel& camera, const TrackerConfig& config)
    : FeatureTracker(std::move(camera_name), camera, config),
      reference_patches_(camera, config.reference_patches.patch) {
  if (config.klt.window_px % 2 == 0) {
    throw InputError::format("klt.window_px = {} must be odd, e.g. {}", config.klt.window_px, config.klt.window_px + 1);
  }
}

TrackMatches KltTracker::match(const TrackInput& input) {
  current_.build(input.image, config().klt);
  increments_ = input.prediction ? input.prediction->increments : BrightnessIncrements();
  if (input.prediction && input.prediction->reference_patches) {
    reference_patches_.move(input.prediction->T_cur_prev);
  } else {
    reference_patches_.clear();
  }
  from_.clear();
  for (const Track& track : tracks()) from_.push_back(to_cv(track.pixel));
  matches_ = tracks().empty() ? Matches() : match_all(input);
  return matches_;
}

void KltTracker::learn(const TrackInput& input, const TrackMatches& matches) {
  for (std::size_t i = 0; i < tracks().size(); ++i) {
    if (!matches.kept[i]) continue;
    const FeatureId id = tracks()[i].id;
    reference_patches_.set_fits(id, matches_.matches_reference[i]);
    if (input.prediction && !matches.prediction_failed) {
      reference_patches_.update_gradient(id, {current_.image(), increments_}, motion_of(input, i, matches),
                                         matches_.matches_reference[i]);
    }
  }
  std::swap(previous_, current_);
}

void KltTracker::mark_keyframe() {
  FeatureTracker::mark_keyframe();
  if (config().reference_patches.enabled) reference_patches_.extract({previous_.image(), increments_}, tracks());
}

void KltTracker::reset() {
  FeatureTracker::reset();
  previous_.clear();
  reference_patches_.clear();
}

FeatureMotion KltTracker::motion_of(const TrackInput& input, std::size_t i, const TrackMatches& matches) const {
  const Eigen::Vector2d pixel = to_eigen(matches.points[i]);
  return {pixel, pixel - tracks()[i].pixel, input.expected_C[i]};
}

KltTracker::Matches KltTracker::match_all(const TrackInput& input) const {
  Matches matches = match_once(input);
  const auto kept = [](const Matches& m) { return std::ranges::count(m.kept, 1); };
  const auto all = static_cast<double>(from_.size());
  if (input.prediction && all - static_cast<double>(kept(matches)) > kFrontendTuning.retry_share * all) {
    // The few tracks that survive a bad prediction are likely wrong, and so is its warp: all are tracked again without
    // it.
    Matches again = match_once({input.image, nullptr, {}, from_});
    again.prediction_failed = kept(again) > kept(matches);
    if (again.prediction_failed) return again;
  }
  return matches;
}

KltTracker::Matches KltTracker::match_once(const TrackInput& input) const {
  const std::vector<cv::Point2f>& seeds = input.seeds;
  Matches matches{{seeds, std::vector<char>(seeds.size(), 0)}, std::vector<char>(seeds.size(), 0)};
  // On event frames the predicted position is a better start of the alignment than that of the optical flow, which
  // follows the appearance of an edge under the motion.
  const bool on_events = !increments_.image.empty();
  std::vector<std::size_t> unaligned;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    if (!camera().contains(to_eigen(seeds[i]))) continue;  // NaN, too
    if (!on_events || !align(input, i, matches)) unaligned.push_back(i);
  }
  const bool aligned_later = input.prediction && !reference_patches_.empty();
  const int levels = config().klt.levels;
  const Flow forward =
      follow(previous_, current_, select(from_, unaligned), select(seeds, unaligned),
             aligned_later ? std::min(kFrontendTuning.predicted_top_level, levels - 1) : levels - 1, config().klt,
             aligned_later ? kFrontendTuning.coarse_flow_step_px : kFrontendTuning.flow_step_px);
  std::vector<std::size_t> otherwise;  // matches, or has no reference patch
  for (std::size_t k = 0; k < unaligned.size(); ++k) {
    const std::size_t i = unaligned[k];
    matches.points[i] = forward.points[k];
    const bool inside = camera().contains(to_eigen(forward.points[k]), kFrontendTuning.border_px);
    matches.kept[i] = inside && forward.found[k];
    if (matches.kept[i] && !align(input, i, matches)) otherwise.push_back(i);
  }
  match_back(otherwise, matches);
  return matches;
}

/// To the reference patch of the track, near the present match. False if it does not match there.
bool KltTracker::align(const TrackInput& input, std::size_t i, Matches& matches) const {
  if (!input.prediction) return false;
  const std::optional<Eigen::Vector2d> aligned =
      reference_patches_.align(tracks()[i].id, {current_.image(), increments_}, motion_of(input, i, matches));
  if (!aligned || !camera().contains(*aligned, kFrontendTuning.border_px)) return false;
  matches.points[i] = to_cv(*aligned);
  matches.kept[i] = 1;
  matches.matches_reference[i] = 1;
  return true;
}

/// Tracks that no reference patch confirms must pass the forward-backward check and the correlation with the last
/// image.
void KltTracker::match_back(const std::vector<std::size_t>& which, Matches& matches) const {
  const Flow backward = follow(current_, previous_, select(matches.points, which), select(from_, which),
                               kFrontendTuning.predicted_top_level, config().klt);
  for (std::size_t k = 0; k < which.size(); ++k) {
    const std::size_t i = which[k];
    matches.kept[i] =
        backward.found[k] && distance(backward.points[k], from_[i]) <= config().forward_backward_px &&
        patch_correlation(previous_.image(), from_[i], current_.image(), matches.points[i]) >= config().min_correlation;
  }
}

}  // namespace edged
