// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/online_calibration.hpp"

#include <algorithm>

namespace edged {
namespace {

// Changes of the corrections after which a model is made anew: a few thousandths of a pixel, and a few hundredths.
constexpr double kLensTolerance = 1e-5, kImageTolerance = 2e-4;

}  // namespace

Rig without_offsets(Rig rig) {
  for (RigCamera& camera : rig.cameras) camera.time_offset = Duration(0);
  return rig;
}

OnlineCalibration::OnlineCalibration(const Rig& given)
    : given_(given),
      rig_(without_offsets(given)),
      intrinsics_(given.cameras.size(), IntrinsicsCorrection::Zero()),
      image_models_(given.cameras.size()),
      lens_models_(given.cameras.size()) {}

void OnlineCalibration::update(const Window& window) {
  for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
    rig_.cameras[camera] = window.cameras()[camera].calibrated();
    intrinsics_[camera] = window.cameras()[camera].intrinsics();
    if (!lens_models_[camera].holds(intrinsics_[camera], kLensTolerance))
      lens_models_[camera] = {intrinsics_[camera], window.cameras()[camera].model()};
  }
}

Rig OnlineCalibration::total() const {
  Rig rig = rig_;
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    if (lens_models_[camera].model) rig.cameras[camera].model = *lens_models_[camera].model;
    rig.cameras[camera].time_offset += given_.cameras[camera].time_offset;
  }
  return rig;
}

std::optional<std::size_t> OnlineCalibration::find(const std::string& camera) const {
  const auto found = std::ranges::find(rig_.cameras, camera, &RigCamera::name);
  if (found == rig_.cameras.end()) return std::nullopt;
  return static_cast<std::size_t>(found - rig_.cameras.begin());
}

const CameraModel& OnlineCalibration::image_model(std::size_t camera, const CameraModel& given) {
  CachedModel& known = image_models_[camera];
  const IntrinsicsCorrection& now = intrinsics_[camera];
  if (!known.holds(now, kImageTolerance)) {
    const std::optional<CameraModel> corrected = corrected_image_model(given, rig_.cameras[camera].model, now);
    known = {now, corrected ? *corrected : known.model.value_or(given)};
  }
  return *known.model;
}

}  // namespace edged
