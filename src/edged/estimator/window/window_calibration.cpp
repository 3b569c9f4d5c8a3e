// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The calibrations in the window: cameras and IMU.
#include <algorithm>

#include "edged/camera/field_of_view.hpp"
#include "edged/estimator/tuning.hpp"
#include "edged/estimator/window/calibration_prior.hpp"
#include "edged/estimator/window/window.hpp"

namespace edged {

RigCamera WindowCamera::calibrated() const {
  RigCamera found = given;
  found.T_B_C = T_B_C();
  found.time_offset = duration_from_seconds(calibration[kTimeAt]);
  return found;
}

Eigen::Vector2d Window::point(const ObservationKey& image, const WindowObservation& observation) const {
  return observation.image.at_zero + observation.image.by_intrinsics * cameras_[image.camera].intrinsics();
}

void Window::predict(FeatureId id, const ObservationKey& image, const Eigen::Vector2d& point) {
  WindowObservation& observation = feature(id).observations.at(image);
  const WindowCamera& camera = cameras_[image.camera];
  const ByIntrinsics by = point_by_intrinsics(camera.given.model, camera.linearised_model, point);
  observation.image.at_zero += (observation.image.by_intrinsics - by) * camera.linearised_at;
  observation.image.by_intrinsics = by;
  observation.predicted = true;
}

void Window::linearise(const WindowCamera& camera, WindowObservation& observation) const {
  const CameraModel& given = camera.given.model;
  const bool moved = !camera.linearised_at.isZero(0.0);
  const Eigen::Vector2d point = moved ? point_by(camera.linearised_model, given, observation.point) : observation.point;
  const ByIntrinsics by = point_by_intrinsics(given, camera.linearised_model, point);
  observation.image = {point - by * camera.linearised_at, by};
  observation.predicted = false;
}

void Window::relinearise_intrinsics() {
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    WindowCamera& camera = cameras_[i];
    const double moved = (camera.intrinsics() - camera.linearised_at).cwiseAbs().maxCoeff();
    if (moved < kLandmarkTuning.relinearised_intrinsics) continue;
    const std::optional<CameraModel> model = corrected_model(camera.given.model, camera.intrinsics());
    if (!model) continue;
    camera.linearised_at = camera.intrinsics();
    camera.linearised_model = *model;
    for (auto& [id, feature] : features_) {
      for (auto& [image, observation] : feature.observations) {
        if (image.camera == i) linearise(camera, observation);
      }
    }
  }
}

void Window::free_calibration(const CalibrationConfig& config) {
  std::erase_if(soft_priors_, [](const auto& soft) { return is_calibration(soft->blocks().front()); });
  for (std::size_t camera = 0; camera < cameras_.size(); ++camera) add_calibration_priors(camera, config);
  add_soft_prior(prior_at(kImuIntrinsicsKey, imu_intrinsics_, Eigen::VectorXd::Constant(18, config.imu_sigma)));
}

void Window::add_calibration_priors(std::size_t index, const CalibrationConfig& config) {
  const WindowCamera& camera = cameras_[index];
  const auto is_twin = [&](const WindowCamera& other) { return is_same_lens(camera.given, other.given); };
  const auto is_kind = [&](const WindowCamera& other) { return other.given.modality == camera.given.modality; };
  const auto first = [&](const auto& condition) {
    return static_cast<std::size_t>(std::ranges::find_if(cameras_, condition) - cameras_.begin());
  };
  const auto in_pair = [&](std::size_t i) { return CameraInPair{i, cameras_[i].given.T_B_C, cameras_[i].calibration}; };

  CalibrationVector sigmas = calibration_sigmas(config, camera.given.model);
  if (camera.given.modality == Modality::Events &&
      std::ranges::none_of(cameras_, [&](const auto& other) { return !is_kind(other) && is_twin(other); })) {
    sigmas.segment<2>(kCentreAt).setZero();         // events alone do not tell its shift from a rotation of the camera
    sigmas[calibration_at::kDistortion + 1] = 0.0;  // nor the second coefficient from the first
  }
  const std::size_t twin = first(is_twin);  // itself, if no camera before it has its lens
  if (twin < index) {
    add_soft_prior(equal_calibrations(in_pair(twin), in_pair(index)));
    for (int i = 0; i < kCalibrationSize; ++i)  // one lens has one prior
      if (i != kTimeAt && sigmas[i] > 0.0) sigmas[i] = kFree;
  }
  add_soft_prior(prior_at({BlockKind::Calibration, index}, camera.calibration, sigmas));
  std::size_t beside = first(is_kind);
  // The first frame camera is beside the first event camera, behind another lens.
  if (beside == index && have_baseline(camera.given, cameras_.front().given)) beside = 0;
  const bool twin_has_it = twin < index;
  if (beside < index && config.baseline_sigma_mm > 0.0 && !twin_has_it)
    add_soft_prior(relative_pose_prior(in_pair(beside), in_pair(index), config));
}

void Window::set_intrinsics(std::size_t camera, const IntrinsicsCorrection& intrinsics) {
  std::ranges::copy(intrinsics, cameras_.at(camera).calibration.begin() + kIntrinsicsAt);
  relinearise_intrinsics();
  free_calibration(CalibrationConfig::fixed());
}

}  // namespace edged
