// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The entry point of the library: measurements in, steps out.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "edged/counters.hpp"
#include "edged/final_trajectory.hpp"
#include "edged/imu_noise.hpp"
#include "edged/input_error.hpp"
#include "edged/measurement.hpp"
#include "edged/options.hpp"
#include "edged/rig.hpp"
#include "edged/state.hpp"
#include "edged/step.hpp"
#include "edged/time.hpp"
#include "edged/timing.hpp"

namespace edged {

/// One rig, one mode, from the first measurement to the last:
///
///   odometry.add(measurement);
///   while (const std::optional<Step> step = odometry.next()) show(step->state);
///
/// add, finish, newest_state and state_at may be called from any thread, all else from one. Deterministic: the same
/// measurements of each sensor give the same bits, whatever the lags between sensors within their delays. The exception
/// is a depth network with a thread of its own. Prints nothing.
class Odometry {
 public:
  /// Throws InputError when the rig lacks a camera that the mode needs, an option is out of its range or contradicts
  /// another, or the noise of the IMU is invalid.
  Odometry(const Rig& rig, const ImuNoise& imu_noise, Mode mode, const OdometryConfig& config = {},
           const FeedConfig& feed = {});
  ~Odometry();
  Odometry(Odometry&& other) noexcept;  ///< `other` may only be destroyed or assigned to
  Odometry& operator=(Odometry&& other) noexcept;

  /// Stamps as recorded, each sensor's own in order. Never throws on data: unusable measurements are dropped and
  /// counted, as are those that arrive later than the delay of their sensor allows, or while the queue is full because
  /// next() has not been called. If a clock jumps back by more than a second and stays there, the estimate is lost and
  /// the estimator restarts in the new time. Images that own their pixels are not copied: do not write into them
  /// afterwards.
  void add(Measurement measurement);
  /// Marks the end of the measurements: next() returns the remaining steps.
  void finish();
  /// The result of the next packet, once all its measurements have arrived; nothing: add more. Does not block. Lost
  /// tracking is a status, no error.
  std::optional<Step> next();

  /// Loads a map that save_map of an earlier run returned. Call it before the first measurement. Poses are in a frame
  /// of this run's own until the body is relocalized in the map; from the step with `relocalized` they are in the frame
  /// of the map. Throws InputError if the bytes are damaged or of another version, no camera of this mode fits, or
  /// measurements have been added already.
  void load_map(std::string_view bytes);
  /// A map was loaded, and the body has not been relocalized in it yet.
  bool awaiting_relocalization() const;
  /// The map, for load_map. Nothing while awaiting_relocalization().
  std::optional<std::string> save_map() const;

  /// The state at the newest IMU sample, or at any time since the newest step: predicted from that step by the samples
  /// since, in a few microseconds. Nothing without an estimate, or more than a second after it.
  std::optional<NavState> newest_state() const;
  std::optional<NavState> state_at(Timestamp t) const;

  /// The final trajectory and the map: a joint optimization of all keyframes by all measurements so far. Call it after
  /// the last step. Not causal. It takes about a second, and its record two megabytes, for a minute of flight.
  FinalTrajectory final_trajectory(const OptimizationProgress& progress = {}) const;

  /// The cameras of the mode with their present online calibration: lens, pose relative to the body, and total time
  /// offset.
  Rig rig() const;
  /// Covariance of the online calibration of a camera; nothing without an estimate.
  std::optional<CalibrationCovariance> calibration_covariance(const std::string& camera) const;

  OdometryCounters counters() const;
  /// "packetize", "process", and the stages of the latter.
  const StageTimings& timings() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Feeds the odometry all measurements of `source` and passes each step to `observe`, which returns whether to go on.
void drive(Odometry& odometry, const std::function<std::optional<Measurement>()>& source,
           const std::function<bool(Step)>& observe);

}  // namespace edged
