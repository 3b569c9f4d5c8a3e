// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The constants of the pipeline that are no options: unit, effect, and where each value comes from.
#pragma once

#include <chrono>
#include <cstddef>

#include "edged/time.hpp"

namespace edged {

/// Decisions are those of docs/decisions.
struct PipelineTuning {
  // Stamps (decisions 007, 008): working sensors have no such jumps and gaps.
  Duration clock_jump = std::chrono::seconds(1);  ///< stamps that are so far behind, or sensors apart: other clocks
  Duration clock_confirmation =
      std::chrono::milliseconds(500);  ///< span of such stamps after which the clock counts as set back
  double max_gap_s = 0.2;  ///< of all sensors: no packets are cut by time inside, and the map is searched anew
  Duration imu_history = std::chrono::seconds(20);  ///< IMU samples kept before the first packet or estimate
  // Packets (decision 010).
  Duration synchronized = std::chrono::milliseconds(1);  ///< frames of several cameras within this belong together
  Duration max_frame_period = std::chrono::milliseconds(500);  ///< slower frames are not waited for
  Duration frame_heartbeat = std::chrono::seconds(5);  ///< between packets without any frame: vision is lost before
  // Memory: far above what working sensors queue.
  std::size_t max_queued_bytes = std::size_t{256} << 20U;  ///< events and frames in the sequencer
  std::size_t max_queued_samples = 1'000'000;              ///< samples of each other sensor in the sequencer
  std::size_t max_burst_events = 4'000'000;  ///< of a camera within burst; one that fires all pixels at once: a million
  Duration burst = std::chrono::milliseconds(30);  ///< cuts by events are not closer
  std::size_t max_waiting_packets = 256;           ///< packets without their IMU samples
  std::size_t max_waiting_external = 100'000;      ///< external samples without their packet

  // Event frames (decisions 003, 013).
  double max_parallax_px = 5.0;        ///< image motion by translation over the events of one event frame
  double static_rate_per_pixel = 1.2;  ///< event rate below which the scene is static [1/s]
  double static_rate_rise = 4.0;       ///< times the least rate before: it moves [021]
  double least_rate_memory_s = 5.0;    ///< in which the least rate grows by a factor e
  double noise_rate_per_pixel = 0.05;  ///< the least rate of noise [1/s]
  double subsampled_width_px = 400.0;  ///< beside good frames each n-th event of sensors n times as wide is rendered
  double min_structure = 1.2;          ///< least structure of an event frame that is tracked; noise alone has 1
  double max_alignment_px = 3.0;       ///< bound of the alignment correction
  Duration frames_missing_after = std::chrono::milliseconds(300);  ///< after it event frames keep all their features
  Duration max_depth_age =
      std::chrono::milliseconds(500);  ///< oldest depth in Eq. 5: one that is held is no measurement
  // Features of several cameras (decisions 041, 045).
  double followed_epipolar_factor =
      1.5;  ///< a match that is followed may be so much farther from its line than a new one
  double correlated_sigma_factor = 3.0;  ///< sigma of a feature on event frames that a frame camera follows, too
  // Exposure under lamps (decision 044).
  std::size_t exposure_min_features = 8;
  double exposure_memory_s = 5.0;         ///< after which an old measurement of the coefficients no longer counts
  double exposure_prior_s = 1e-3;         ///< sigma of a coefficient before anything is measured
  double exposure_motion_sigma = 1.5e-4;  ///< sigma of the common displacement of all features: 0.03 px of a usual lens

  // Status (decision 023).
  double strain_limit_growth = 1.5;  ///< factor on the limits of strain after each loss by it
  double max_bias_change = 3.0;      ///< [sigma]; up to 2.1 without dynamic objects
  double gyro_drift = 2e-3;          ///< drift of a bias with the temperature, beyond the noise of a data sheet [rad/s]
  double accel_drift = 0.02;         ///< drift of the accelerometer's bias [m/s^2]
  Duration judged = std::chrono::seconds(10);  ///< of biases, by their changes, and of motion, by which the scale is
  double least_travel_m = 0.15;                ///< of a shorter way the share does not matter: a fifth of it is 3 cm
  double velocity_share = 0.1;                 ///< of the speed: so uncertain may the velocity be as well
  double unknown_velocity = 1.5;               ///< [m/s] sigma; for so long: Lost
  Duration velocity_unknown_after = std::chrono::milliseconds(500);  ///< cameras need up to 0.3 s after a gap
  /// Of frames and IMU; beyond it Lost: a hand or a drone may have turned by the view. newest_state predicts no
  /// further.
  double longest_gap_s = 1.0;
  // Localization.
  Duration covariance_interval = std::chrono::milliseconds(100);  ///< it costs a third of an optimization
  Duration dead_reckoning = std::chrono::seconds(10);             ///< after a loss of vision (decision 015)
  double min_frame_tracks_for_map = 20.0;  ///< with fewer effective tracks on frames the map uses event frames
  double max_unsupported_s = 0.2;  ///< with localize_only, without landmarks or rest: an event frame holds 0.25 s
};
inline constexpr PipelineTuning kPipelineTuning;

}  // namespace edged
