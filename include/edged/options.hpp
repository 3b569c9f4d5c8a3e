// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The choices of the user: the mode, every option of the odometry, grouped by the part that owns it, and how it is fed.
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

/// When a packet is cut (docs/decisions/input/010-packet-rule.md).
struct PacketizerConfig {
  double events_per_pixel = 0.35;      ///< a packet is cut after this many new events per pixel
  double window_per_pixel = 0.35;      ///< events that a packet repeats from those before it, per pixel
  double max_age_s = 0.25;             ///< but none older than this: at standstill older ones are noise
  double max_interval_s = 0.04;        ///< longest time between two cuts (at standstill)
  double min_interval_s = 0.03;        ///< shortest time between two cuts, unless a frame arrives
  bool remove_flicker = true;          ///< leave out events that lamps cause (docs/decisions/vision/044-flicker.md)
  int max_waiting_events = 4'000'000;  ///< in packets that wait for the IMU; 16 bytes each
  void visit(ConfigFields& fields);
};

/// The running mean of delta x_last, paper Eq. 2.
struct AlignmentConfig {
  double gain = 0.0;  ///< weight of the newest image; 0: off
  void visit(ConfigFields& fields);
};

/// How the observations of a camera are weighted by the survival rate of its tracks.
struct HealthConfig {
  double time_constant_s = 0.3;    ///< memory of the mean share of tracks that survive an image
  double min_survival_rate = 0.4;  ///< below it the camera's observations are ignored
  int min_event_features = 40;     ///< features kept on event frames while the standard frames have all of theirs

  void visit(ConfigFields& fields);
};

struct StatusConfig {
  double degraded_after_s = 0.7;  ///< without enough landmarks or rest
  double lost_after_s = 2.5;
  int min_landmarks = 8;            ///< landmarks that the newest state must observe for a Good pose
  double degraded_strain = 0.75;    ///< EstimatorResult::imu_strain [sigma]: usual is 0.05 to 0.4
  double lost_strain = 0.85;        ///< the first time; see StatusMonitor
  double max_scale_sigma = 0.2;     ///< relative, see ScaleUncertainty
  double max_place_sigma = 0.15;    ///< [m] after a gap or a loss
  double max_velocity_sigma = 0.3;  ///< [m/s] usual is below 0.2 in the gentlest motion
  void visit(ConfigFields& fields);
};

struct OdometryConfig {
  OdometryConfig();

  std::string cameras;  ///< names, separated by commas; empty: the rig's first of each kind that the mode uses
  PacketizerConfig packets;
  EventFrameConfig event_frame;
  EnhanceConfig enhance;
  bool enhance_detect = true;   ///< find features on the enhanced event frame
  bool enhance_track = false;   ///< follow them on it too
  AlignmentConfig alignment;    ///< for event frames
  HealthConfig health;          ///< for each camera
  LowLightConfig low_light;     ///< standard frames in the dark
  TrackerConfig event_tracker;  ///< `tracker.*` sets both trackers, but those of kPerCameraKind
  TrackerConfig frame_tracker;
  StereoConfig stereo;
  KeyframeConfig keyframes;
  DepthConfig depth;
  EstimatorConfig estimator;
  MapConfig map;
  double min_events_per_pixel = 0.1;  ///< a packet with fewer events has no event frame
  StatusConfig status;

  void visit(ConfigFields& fields);

  /// Throws InputError with the reason when an option is out of its range or contradicts another.
  void validate() const;

 private:
  void declare(ConfigFields& fields);
};

/// By how much the stamps of a sensor may lag behind the newest stamp of all sensors [s]. A packet waits for a sensor
/// only until that sensor has passed it, so the delay costs latency only where a sensor is silent or slow: for frames,
/// in packets of events between two of them. The defaults fit usual drivers: events arrive in USB packets of up to 33
/// ms, a frame arrives one readout after the middle of its exposure.
struct SensorDelays {
  double events_s = 0.05, frames_s = 0.05, imu_s = 0.05;
  double external_s = 0.05;  ///< height and velocity sensors; none is waited for before its first sample

  /// Throws InputError when one is not within 0 .. 10 s.
  void validate() const;
  bool operator==(const SensorDelays&) const = default;
};

/// Measurements arrive in the order that Dataset guarantees: no waiting.
inline constexpr SensorDelays kInOrder{0.0, 0.0, 0.0, 0.0};

/// How the odometry gets its measurements and runs. The defaults are for live sensors with a driver thread each; use
/// `{kInOrder}` for a recording.
struct FeedConfig {
  SensorDelays delays;
  Inference inference = Inference::Synchronous;  ///< OwnThread: no other stage waits for the depth network
  /// Keep all measurements of keyframes for Odometry::final_trajectory, two megabytes a minute. Without them it is the
  /// solution of a pose graph.
  bool keeps_measurements = true;
};

}  // namespace edged
