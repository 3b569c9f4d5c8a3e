// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The interface of scene depth sources, and the constant depth.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "edged/measurement.hpp"

namespace edged {

/// The scene depth d_t of the central region (paper section on the depth module; Eq. 4, 5).
struct DepthEstimate {
  Timestamp t;             ///< stamp of the newest measurement used, not of the computation
  double depth_m = 0.0;    ///< median z-depth of the region
  double sigma_ln = 0.0;   ///< standard deviation of ln depth_m, growing with the estimate's age
  double spread_ln = 0.0;  ///< robust deviation of ln depth within the region, 0 where not known
};

/// A landmark observed at some instant.
struct SeenDepth {
  Eigen::Vector2d point = Eigen::Vector2d::Zero();  ///< undistorted, on the unit plane of the event camera
  double depth_m = 0.0;                             ///< z-depth in the event camera
};

/// Takes the measurements that its kind uses (others are ignored) and returns the depth at any later time. All stamps
/// are on one clock, the caller's choice, and go forward; measurements older than the newest of their kind are ignored.
/// Deterministic: the same feed gives the same bits (except a network in its own thread, Inference::OwnThread).
class DepthPrior {
 public:
  virtual ~DepthPrior() = default;

  /// Events in time order, raw pixels.
  virtual void add_events(std::span<const Event>) {}

  /// All landmarks in view at t; those outside the central region are ignored.
  virtual void add_landmarks(Timestamp, std::span<const SeenDepth>) {}

  /// The newest valid estimate until it expires; nothing without one.
  virtual std::optional<DepthEstimate> at(Timestamp t) const = 0;
};

/// A constant depth.
class ConstantDepth : public DepthPrior {
 public:
  ConstantDepth(double depth_m, double sigma_ln) : depth_m_(depth_m), sigma_ln_(sigma_ln) {}
  std::optional<DepthEstimate> at(Timestamp t) const override { return DepthEstimate{t, depth_m_, sigma_ln_, 0.0}; }

 private:
  double depth_m_, sigma_ln_;
};

}  // namespace edged
