// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What one packet of measurements brought: all that an observer of the odometry may want, as a value of its own.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "edged/estimator/region_depth.hpp"
#include "edged/final_trajectory.hpp"
#include "edged/keyframe_record.hpp"
#include "edged/measurement.hpp"
#include "edged/se3.hpp"
#include "edged/state.hpp"
#include "edged/time.hpp"
#include "edged/track.hpp"

namespace edged {

/// How far the present pose can be relied on.
enum class TrackingStatus { Initializing, Good, Degraded, Lost };
std::string to_string(TrackingStatus status);
/// Whether there is a pose to go by: Good or Degraded.
bool is_tracking(TrackingStatus status);

/// How well a pose is known, against the start that the estimator stands on (a loss begins a new one): there position
/// and yaw are exact.
struct PoseCovariance {
  Eigen::Matrix3d position;  ///< [m^2], in W
  Eigen::Matrix3d rotation;  ///< [rad^2], in B: of phi in R_true = R Exp(phi)
};

/// One camera of the run, at one packet.
struct CameraStep {
  std::string name;
  Modality modality = Modality::Frames;
  /// CV_8UC1: the event frame, motion-compensated and undistorted, empty when there were too few events; or the frame
  /// as it came, empty in packets without one.
  cv::Mat image = {};
  /// The live features by id, in pixels of `image`; where that is empty those of the camera's last one.
  std::vector<Track> tracks = {};
  /// Running mean of the share of features that live through an image, 0 to 1: blur, noise and darkness end them.
  double survival_rate = 1.0;

  // Of event cameras:
  std::vector<Event> events = {};  ///< of the packet, oldest first, raw pixels, IMU clock; some were in the one before
  std::size_t rendered = 0;        ///< how many of them, the newest, `image` is of
  double event_rate_hz = 0.0;      ///< of this packet

  std::span<const Event> rendered_events() const { return std::span(events).last(rendered); }
};

/// Images share their pixels with those of the odometry: they are to be looked at, not drawn on.
struct Step {
  Timestamp t;  ///< the packet's instant, IMU clock
  TrackingStatus status = TrackingStatus::Initializing;
  NavState state;                            ///< at t; meaningful unless status is Initializing
  std::optional<PoseCovariance> covariance;  ///< of state, at most 0.1 s old; nothing before the start
  bool keyframe = false;                     ///< this packet became a keyframe
  /// After a loss the body has been found in the map: the pose has gone to where it is there, and what covariance is
  /// against has gone along.
  bool relocalized = false;

  /// Where the estimator's own frame O lies in W: state.T_W_B = T_W_O * T_O_B. T_O_B goes on without jumps from one
  /// start to the next; T_W_O is what the map moves.
  SE3 T_W_O;
  std::vector<MapMatch> map_matches;  ///< of the map, in an image of this packet; the pose has been held to them

  std::string waiting_for;   ///< while there is no estimate: what a start lacks, with numbers
  std::string started;       ///< the estimator has started with this packet: how, with numbers
  std::string lost_because;  ///< while Lost: what ended the last estimate, with numbers

  std::vector<CameraStep> cameras;  ///< those of the run: event cameras, then frame cameras, as the rig has them
  std::vector<Landmark> landmarks;  ///< in the window, where it was solved
  std::vector<KeyframeRecord> marginalized_keyframes;  ///< keyframes that have left the window with this packet

  double scene_depth = 0;                  ///< z-depth [m] used by the warp
  std::optional<LogScale> ln_depth_scale;  ///< s of Eq. 5; with the depth factor only

  /// The first camera of that kind, null where the run has none.
  const CameraStep* find(Modality modality) const;
  const CameraStep* find(std::string_view camera) const;
};

}  // namespace edged
