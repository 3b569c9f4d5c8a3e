// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The front door: measurements in, steps out.
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
/// measurements of each sensor give the same bits, however the sensors lag behind one another within their delays; but
/// for a depth network that has a thread of its own. Prints nothing.
class Odometry {
 public:
  /// Throws InputError when the rig lacks a camera that the mode needs, an option is out of its range or contradicts
  /// another, or the IMU's noise cannot be.
  Odometry(const Rig& rig, const ImuNoise& imu_noise, Mode mode, const OdometryConfig& config = {},
           const FeedConfig& feed = {});
  ~Odometry();
  Odometry(Odometry&& other) noexcept;  ///< `other` may only be destroyed or assigned to
  Odometry& operator=(Odometry&& other) noexcept;

  /// Stamps as recorded, each sensor's own in order. Never throws on data: what cannot be used is counted, as is what
  /// comes later than the delay of its sensor allows or finds no room as next() has not been called for long. Where a
  /// clock is set back by more than a second, for good, the estimate is lost and starts again in the new time. Images
  /// that own their pixels are not copied: what is written into them afterwards is seen.
  void add(Measurement measurement);
  /// No more measurements: what is left comes out of next().
  void finish();
  /// What the next packet brought, once all that it needs has come; nothing: add more. Does not wait. Lost tracking is
  /// a status.
  std::optional<Step> next();

  /// Goes on in a map that save_map of an earlier run gave, before the first measurement. Until a place of it has been
  /// recognised the poses are in a frame of this run's own; with the step that says relocalized they come into the
  /// map's. Throws InputError where the bytes are damaged or of another version, no camera of this mode fits, or it is
  /// too late.
  void load_map(std::string_view bytes);
  /// A map was loaded, and the body has not been relocalized in it yet.
  bool awaiting_relocalization() const;
  [[deprecated("use awaiting_relocalization()")]] bool elsewhere() const { return awaiting_relocalization(); }
  /// The map, for load_map. Nothing while awaiting_relocalization().
  std::optional<std::string> save_map() const;

  /// The state at the newest IMU sample, or at any time since the newest step: predicted from that by the samples that
  /// have come since, in a few microseconds. Nothing while there is no estimate to go by, and a second after it.
  std::optional<NavState> newest_state() const;
  std::optional<NavState> state_at(Timestamp t) const;

  /// The final trajectory and the map: a batch optimization over all steps and map matches so far. Call it after the
  /// last step. Without the map, or without any match, the poses are those of the steps. Not causal. It takes seconds
  /// for an hour of flight, and its record half a megabyte a minute.
  FinalTrajectory final_trajectory() const;
  [[deprecated("use final_trajectory()")]] FinalTrajectory hindsight() const { return final_trajectory(); }

  /// The cameras of the mode with their present online calibration: rotation against the body, and whole time offset.
  Rig rig() const;
  /// Covariance of the online calibration of a camera: rotation about its axes [rad], then time offset [s]. Nothing
  /// without an estimate.
  std::optional<Eigen::Matrix4d> calibration_covariance(const std::string& camera) const;

  OdometryCounters counters() const;
  /// "packetize", "process", and the stages of the latter.
  const StageTimings& timings() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Feeds the odometry all that `source` gives and shows each step to `observe`, which says whether to go on.
void drive(Odometry& odometry, const std::function<std::optional<Measurement>()>& source,
           const std::function<bool(Step)>& observe);

}  // namespace edged
