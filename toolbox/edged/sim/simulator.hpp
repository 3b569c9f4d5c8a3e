// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Event camera, frames and IMU moving through a textured scene, with the truth: a Dataset like any recording.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "edged/core/dataset.hpp"
#include "edged/io/calibration.hpp"
#include "edged/sim/disturbance.hpp"
#include "edged/sim/event_camera.hpp"
#include "edged/sim/external_model.hpp"
#include "edged/sim/frame_camera.hpp"
#include "edged/sim/imu_model.hpp"
#include "edged/sim/motion.hpp"
#include "edged/sim/renderer.hpp"
#include "edged/sim/scene.hpp"

namespace edged {

/// Size, intrinsics and distortion shared by events and frames; a DAVIS240C.
struct SimulatedCameraConfig {
  int width = 240, height = 180;
  double fx = 199.37143, fy = 199.70787, cx = 133.75438, cy = 113.99217;
  DistortionModel distortion = DistortionModel::RadTan;
  double k1 = -0.38289916, k2 = 0.18933637, p1 = -0.00100247, p2 = -0.00056378;

  void visit(ConfigFields& fields);
  CameraModel model() const;
};

/// Every number of a simulation. The defaults are the preset "room"; simulator_preset gives the others.
struct SimulatorConfig {
  std::string name = "room";  ///< of the preset it started from; only a label
  int seed = 1;
  double duration_s = 20.0;
  double max_motion_px = 0.5;
  MotionConfig motion;
  SceneConfig scene;
  SimulatedCameraConfig camera;
  EventCameraConfig events;
  FrameCameraConfig frames;
  ImuModelConfig imu;
  ExternalModelConfig external;
  Disturbance disturbance;

  /// Pose of the camera in the body; not an option.
  SE3 T_B_C = davis240c_extrinsics();

  void visit(ConfigFields& fields);
  static SE3 davis240c_extrinsics();

  /// A further camera on the same flight through the same scene, which are designed for the one at T_B_C.
  struct Mount {
    SE3 T_C_M;           ///< its pose relative to that
    std::string suffix;  ///< of its cameras' names; with one its noise is its own
  };
  Mount mount;
  SE3 T_B_M() const { return T_B_C * mount.T_C_M; }
};

/// One of simulator_presets(). Throws InputError that lists them.
SimulatorConfig simulator_preset(const std::string& name);

/// A DAVIS240C in the hand ("room" is the default), then flight_presets().
const std::vector<std::string>& simulator_presets();

/// The eleven flights of the paper's Table III in its order: a DAVIS346 on a quadrotor in a hall.
const std::vector<std::string>& flight_presets();

/// Deterministic by config and seed. Renders as next() is called; holds the measurements of one exposure at most.
/// Stamps start at 0 on the camera's clock; motion.rest_s from there are at rest. Cameras "events" and "frames", with
/// the suffix of its mount.
class Simulator : public Dataset {
 public:
  /// Throws InputError for impossible values, or a motion file that is missing or too short.
  explicit Simulator(const SimulatorConfig& config);

  const DatasetInfo& info() const override { return info_; }
  std::optional<Measurement> next() override;
  /// Of events alone: frames cost little beside the pictures.
  void leave_out(Modality unwanted) override { wants_events_ &= unwanted != Modality::Events; }
  /// T_W_B at 200 Hz, stamps on the IMU's clock.
  std::optional<GroundTruth> ground_truth() const override;

  Calibration calibration() const;

  /// The exact motion; t: seconds on the camera's clock.
  const DisturbedTrajectory& trajectory() const { return trajectory_; }
  /// What has been rendered so far: how many pictures, and the last one's time on the camera's clock.
  std::size_t renderings() const { return renderings_; }
  Timestamp rendered_until() const { return t_.value_or(Timestamp()); }
  const Rendering& last_rendering() const { return renderer_.last(); }
  /// The scene.
  const Scene& scene() const { return renderer_.scene(); }

 private:
  void advance();
  Timestamp next_render_time() const;
  void prepare_imu();
  /// The external sensor whose sample is next; null without any.
  ExternalModel* next_external();
  void collect_light(Timestamp from, Timestamp to);
  /// Per pixel, from now until the next picture.
  double storm_hz() const;
  /// Of the frame that is exposed next.
  Timestamp exposure_begin() const;
  Timestamp exposure_middle() const { return exposure_begin() + exposure_ / 2; }
  EventBatch take_events(Timestamp before);
  double image_speed(Timestamp t) const;
  bool disturbed(DisturbanceKind by, Timestamp t) const { return config_.disturbance.is(by, to_seconds(t)); }
  Kinematics truth(Timestamp t) const { return trajectory_.at(to_seconds(t)); }

  SimulatorConfig config_;
  DatasetInfo info_;
  DisturbedTrajectory trajectory_;
  Renderer renderer_;
  EventCamera event_camera_;
  FrameCamera frame_camera_;
  ImuModel imu_model_;
  std::vector<ExternalModel> external_models_;
  Duration time_offset_, exposure_;  // the latter of the next frame
  Timestamp end_;                    // of the cameras
  std::optional<Timestamp> t_;       // rendered up to here
  int frame_count_ = 0;              // read out so far
  std::int64_t imu_count_ = 0;
  std::vector<float> radiance_, previous_;  // input of the sensors: the last rendered image and the one before
  std::deque<Event> events_;                // rendered but not returned yet, as frames_
  std::deque<Frame> frames_;
  std::optional<ImuSample> imu_;  // the next one
  std::size_t renderings_ = 0;
  bool wants_events_ = true;
};

}  // namespace edged
