// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Tracks features by optical flow (KLT), and aligns them to their reference patches.
#pragma once

#include <cstddef>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "edged/frontend/klt.hpp"
#include "edged/frontend/patches/reference_patches.hpp"
#include "edged/frontend/tracker.hpp"

namespace edged {

class KltTracker : public FeatureTracker {
 public:
  KltTracker(std::string camera_name, const CameraModel& camera, const TrackerConfig& config);

  void mark_keyframe() override;
  void reset() override;

 protected:
  TrackMatches match(const TrackInput& input) override;
  void learn(const TrackInput& input, const TrackMatches& matches) override;

 private:
  struct Matches : TrackMatches {
    std::vector<char> matches_reference;  ///< set to the position that matches the reference patch
  };

  Matches match_all(const TrackInput& input) const;
  Matches match_once(const TrackInput& input) const;
  /// The i-th track in the newest image.
  FeatureMotion motion_of(const TrackInput& input, std::size_t i, const TrackMatches& matches) const;
  bool align(const TrackInput& input, std::size_t i, Matches& matches) const;
  void match_back(const std::vector<std::size_t>& which, Matches& matches) const;

  ReferencePatches reference_patches_;
  BrightnessIncrements increments_;  // of the newest image
  ImagePyramid previous_, current_;  // current_ is the newest only while track runs
  std::vector<cv::Point2f> from_;    // pixels of the tracks in previous_
  Matches matches_;                  // in the newest image
};

}  // namespace edged
