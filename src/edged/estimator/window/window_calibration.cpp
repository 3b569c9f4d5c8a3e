// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The calibrations in the window: cameras and IMU.
#include <algorithm>

#include "edged/camera/field_of_view.hpp"
#include "edged/estimator/window/calibration_pair.hpp"
#include "edged/estimator/window/calibration_prior.hpp"
#include "edged/estimator/window/window.hpp"

namespace edged {
RigCamera Window::calibrated(std::size_t camera) const {
  RigCamera found = cameras_[camera].given;
  const CalibrationBlock& off = cameras_[camera].calibration;
  found.T_B_C = T_B_C(camera);
  found.time_offset = duration_from_seconds(off[kTimeAt]);
  return found;
}

SE3 Window::T_B_C(std::size_t camera) const {
  return camera_pose(SE3(), {}, cameras_[camera].given.T_B_C, cameras_[camera].calibration.data());
}

IntrinsicsCorrection Window::intrinsics(std::size_t camera) const {
  return IntrinsicsCorrection(cameras_[camera].calibration.data() + kIntrinsicsAt);
}

CameraModel Window::model(std::size_t camera) const {
  const CameraModel& given = cameras_[camera].given.model;
  return corrected_model(given, intrinsics(camera)).value_or(given);
}

Eigen::Vector2d Window::point(const ObservationKey& image, const WindowObservation& observation) const {
  return observation.image.at_zero + observation.image.by_intrinsics * intrinsics(image.camera);
}

void Window::predict(FeatureId id, const ObservationKey& image, const Eigen::Vector2d& point) {
  WindowObservation& observation = feature(id).observations.at(image);
  const WindowCamera& camera = cameras_[image.camera];
  const ByIntrinsics by = point_by_intrinsics(camera.given.model, camera.model, point);
  observation.image.at_zero += (observation.image.by_intrinsics - by) * camera.linearised_at;
  observation.image.by_intrinsics = by;
  observation.predicted = true;
}

void Window::linearise(const WindowCamera& camera, WindowObservation& observation) const {
  const CameraModel& given = camera.given.model;
  const bool moved = !camera.linearised_at.isZero(0.0);
  const Eigen::Vector2d point = moved ? point_by(camera.model, given, observation.point) : observation.point;
  const ByIntrinsics by = point_by_intrinsics(given, camera.model, point);
  observation.image = {point - by * camera.linearised_at, by};
  observation.predicted = false;
}

void Window::relinearise_intrinsics() {
  constexpr double kMoved = 1e-3;  // leaves 1e-5 of the field of view of second order
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    WindowCamera& camera = cameras_[i];
    if ((intrinsics(i) - camera.linearised_at).cwiseAbs().maxCoeff() < kMoved) continue;
    const std::optional<CameraModel> model = corrected_model(camera.given.model, intrinsics(i));
    if (!model) continue;
    camera.linearised_at = intrinsics(i);
    camera.model = *model;
    for (auto& [id, feature] : features_) {
      for (auto& [image, observation] : feature.observations) {
        if (image.camera == i) linearise(camera, observation);
      }
    }
  }
}

void Window::free_calibration(const CalibrationConfig& config) {
  std::erase_if(soft_priors_, [](const auto& soft) { return is_calibration(soft->blocks().front()); });
  for (std::size_t camera = 0; camera < cameras_.size(); ++camera) {
    const WindowCamera& of = cameras_[camera];
    CalibrationVector sigmas = calibration_sigmas(config, of.given.model);
    if (of.given.modality == Modality::Events && std::ranges::none_of(cameras_, [&](const WindowCamera& other) {
          return other.given.modality == Modality::Frames && is_same_lens(of.given, other.given);
        })) {
      sigmas.segment<2>(kCentreAt).setZero();  // events alone do not tell its shift from a rotation of the camera
      sigmas[calibration_at::kDistortion + 1] = 0.0;  // nor the second coefficient from the first
    }
    const auto twin =
        std::ranges::find_if(cameras_.begin(), cameras_.begin() + static_cast<std::ptrdiff_t>(camera),
                             [&](const WindowCamera& other) { return is_same_lens(of.given, other.given); });
    if (const auto first = static_cast<std::size_t>(twin - cameras_.begin()); first < camera) {
      add_soft_prior(
          equal_calibrations({first, twin->given.T_B_C, twin->calibration}, {camera, of.given.T_B_C, of.calibration}));
      for (int i = 0; i < kCalibrationSize; ++i)  // one lens has one prior
        if (i != kTimeAt && sigmas[i] > 0.0) sigmas[i] = kFree;
    }
    add_soft_prior(prior_at({BlockKind::Calibration, camera}, of.calibration, sigmas));
    auto beside = std::ranges::find_if(
        cameras_, [&](const WindowCamera& other) { return other.given.modality == of.given.modality; });
    if (&*beside == &of && have_baseline(of.given, cameras_.front().given))
      beside = cameras_.begin();  // the first frame camera beside the first event camera, behind another lens
    if (const auto first = static_cast<std::size_t>(beside - cameras_.begin());
        first < camera && config.baseline_sigma_mm > 0.0 &&
        twin == cameras_.begin() + static_cast<std::ptrdiff_t>(camera))  // else the other one behind the lens has it
      add_soft_prior(relative_pose_prior({first, beside->given.T_B_C, beside->calibration},
                                         {camera, of.given.T_B_C, of.calibration}, config));
  }
  add_soft_prior(prior_at(kImuIntrinsicsKey, imu_intrinsics_, Eigen::VectorXd::Constant(18, config.imu_sigma)));
}

void Window::set_intrinsics(std::size_t camera, const IntrinsicsCorrection& intrinsics) {
  std::ranges::copy(intrinsics, cameras_.at(camera).calibration.begin() + kIntrinsicsAt);
  relinearise_intrinsics();
  free_calibration(CalibrationConfig::fixed());
}

}  // namespace edged
