// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Tracks features by their descriptors: corners of the next image with similar surroundings.
#pragma once

#include <opencv2/core/mat.hpp>

#include "edged/frontend/tracker.hpp"

namespace edged {

/// ORB descriptors without orientation: a camera rolls little from image to image. A track goes on where the corner
/// near its expected position with the most similar descriptor is clearly more similar than the second best (Lowe,
/// 2004). Corners are found anew in each image, at whole pixels: tracks do not drift, but are less accurate than those
/// of optical flow.
class DescriptorTracker : public FeatureTracker {
 public:
  using FeatureTracker::FeatureTracker;

  void reset() override;

 protected:
  TrackMatches match(const TrackInput& input) override;
  void learn(const TrackInput& input, const TrackMatches& matches) override;

 private:
  cv::Mat previous_;
};

}  // namespace edged
