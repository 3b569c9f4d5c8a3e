// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The cameras of a run as the estimator has calibrated them, for all that is not the estimator.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/camera/intrinsics.hpp"
#include "edged/estimator/window/window.hpp"
#include "edged/rig.hpp"

namespace edged {

/// The packetizer applies the time offsets; the estimator handles residual ones.
Rig without_offsets(Rig rig);

class OnlineCalibration {
 public:
  /// given: the cameras of the run, event cameras first.
  explicit OnlineCalibration(const Rig& given);

  /// Takes the present estimates.
  void update(const Window& window);

  const Rig& given() const { return given_; }
  /// The cameras with estimated poses and residual time offsets; their lenses as given.
  const Rig& rig() const { return rig_; }
  const std::vector<RigCamera>& cameras() const { return rig_.cameras; }
  /// Estimated corrections of the lenses, one per camera.
  const std::vector<IntrinsicsCorrection>& intrinsics() const { return intrinsics_; }
  /// The cameras with estimated lenses, poses and total time offsets, for users.
  Rig total() const;
  /// The index of the camera of that name; nothing if the run has none.
  std::optional<std::size_t> find(const std::string& camera) const;

  /// The model of a camera's images for the map, whose points have the calibration. given: without it.
  const CameraModel& image_model(std::size_t camera, const CameraModel& given);

 private:
  /// A model with corrections, made anew once these have moved.
  struct CachedModel {
    IntrinsicsCorrection intrinsics = IntrinsicsCorrection::Zero();
    std::optional<CameraModel> model;
    bool holds(const IntrinsicsCorrection& now, double tolerance) const {
      return model && (now - intrinsics).cwiseAbs().maxCoeff() <= tolerance;
    }
  };

  Rig given_, rig_;
  std::vector<IntrinsicsCorrection> intrinsics_;
  std::vector<CachedModel> image_models_, lens_models_;  // one per camera; the ROS node asks for lenses at each step
};

}  // namespace edged
