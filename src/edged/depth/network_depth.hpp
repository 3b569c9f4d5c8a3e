// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The scene depth of the central region by a network, from windows of events.
#pragma once

#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "edged/depth/depth_filter.hpp"
#include "edged/depth/latest_window.hpp"
#include "edged/depth/network.hpp"
#include "edged/options/depth.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Cuts the events into windows of the model's length and runs the network at the end of each. Only the pixels around
/// the central region reach it. Depths are scaled by the ratio of the focal lengths, at which the images are equal. In
/// its own thread, a depth takes effect at the first add_events after it is computed; its stamp is that of its events.
class NetworkDepth : public DepthPrior {
 public:
  /// Throws InputError when the model cannot be used or the image is too small for it.
  NetworkDepth(const CameraModel& camera, double region_share, const NetworkDepthConfig& config,
               const DepthFilterConfig& filter, Inference inference = Inference::Synchronous);

  void add_events(std::span<const Event> events) override;
  std::optional<DepthEstimate> at(Timestamp t) const override { return filter_.at(t); }

  const DepthModel& model() const { return network_.model(); }
  /// The last measurement, before validity and smoothing.
  const std::optional<DepthEstimate>& measured() const { return measured_; }
  /// Number of windows that the network has processed.
  int inferences() const { return inferences_; }
  /// Waits for a network in its own thread, and takes its measurements.
  void finish();

 private:
  void end_window();
  std::optional<DepthEstimate> measure(const std::vector<Event>& window);
  void take(const DepthEstimate& measured);

  NetworkDepthConfig config_;
  DepthNetwork network_;
  cv::Rect seen_, region_;  // of the image; region_ within seen_
  double scale_ = 1.0;
  Duration window_;
  std::vector<Event> events_;  // of the open window
  std::optional<DepthEstimate> measured_;
  DepthFilter filter_;
  int inferences_ = 0;
  std::optional<Timestamp> seen_until_;       // by measure
  std::optional<LatestWindowThread> thread_;  // last member: it runs measure
};

}  // namespace edged
