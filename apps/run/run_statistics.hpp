// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Statistics of a run, and resources of the process.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>
#include <string>

#include "common/step_numbers.hpp"
#include "edged/live/measurement_queue.hpp"
#include "edged/measurement.hpp"
#include "edged/odometry.hpp"
#include "edged/pipeline/localization/scale_uncertainty.hpp"

namespace edged {

/// Share of dropped measurements from which on it is shown during a run.
inline constexpr double kToldOverload = 0.01;

/// Counts of one run. Stamps are on the IMU clock.
class RunStatistics {
 public:
  /// A visual measurement that the mode uses: spans the time that a pose could cover.
  void add_visual(Timestamp first, Timestamp last);
  /// Adds a measurement as recorded, if it is a visual one.
  void add_visual(const Measurement& measurement, const Rig& used);
  void add(const Step& step);

  std::size_t packets() const { return packets_; }
  std::size_t poses() const { return poses_; }  ///< Good and Degraded packets
  std::size_t keyframes() const { return keyframes_; }
  std::size_t loops_closed() const { return loops_closed_; }
  std::size_t times_lost() const { return times_lost_; }
  /// Losses at which the cameras contradicted the IMU.
  std::size_t times_contradicted() const { return times_contradicted_; }
  /// First visual measurement to last [s].
  double visual_span_s() const;
  /// Time since the previous packet (the first: since the first measurement), summed over packets of that status [s].
  double time_in_s(TrackingStatus status) const { return seconds_[static_cast<std::size_t>(status)]; }
  /// Share of the visual span whose packets were Good.
  double coverage() const;
  /// From the first visual measurement to the first Good packet [s].
  std::optional<double> first_good_s() const { return first_good_s_; }
  TrackingStatus last_status() const { return last_status_; }
  /// Share of the time since the first Good packet that was Lost.
  double lost_share() const;
  /// What the last initialization waited for, and what ended the last estimate; may be empty.
  const std::string& waiting_for() const { return waiting_for_; }
  const std::string& lost_because() const { return lost_because_; }
  /// What a live run has dropped so far, as it was too slow.
  void set_dropped(const DropCounters& dropped) { dropped_ = dropped; }
  struct Overload {
    double share = 0.0;       ///< of the events or of the frames, the larger one
    bool by_reading = false;  ///< most of them are events that were not read in time
    std::string text;         ///< "93 % of the events dropped"
  };
  Overload overload() const;
  /// Relative standard deviation of the way travelled, see ScaleUncertainty; nothing if it is short.
  std::optional<double> scale_sigma() const { return scale_.sigma(); }
  /// Sigma of roll and pitch in the last packet, while Initializing; nothing without an attitude.
  std::optional<double> tilt_sigma_deg() const { return tilt_sigma_deg_; }
  /// The last estimate [m/s^2].
  const Eigen::Vector3d& accel_bias() const { return accel_bias_; }
  /// ln s of Eq. 5 at the end; nothing without the depth factor.
  const std::optional<LogScale>& ln_depth_scale() const { return ln_depth_scale_; }

 private:
  std::optional<Timestamp> first_visual_;
  Timestamp last_visual_;
  std::optional<Timestamp> last_packet_;
  DropCounters dropped_, used_;
  std::size_t packets_ = 0, poses_ = 0, keyframes_ = 0, times_lost_ = 0, times_contradicted_ = 0;
  std::size_t loops_closed_ = 0;
  std::array<double, 4> seconds_{};
  std::optional<double> first_good_s_;
  TrackingStatus last_status_ = TrackingStatus::Initializing;
  std::optional<LogScale> ln_depth_scale_;
  std::string waiting_for_, lost_because_;
  ScaleUncertainty scale_;
  std::optional<double> tilt_sigma_deg_;
  Eigen::Vector3d accel_bias_ = Eigen::Vector3d::Zero();
};

/// Wall and processor time since construction, without the pauses; peak memory since the process began.
class ResourceMeter {
 public:
  ResourceMeter();
  double wall_s() const;
  double cpu_s() const;  ///< user + system, all threads
  static double peak_rss_mb();

  /// Calls work() and excludes its resources.
  template <typename Work>
  auto without(Work work) {
    const double wall = wall_s(), cpu = cpu_s();
    auto result = work();
    paused_wall_s_ += wall_s() - wall;
    paused_cpu_s_ += cpu_s() - cpu;
    return result;
  }

 private:
  std::chrono::steady_clock::time_point wall_;
  double cpu_s_;
  double paused_wall_s_ = 0.0, paused_cpu_s_ = 0.0;
};

}  // namespace edged
