// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The result of one packet of measurements, as a value of its own.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "edged/final_trajectory.hpp"
#include "edged/keyframe_record.hpp"
#include "edged/measurement.hpp"
#include "edged/rig.hpp"
#include "edged/se3.hpp"
#include "edged/state.hpp"
#include "edged/time.hpp"
#include "edged/track.hpp"

namespace edged {

/// The quality of the present pose.
enum class TrackingStatus { Initializing, Good, Degraded, Lost };
std::string to_string(TrackingStatus status);
/// Whether there is a pose: Good or Degraded.
bool is_tracking(TrackingStatus status);

/// One camera of the run, at one packet.
struct CameraStep {
  std::string name;
  Modality modality = Modality::Frames;
  /// CV_8UC1: the event frame, motion-compensated and undistorted, empty when there were too few events; or the frame
  /// as it came, empty in packets without one.
  cv::Mat image = {};
  /// The tracked features by id, in pixels of `image`; if that is empty, in pixels of the camera's last image.
  std::vector<Track> tracks = {};
  /// Track survival rate: running mean of the share of tracks that survive an image, 0 to 1. Blur, noise and darkness
  /// lower it.
  double survival_rate = 1.0;

  // Event cameras only.
  std::vector<Event> events =
      {};                    ///< events of the packet, oldest first, raw pixels, IMU clock; some were in the one before
  std::size_t rendered = 0;  ///< number of them, the newest ones, that `image` was rendered from
  double event_rate_hz = 0.0;  ///< rate within this packet

  std::span<const Event> rendered_events() const { return std::span(events).last(rendered); }
};

/// The body is at a place that was mapped long before: the drift since then is corrected, and the pose jumps.
struct LoopClosure {
  Timestamp keyframe;       ///< it shows the place, IMU clock
  double position_m = 0.0;  ///< size of the correction
  double rotation_rad = 0.0;
};

/// Images share their pixels with those of the odometry: read them, do not write into them.
struct Step {
  Timestamp t;  ///< the packet's instant, IMU clock
  TrackingStatus status = TrackingStatus::Initializing;
  NavState state;                             ///< at t; meaningful unless status is Initializing
  std::optional<StateCovariance> covariance;  ///< that of `state`, at most 0.1 s old; nothing before the start
  std::optional<Attitude> attitude;           ///< at t, while Initializing: pure rotation gives no position
  bool keyframe = false;                      ///< this packet became a keyframe
  /// The body was found in the map after a loss, or in a loaded map. The pose jumps to its place in the map, and the
  /// reference of the covariance with it.
  bool relocalized = false;
  std::optional<LoopClosure> loop_closure = {};  ///< by this packet
  /// While Lost: the last estimate ended as the cameras contradicted the IMU, so its last poses are wrong.
  bool contradicted = false;

  /// The odometry frame O in the map frame M (W above is M): state.T_W_B = T_M_O * T_O_B. T_O_B has no jumps between
  /// one start of the estimator and the next; the map corrects T_M_O.
  SE3 T_M_O;
  std::vector<MapMatch> map_matches;  ///< map points observed in an image of this packet; they correct T_M_O

  std::string waiting_for;       ///< without an estimate: why initialization has not succeeded yet, with numbers
  std::string started;           ///< set if the estimator was initialized with this packet: how, with numbers
  std::string lost_because;      ///< while Lost: what ended the last estimate, with numbers
  std::string degraded_because;  ///< while Degraded: why the pose is not Good, with numbers

  std::vector<CameraStep> cameras;                     ///< event cameras, then frame cameras, in the order of the rig
  std::vector<Landmark> landmarks;                     ///< landmarks of the window after the optimization
  std::vector<KeyframeRecord> marginalized_keyframes;  ///< by this packet

  double scene_depth = 0;                  ///< z-depth [m] used by the warp
  std::optional<LogScale> ln_depth_scale;  ///< s of Eq. 5; with the depth factor only

  /// All given cameras, as calibrated by this packet; the time offset of event cameras is the given one, without the
  /// latency of their pixels.
  Rig rig;
  /// The pose T_W_X of "body" or of a camera of `rig`, on its own clock. Throws InputError for another name.
  StampedPose pose_of(const std::string& frame) const;

  /// The first camera of that modality; null if the run has none.
  const CameraStep* find(Modality modality) const;
  const CameraStep* find(std::string_view camera) const;
};

}  // namespace edged
