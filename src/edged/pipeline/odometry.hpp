// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The system: packets in, states out. `Odometry::process` is the paper's data flow, one line a step.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "edged/camera/rig.hpp"
#include "edged/core/timing.hpp"
#include "edged/imu/noise.hpp"
#include "edged/pipeline/odometry_config.hpp"
#include "edged/pipeline/packetizer.hpp"
#include "edged/pipeline/tracking_status.hpp"

namespace edged {

/// How well a pose is known, against the start that the estimator stands on (a loss begins a new one): there position
/// and yaw are exact.
struct PoseCovariance {
  Eigen::Matrix3d position;  ///< [m^2], in W
  Eigen::Matrix3d rotation;  ///< [rad^2], in B: of phi in R_true = R Exp(phi)
};

/// What one packet brought.
struct OdometryOutput {
  TrackingStatus status = TrackingStatus::Initializing;
  NavState state;                            ///< at the packet's time; meaningful unless status is Initializing
  std::optional<PoseCovariance> covariance;  ///< of state, at most 0.1 s old; nothing before the start
  bool keyframe = false;                     ///< this packet became a keyframe
  int event_tracks = 0;                      ///< live corners on the event frame
  int frame_tracks = 0;                      ///< live corners on the standard frame
  int landmarks = 0;                         ///< in the window
  double event_rate_hz = 0;                  ///< of this packet
  double scene_depth = 0;                    ///< z-depth [m] used by the warp
  std::optional<LogScale> ln_depth_scale;    ///< s of Eq. 5; with the depth factor only
  std::string waiting_for;                   ///< while there is no estimate: what a start lacks, with numbers
  std::string lost_because;                  ///< while Lost: what ended the last estimate, with numbers
};

/// Synchronous and deterministic: the same packets give the same bits; but for a depth network that has a thread of its
/// own (Inference::OwnThread, for live use).
class Odometry {
 public:
  /// Throws InputError when the rig lacks a camera the mode needs or the config contradicts itself.
  Odometry(const Rig& rig, const ImuNoise& imu_noise, Mode mode, const OdometryConfig& config,
           Inference inference = Inference::Synchronous);
  ~Odometry();

  /// Packets in time order. Never throws on data; lost tracking is a status.
  OdometryOutput process(const Packet& packet);

  const StageTimings& timings() const;

  /// The cameras of the mode as calibrated so far: rotation against the body, and time offset (the whole of it).
  Rig rig() const;
  /// How well that is known of a camera of the mode: rotation about its axes [rad], then time offset [s]. Nothing where
  /// there is no estimate.
  std::optional<Eigen::Matrix4d> calibration_covariance(const std::string& camera);

  /// The motion-compensated event frame of the last packet (CV_8UC1, undistorted), empty when it had none.
  const cv::Mat& event_frame() const;

  /// The corners that are alive after the last packet, by id; none for a camera that the mode does not use. Pixels are
  /// those of the undistorted event frame (ideal_pinhole) or of the frame as given. Where the packet brought no image
  /// of the camera they are those of its last one.
  std::span<const Track> tracks(Modality modality) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace edged
