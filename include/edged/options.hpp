// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What can be chosen: the mode, every option of the odometry, grouped by the part that owns it, and how it is fed.
#pragma once

#include <string>

#include "edged/config.hpp"
#include "edged/options/depth.hpp"
#include "edged/options/estimator.hpp"
#include "edged/options/events.hpp"
#include "edged/options/frontend.hpp"
#include "edged/options/map.hpp"

namespace edged {

enum class Mode { Events, Frames, Fused };

/// "events", "frames" or "fused".
std::string mode_name(Mode mode);

/// The mode of that name. Throws InputError that lists them.
Mode parse_mode(const std::string& name);

/// When a packet is cut (ARCHITECTURE.md, section 4).
struct PacketizerConfig {
  double events_per_pixel = 0.35;      ///< a packet is cut after this many new events per pixel
  double window_per_pixel = 0.35;      ///< events a packet carries back in time, per pixel
  double max_age_s = 0.25;             ///< but none older than this: at standstill the old ones are noise
  double max_interval_s = 0.04;        ///< a cut at the latest after this time (the heartbeat at standstill)
  double min_interval_s = 0.03;        ///< and never sooner than this after the last, but for a frame
  int max_waiting_events = 4'000'000;  ///< in packets that wait for the IMU; 16 bytes each
  void visit(ConfigFields& fields);
};

/// The running mean of delta x_last, paper Eq. 2.
struct AlignmentConfig {
  double gain = 0.0;    ///< weight of the newest image; 0: off
  double max_px = 3.0;  ///< bound of the mean
};

/// How what a camera gives is weighed by what becomes of its tracks.
struct HealthConfig {
  double time_constant_s = 0.3;    ///< of the running mean of the share of tracks that survive an image
  double min_survival_rate = 0.4;  ///< below it the camera's observations are ignored
  int min_event_features = 40;     ///< kept on event frames where the standard frames carry all of theirs

  void visit(ConfigFields& fields);
};

struct StatusConfig {
  double degraded_after_s = 0.7;  ///< without enough landmarks or rest
  double lost_after_s = 2.5;
  int min_landmarks = 8;          ///< seen by the newest state, for a Good pose
  double degraded_strain = 0.75;  ///< EstimatorResult::imu_strain [sigma]: usual is 0.05 to 0.4
  double lost_strain = 0.85;      ///< the first time; see StatusJudge
  void visit(ConfigFields& fields);
};

struct OdometryConfig {
  OdometryConfig();

  std::string cameras;  ///< names, separated by commas; empty: the rig's first of each kind that the mode uses
  PacketizerConfig packets;
  EventFrameConfig event_frame;
  EnhanceConfig enhance;
  bool enhance_detect = true;  ///< find features on the enhanced event frame
  bool enhance_track = false;  ///< follow them on it too
  AlignmentConfig alignment;   ///< of the event frames
  HealthConfig health;         ///< of each camera
  LowLightConfig low_light;    ///< standard frames in the dark
  TrackerConfig event_tracker;
  TrackerConfig frame_tracker;
  KeyframeConfig keyframes;
  DepthConfig depth;
  EstimatorConfig estimator;
  MapConfig map;
  double quiet_rate_per_pixel = 1.2;  ///< event rate [1/s/px] below which nothing moves in view
  double max_travel_px = 5.0;         ///< image motion by translation over the events of one event frame
  double thin_width_px = 400.0;       ///< beside good frames events of sensors twice as wide and more are thinned
  double min_events_per_pixel = 0.1;  ///< a packet with fewer events draws no event frame
  StatusConfig status;

  void visit(ConfigFields& fields);

  /// Throws InputError with the reason when an option is out of its range or contradicts another.
  void validate() const;

 private:
  void declare(ConfigFields& fields);
};

/// By how much the measurements of a sensor may lag behind the newest of all, stamp against stamp [s]. A sensor that
/// delivers is waited for no longer than until it has passed what waits, so that the delay costs latency only where it
/// is silent or slow: of the frames, those packets of events that lie between two of them. The defaults hold for what
/// drivers usually do: event cameras come in USB packets of up to 33 ms, a frame a readout after its exposure's middle.
struct SensorDelays {
  double events_s = 0.05, frames_s = 0.05, imu_s = 0.05;

  /// Throws InputError when one is not within 0 .. 10 s.
  void validate() const;
  bool operator==(const SensorDelays&) const = default;
};

/// Measurements come in the order that Dataset promises: nothing is waited for.
inline constexpr SensorDelays kInOrder{0.0, 0.0, 0.0};

/// How the odometry is fed and worked. The defaults are for sensors whose drivers have a thread each; a recording,
/// which is in order, is `{kInOrder}`.
struct FeedConfig {
  SensorDelays delays;
  Inference inference = Inference::Synchronous;  ///< OwnThread: the depth network never keeps the others waiting
};

}  // namespace edged
