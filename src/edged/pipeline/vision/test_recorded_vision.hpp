// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A list of observations in place of images, for tests of what follows vision.
#pragma once

#include <algorithm>
#include <deque>
#include <set>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/pipeline/vision/vision.hpp"

namespace edged {

/// Gives one output after the other, without the features that localization has found to be outliers.
class RecordedVision : public Vision {
 public:
  explicit RecordedVision(std::deque<VisionOutput> outputs) : outputs_(std::move(outputs)) {}

  VisionOutput process(const VisionInput&) override {
    EDGED_CHECK(!outputs_.empty(), "more packets than outputs");
    VisionOutput output = std::move(outputs_.front());
    outputs_.pop_front();
    for (CameraObservations& camera : output.observations)
      std::erase_if(camera.features, [this](const FeatureObservation& seen) { return ended_.contains(seen.id); });
    return output;
  }
  void correct(const VisionCorrection& correction, const ImuPropagator&) override {
    ended_.insert(correction.outliers.begin(), correction.outliers.end());
  }
  void begin_epoch() override { ended_.clear(); }
  std::vector<CameraStep> describe(Packet, const VisionOutput&) const override { return {}; }

  /// Features that are no longer followed.
  const std::set<FeatureId>& ended() const { return ended_; }

 private:
  std::deque<VisionOutput> outputs_;
  std::set<FeatureId> ended_;
};

}  // namespace edged
