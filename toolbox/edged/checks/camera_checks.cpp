// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "edged/camera/field_of_view.hpp"
#include "edged/checks/check_groups.hpp"
#include "edged/core/angles.hpp"

namespace edged {
namespace {

void check_shift(const CameraCheck& check, Findings& out) {
  // In low light, events are delayed by milliseconds, which is no error of the clock.
  constexpr double kDetermined_ms = 5.0;
  constexpr double kMostCorrected_ms = 32.0;  // by a run: 4 sigma of estimator.calibration.time_offset_sigma_ms
  constexpr double kCertain = 4.0;            // a t that chance exceeds in one of 600
  constexpr double kSigmas = 3.0;             // with few corners the sigma is inflated, the t is not
  const bool events = check.camera.modality == Modality::Events;  // under vibration their images gave 37 ms too much
  const double least_ms = events ? 8.0 : 5.0;
  const GyroAgreement& found = *check.agreement;
  const double shift = 1e3 * to_seconds(found.time_offset), given = 1e3 * to_seconds(check.camera.time_offset);
  const double sigma = 1e3 * found.time_sigma_s;
  const std::string text = fmt::format(
      "camera {}: t_imu = t_cam {:+.1f} ms +- {:.1f} ms from its rotation rate, {:+.1f} ms in the calibration",
      check.camera.name, shift, sigma, given);
  const std::string remedy = fmt::format("set time_offset of this camera to {:.4f}", to_seconds(found.time_offset));
  const double off = std::abs(shift - given);
  const bool differs = off > least_ms;
  const bool wrong = differs && found.time_t > kCertain && off > kSigmas * sigma;
  if (found.at_bound)
    out.warn(fmt::format(
                 "camera {}: {:.0f} ms or more off the calibration's t_imu = t_cam {:+.1f} ms, from its rotation rate",
                 check.camera.name, 1e3 * to_seconds(kMostShift), given),
             "check the clocks of camera and IMU");
  else if (wrong && off > kMostCorrected_ms && !events)
    out.error(text, remedy);
  else if (wrong)
    out.warn(text, remedy);
  else if (differs || sigma > kDetermined_ms)
    out.note(fmt::format("camera {}: its time offset cannot be determined from its rotation rate (+- {:.1f} ms)",
                         check.camera.name, std::max(sigma, off)));
  else
    out.good(text);
}

/// The difference of a rotation to the IMU from the measured one, with its uncertainty.
struct RotationError {
  Eigen::Vector3d turn;  ///< measured = this rotation * Exp(turn) [rad]
  double degrees = 0.0, sigma_deg = 0.0;
  double sigmas = 0.0;  ///< in standard deviations, systematic errors included
  bool right() const { return degrees <= 2.0 || sigmas <= 4.0; }  // calibrations are rarely better than 1 deg
  bool unclear() const { return degrees > 4.0 && sigmas <= 4.0; }
};

/// The camera axis about which R_B_C is not observable; nothing if all three are.
std::optional<Eigen::Vector3d> unknown_axis(const GyroAgreement& found) {
  constexpr double kUnknown_deg = 10.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(found.rotation_covariance);
  if (std::sqrt(axes.eigenvalues()[2]) * kDegreesPerRadian < kUnknown_deg) return std::nullopt;
  return axes.eigenvectors().col(2);
}

RotationError error_of(const Eigen::Matrix3d& R_B_C, const GyroAgreement& found) {
  // Errors of the measurement: rolling shutter, scale and cross-axis errors of the gyro, corners that slide along
  // edges.
  constexpr double kSystematic_deg = 0.8;
  const Eigen::Matrix3d off = R_B_C.transpose() * found.R_B_C;
  const auto axis = unknown_axis(found);
  const Eigen::AngleAxisd turn(axis ? Eigen::Quaterniond::FromTwoVectors(*axis, off * *axis) : Eigen::Quaterniond(off));
  RotationError error{turn.angle() * turn.axis(), turn.angle() * kDegreesPerRadian, 0.0, 0.0};
  const Eigen::Matrix3d measured =
      found.rotation_covariance + found.common_error * found.common_error * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d whole =
      measured + std::pow(kSystematic_deg / kDegreesPerRadian, 2) * Eigen::Matrix3d::Identity();
  error.sigma_deg = std::sqrt(turn.axis().dot(measured * turn.axis())) * kDegreesPerRadian;
  error.sigmas = std::sqrt(error.turn.dot(whole.ldlt().solve(error.turn)));
  return error;
}

/// True if the transform is given in the opposite direction: its inverse fits, and far better.
bool inverse_fits(const Eigen::Matrix3d& given, const RotationError& error, const GyroAgreement& found) {
  constexpr double kBetter = 5.0;  // standard deviations
  const RotationError inverse = error_of(given.transpose(), found);
  return inverse.right() && std::pow(error.sigmas, 2) - std::pow(inverse.sigmas, 2) > kBetter * kBetter;
}

void check_rotation(const CameraCheck& check, Findings& out) {
  constexpr double kWrong_deg = 8.0;  // the online calibration corrects smaller errors, with a loss of accuracy
  constexpr double kDetermined_deg = 1.5;
  // A moving lamp that lights a part of the view gives turns of its own, 117 deg off at a sigma of 15 deg; cameras that
  // are mounted wrong and IMUs with negated axes have at most 11 deg.
  constexpr double kVague_deg = 12.0;
  constexpr double kReflected_deg = 150.0;  // about an axis of the image: a camera that looks the other way
  const GyroAgreement& found = *check.agreement;
  const std::string name = "camera " + check.camera.name;
  const auto axis = unknown_axis(found);
  if (axis)
    out.note(
        fmt::format("{}: it rotated about one axis only, ({:.2f}, {:.2f}, {:.2f}) of the camera: its mounting angle "
                    "about that axis is not checked",
                    name, axis->x(), axis->y(), axis->z()));
  const Eigen::Matrix3d given = check.camera.T_B_C.rotation().toRotationMatrix();
  const RotationError error = error_of(given, found);
  const std::string number = fmt::format("{:.1f} deg +- {:.1f} deg", error.degrees, error.sigma_deg);
  if (error.unclear() || error.sigma_deg > (error.right() ? kDetermined_deg : kVague_deg))
    return out.note(fmt::format("{}: its rotation to the IMU cannot be determined from this motion (+- {:.1f} deg)",
                                name, error.sigma_deg),
                    "turn the sensor about all axes before a scene with texture");
  if (error.right()) return out.good(fmt::format("{}: its rotation agrees with the gyro to {}", name, number));
  const Eigen::Vector3d about = error.turn.normalized();
  const std::string remedy = fmt::format(
      "the calibration fits after a rotation by {:.1f} deg about the camera's axis ({:.2f}, {:.2f}, {:.2f})",
      error.degrees, about.x(), about.y(), about.z());
  const bool reflected = error.degrees > kReflected_deg && std::abs(about.z()) < 0.5;
  const std::string text = fmt::format("{}: its rotation to the IMU contradicts the gyro by {}{}", name, number,
                                       reflected ? ", as if its image were reflected" : "");
  if (inverse_fits(given, error, found))
    out.error(text + ", the inverse fits", kTurnRound);
  else if (error.degrees < kWrong_deg)
    out.warn(text, remedy + "; or calibrate again");
  else
    out.error(text, remedy);
}

/// An initial guess for a missing calibration.
void tell_rotation(const CameraCheck& check, Findings& out) {
  const Eigen::Matrix3d& R = check.agreement->R_B_C;
  out.note(fmt::format("camera {}: its rotation to the IMU is not calibrated; estimated from its rotation rate, R_B_C "
                       "is [{:.3f} {:.3f} {:.3f}; "
                       "{:.3f} {:.3f} {:.3f}; {:.3f} {:.3f} {:.3f}] +- {:.1f} deg",
                       check.camera.name, R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1),
                       R(2, 2), check.agreement->rotation_sigma * kDegreesPerRadian),
           "a run needs it and the lever arm: `edged calib --target` measures both");
}

void check_scale(const CameraCheck& check, Findings& out) {
  constexpr double kOfUnexplained = 2.0;  // four sigmas of the systematic error, as in GyroAgreement::common_error
  const double ratio = check.agreement->gyro_scale;
  if (ratio > 0.7 && (ratio < 1.4 || check.in_degrees())) return;
  // People who walk through the view also turn the image.
  if (std::abs(std::log(std::max(ratio, 1e-3))) < kOfUnexplained * check.agreement->unexplained) return;
  out.warn(fmt::format("camera {}: the gyro turns {:.2f} times as fast as its image", check.camera.name, ratio),
           "check the focal length, and the unit of the gyro");
}

/// With too few or too blurred corners the rotation is underestimated. (Correct calibrations: frames within 1.5 %,
/// events within 8 %, and up to 33 % where 12 % or more stay unexplained.)
void check_gyro_scale(const CameraCheck& check, Findings& out) {
  constexpr double kLeast = 0.04, kUnexplained = 0.1, kDetermined = 0.015, kEventImages = 0.05;
  constexpr double kSigmas = 6.0;  // correlated errors of corners make sigmas too small
  const GyroAgreement& found = *check.agreement;
  if (found.scale_sigma <= 0.0 || found.scale_unexplained > kUnexplained) return;
  const double common = check.camera.modality == Modality::Events ? kEventImages : found.scale_unexplained / 10;
  const double sigma = std::hypot(found.scale_sigma, common);
  const double off = found.gyro_scale - 1.0;
  const std::string number = fmt::format("{:.1f} % +- {:.1f} %", 100 * std::abs(off), 100 * sigma);
  if (std::abs(off) > std::max(kLeast, kSigmas * sigma))
    out.warn(fmt::format("camera {}: the gyro reads {} too {} for its rotation rate", check.camera.name, number,
                         off > 0 ? "much" : "little"),
             fmt::format("divide the gyro by {:.3f}; or the focal length is wrong by as much", found.gyro_scale));
  else if (sigma > kDetermined)
    out.note(fmt::format("camera {}: the gyro's scale cannot be determined by it (+- {:.1f} %)", check.camera.name,
                         100 * sigma));
  else
    out.good(fmt::format("camera {}: the gyro's scale agrees with it to {}", check.camera.name, number));
}

/// True if events fill a part of the sensor and are nowhere else.
bool fill_a_part(const RecordingStatistics& s, cv::Size calibrated) {
  constexpr double kWhole = 0.8, kFilled = 0.7;  // share of width and height; share of the pixels there that fired
  const cv::Size seen = s.event_details.extent, counted = s.info.event_sensor.empty() ? seen : s.info.event_sensor;
  return seen.width < kWhole * calibrated.width && seen.height < kWhole * calibrated.height &&
         s.event_details.active_share * counted.area() > kFilled * seen.area();
}

/// False if the calibration is for a sensor of another size.
bool check_size(const CameraCheck& check, const RecordingStatistics& s, Findings& out) {
  const cv::Size calibrated(check.camera.model.width(), check.camera.model.height());
  const bool events = check.camera.modality == Modality::Events;
  const auto further = std::ranges::find(s.more, check.camera.name, &RecordingStatistics::camera);
  const RecordingStatistics& of_camera = further == s.more.end() ? s : *further;
  const cv::Size seen = events ? of_camera.event_details.extent : of_camera.image_size;
  const bool part = events && fill_a_part(of_camera, calibrated);
  const bool fits =
      events ? seen.width <= calibrated.width && seen.height <= calibrated.height && !part : seen == calibrated;
  if (!fits && !seen.empty())
    out.error(fmt::format("camera {}: calibrated for {} x {} px, recorded {} x {}{}", check.camera.name,
                          calibrated.width, calibrated.height, seen.width, seen.height, part ? " only" : ""),
              "choose the calibration of this camera, and of this resolution");
  return fits || seen.empty();
}

/// The estimator takes all rows of a frame for simultaneous.
void check_readout(const CameraCheck& check, Findings& out) {
  constexpr double kLeast_ms = 8.0, kSigmas = 4.0;  // global shutters (71 draws, mirrors, EuRoC): at most 6 ms
  if (!check.readout) return;
  const double ms = 1e3 * check.readout->s, sigma_ms = 1e3 * check.readout->sigma_s;
  if (std::abs(ms) > std::max(kLeast_ms, kSigmas * sigma_ms))
    out.warn(
        fmt::format("camera {}: a rolling shutter: its rows are read within {:.1f} ms +- {:.1f} ms{}",
                    check.camera.name, std::abs(ms), sigma_ms, ms < 0.0 ? ", from below" : ""),
        "a run takes them for simultaneous, which costs accuracy in fast motion: use a global shutter, or a shorter "
        "readout");
}

void check_mounting(const CameraCheck& check, Findings& out) {
  if (check.agreement->mirrored)
    return out.error(
        fmt::format("camera {}: the gyro rotates the other way, as if its axes were mirrored", check.camera.name),
        "one or all three of its axes have the wrong sign: a right-handed IMU has x turning towards y about z");
  check_shift(check, out);
  check.has_extrinsics ? check_rotation(check, out) : tell_rotation(check, out);
  check_scale(check, out);
  check_gyro_scale(check, out);
  check_readout(check, out);
}

void check_camera(const CameraCheck& check, Findings& out) {
  const std::string& name = check.camera.name;
  if (!check.agreement)
    return out.note(
        fmt::format("camera {}: cannot be compared with the gyro: too few turns with corners and IMU samples", name));
  if (check.lens)
    return out.error(fmt::format("camera {}: it agrees with the gyro only with another lens: {}", name, *check.lens),
                     "choose the calibration of this lens, or calibrate it again");
  if (check.gross_deg > 0.0)
    return out.error(
        fmt::format("camera {}: rotates as if mounted about {:.0f} deg off the calibration, compared with the gyro",
                    name, check.gross_deg),
        "check the rotation of T_B_C and its direction: `edged calib` shows both");
  if (!check.sure())
    return out.note(
        fmt::format("camera {}: turns too little, or too differently from the gyro, to check its calibration ({:.0f} % "
                    "of its rotation unexplained)",
                    name, 100 * std::min(1.0, check.agreement->unexplained)));
  Findings found;
  check_mounting(check, found);
  const bool contradicts =
      std::ranges::any_of(found.list, [](const Finding& f) { return f.severity >= Severity::Warning; });
  if (contradicts && check.agreement->turning < check.least_turning)
    return out.note(fmt::format("camera {}: turns for {:.1f} s only, too little to check its calibration ({} s are "
                                "needed)",
                                name, to_seconds(check.agreement->turning), to_seconds(check.least_turning)),
                    "record more in which the sensor turns about all axes before a scene with texture");
  out.list.insert(out.list.end(), found.list.begin(), found.list.end());
}

/// Once for cameras of the same lens.
void check_lever_arm(const CameraCheck& check, const std::vector<CameraCheck>& all, Findings& out) {
  constexpr double kLongest_m = 2.0;
  const double arm_m = check.camera.T_B_C.translation().norm();
  const auto first =
      std::ranges::find_if(all, [&](const CameraCheck& other) { return is_same_lens(other.camera, check.camera); });
  if (arm_m > kLongest_m && &check == &*first)
    out.error(fmt::format("camera {}: calibrated {:.4g} m away from the IMU, as if its translation were in millimetres",
                          check.camera.name, arm_m),
              "translations are in metres: divide that of T_B_C by 1000");
}

/// Uses the camera with the most information. Rotations overlap and displacements are noisy: the correlation of n
/// unrelated ones is 1.2 / sqrt(n).
void check_accel(const CheckInput& input, Findings& out) {
  constexpr double kLeast = 0.3, kByChance = 3.0;
  const auto turns_alike = [](const CameraCheck& check) { return check.sure() && !check.agreement->mirrored; };
  if (input.accel_axes && std::ranges::any_of(input.cameras, turns_alike))
    return out.error("accelerometer: gravity does not rotate in its axes as the gyro measures",
                     fmt::format("give it the axes of the gyro: {} would fit", *input.accel_axes));
  const CameraCheck* best = nullptr;
  const auto surety = [=](const CameraCheck& check) {
    const AccelAgreement& accel = check.agreement->accel;
    return std::abs(accel.correlation) / std::max(kLeast, kByChance / std::sqrt(static_cast<double>(accel.turns)));
  };
  for (const CameraCheck& check : input.cameras) {
    if (!check.agreement || check.agreement->mirrored || check.agreement->accel.turns < kFewestAccelTurns) continue;
    if (!best || surety(check) > surety(*best)) best = &check;
  }
  if (!best || surety(*best) <= 1.0) return;
  const AccelAgreement& accel = best->agreement->accel;
  if (accel.correlation < 0.0)
    out.error(fmt::format("accelerometer: camera {} moves opposite to it (correlation {:.2f} over {} turns)",
                          best->camera.name, accel.correlation, accel.turns),
              "the sign of all its axes is wrong: multiply it by -1; at rest it must read +9.8 m/s^2 along the axis "
              "that points up");
  else
    out.good(fmt::format("camera {}: it agrees with the accelerometer (correlation {:.2f})", best->camera.name,
                         accel.correlation));
}

}  // namespace

void check_cameras(const CheckInput& input, Findings& out) {
  for (const std::string& pair : input.exchanged)
    out.error(fmt::format("cameras {}: their images match only if exchanged", pair),
              "exchange their topics or files, or their names in the calibration", Unusable::Calibration);
  if (input.flipped)
    out.error(fmt::format("events: they match the edges of the frames only if {}", *input.flipped),
              "change their pixels in the driver or the converter", Unusable::Calibration);
  const bool comparable = !is_unusable(Unusable::Calibration, out.list);
  const auto errors = [&out] { return std::ranges::count(out.list, Severity::Error, &Finding::severity); };
  const auto before = errors();
  for (const CameraCheck& check : input.cameras)
    if (check_size(check, input.recording, out) && comparable) check_camera(check, out);
  for (const CameraCheck& check : input.cameras) check_lever_arm(check, input.cameras, out);
  if (comparable && errors() == before) check_accel(input, out);
  if (!input.calibrated)
    out.note("no calibration, so none is checked", "give --rig NAME or --calib FILE");
  else if (input.cameras.empty())
    out.note("the calibration has no camera that could be compared with a gyro");
}

}  // namespace edged
