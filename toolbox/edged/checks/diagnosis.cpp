// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One function per subject; limits are defined where they are used.
#include "edged/checks/diagnosis.hpp"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "edged/checks/external_diagnosis.hpp"
#include "edged/checks/imu_diagnosis.hpp"
#include "edged/core/angles.hpp"

namespace edged {
namespace {

constexpr double kShortest_s = 1.0;     // a run needs this much to initialize
constexpr double kMostLeftOut_s = 0.5;  // per end of the recording, not covered by all sensors
constexpr double kSigmas = 6.0;         // correlated errors of corners make sigmas too small

std::string interval(const char* name, const StreamSurvey& stream) {
  return fmt::format("{} {:.3f} to {:.3f} s", name, to_seconds(*stream.begin), to_seconds(*stream.end));
}

/// The time that all present sensors cover.
void judge_overlap(const Survey& s, Findings& out) {
  std::string all;
  Duration shortest = Duration::max();
  int streams = 0;
  for (const auto& [name, stream] :
       {std::pair("IMU", &s.imu), std::pair("events", &s.events), std::pair("frames", &s.frames)}) {
    if (stream->count == 0) continue;
    all += (all.empty() ? "" : ", ") + interval(name, *stream);
    shortest = std::min(shortest, stream->length());
    ++streams;
  }
  if (streams < 2) return;
  const double common = to_seconds(s.overlap()), least = to_seconds(shortest);
  if (common < 0.0)
    out.error("the clocks of the sensors do not overlap: " + all,
              "stamp all sensors on one clock when recording: no run can mend whole seconds");
  else if (common < std::max(0.9 * least, least - kMostLeftOut_s))
    out.warn(fmt::format("all sensors together cover {:.1f} s only: {}", common, all),
             "the time that only some of them cover is not used; check that all were recorded");
  else if (common < kShortest_s)
    out.warn(fmt::format("all sensors together cover {:.2f} s: {}", common, all),
             "too short for a run, which needs about a second to start: record more");
  else
    out.good(fmt::format("all sensors cover {:.1f} s together", common));
}

void judge_sensors(const Survey& s, Findings& out) {
  if (s.imu.count == 0)
    out.error("no IMU samples",
              "every mode needs them: record the IMU, or name its topic with --topic imu=NAME; those that lie outside "
              "the time of the cameras are on another clock, which `edged info REC` shows");
  if (s.events.count == 0 && s.frames.count == 0)
    out.error("neither events nor frames", "record one of them, or name the topic with --topic events=NAME");
  judge_overlap(s, out);
}

void judge_flicker(const FlickerSurvey& flicker, Findings& out) {
  constexpr double kFew = 0.05;
  const std::string text = fmt::format(
      "a lamp flickers at {:.0f} Hz: about {:.0f} % of the events, in {:.0f} % of the image, {:.0f} % of the time",
      flicker.hz, 100 * flicker.event_share, 100 * flicker.image_share, 100 * flicker.time_share);
  if (flicker.event_share * flicker.time_share < kFew) return out.note(text);
  out.warn(text,
           "a run leaves most of them out, but exposures of frames shift by a part of a millisecond: expose for whole "
           "cycles or very briefly, and prefer daylight or lamps on direct current");
}

void judge_events(const Survey& s, Findings& out) {
  if (s.events.count == 0) return;
  const EventSurvey& e = s.event_details;
  if (s.events.gaps > 0)
    out.note(fmt::format("{} silences of the events of {:.2f} s together, the longest {:.2f} s at {:.3f} s",
                         s.events.gaps, to_seconds(s.events.missing), to_seconds(s.events.longest.front().length),
                         to_seconds(s.events.longest.front().after)),
             "a still scene, or lost data: compare with the motion");
  if (e.hot_share > 0.02)
    out.warn(fmt::format("{} hot pixels send {:.1f} % of all events, most at ({}, {})", e.hot_pixels, 100 * e.hot_share,
                         e.hottest.front().x, e.hottest.front().y),
             "mask them in the camera, or raise its thresholds");
  if (e.flicker) judge_flicker(*e.flicker, out);
  if (e.positive_share < 0.05 || e.positive_share > 0.95)
    out.warn(fmt::format("{:.1f} % of the events are positive", 100 * e.positive_share),
             "check that both polarities are recorded and distinguished");
  if (e.hot_share <= 0.02)
    out.good(fmt::format("events: {}, {:.0f} % positive",
                         e.hot_known ? fmt::format("{} hot pixels", e.hot_pixels) : "too short to detect hot pixels",
                         100 * e.positive_share));
}

void judge_frames(const Survey& s, Findings& out) {
  if (s.frames.count == 0) return;
  if (s.frames.gaps > 0)
    out.warn(fmt::format("{} gaps of the frames, {:.2f} s together, the longest {:.2f} s at {:.3f} s", s.frames.gaps,
                         to_seconds(s.frames.missing), to_seconds(s.frames.longest.front().length),
                         to_seconds(s.frames.longest.front().after)),
             "corners are lost over long ones; look for an overloaded bus");
  if (s.mean_brightness < 15.0)
    out.note(fmt::format("frames are dark: mean brightness {:.0f} of 255", s.mean_brightness),
             "expose longer, or rely on --mode events or fused");
  else if (s.frames.gaps == 0)
    out.good(fmt::format("frames at {:.1f} Hz, mean brightness {:.0f} of 255", s.frames.rate_hz(), s.mean_brightness));
}

/// The findings of each further camera, with its name.
void judge_further_cameras(const Survey& s, Findings& out) {
  for (const Survey& camera : s.more) {
    Findings own;
    if (camera.events.count + camera.frames.count == 0)
      own.error("no measurements", "leave it out with --cameras, or record it");
    judge_events(camera, own);
    judge_frames(camera, own);
    for (Finding& finding : own.list) {
      finding.text = fmt::format("camera {}: {}", camera.camera(), finding.text);
      out.list.push_back(std::move(finding));
    }
  }
}

void judge_shift(const CameraCheck& check, Findings& out) {
  // In low light, events are delayed by milliseconds, which is no error of the clock.
  constexpr double kDetermined_ms = 2.5;
  // Of events, where the offset is less certain: moving objects and moving light cause errors that are correlated over
  // a second, up to 9 sigmas.
  constexpr double kSigmasOfVague = 10.0;
  const double least_ms = check.camera.modality == Modality::Events ? 8.0 : 5.0;
  const GyroAgreement& found = *check.agreement;
  const double shift = 1e3 * to_seconds(found.time_offset), given = 1e3 * to_seconds(check.camera.time_offset);
  const double sigma = 1e3 * found.time_sigma_s;
  const bool is_vague = check.camera.modality == Modality::Events && sigma > kDetermined_ms;
  const double sigmas = is_vague ? kSigmasOfVague : kSigmas;
  const std::string text =
      fmt::format("camera {}: t_imu = t_cam {:+.1f} ms +- {:.1f} ms by its turning, {:+.1f} ms by the calibration",
                  check.camera.name, shift, sigma, given);
  if (found.at_bound)
    out.warn(fmt::format("camera {}: {:.0f} ms or more off the calibration's t_imu = t_cam {:+.1f} ms by its turning",
                         check.camera.name, 1e3 * to_seconds(kMostShift), given),
             "check the clocks of camera and IMU");
  else if (std::abs(shift - given) > std::max(least_ms, sigmas * sigma))
    out.warn(text, fmt::format("set time_offset of this camera to {:.4f}", to_seconds(found.time_offset)));
  else if (sigma > kDetermined_ms)
    out.note(fmt::format("camera {}: its time offset cannot be determined by its turning (+- {:.1f} ms)",
                         check.camera.name, sigma));
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

void judge_rotation(const CameraCheck& check, Findings& out) {
  constexpr double kWrong_deg = 8.0;  // the online calibration corrects smaller errors, with a loss of accuracy
  constexpr double kDetermined_deg = 1.5;
  // A moving lamp that lights a part of the view gives turns of its own, 117 deg off at a sigma of 15 deg; cameras that
  // are mounted wrong and IMUs with negated axes have at most 11 deg.
  constexpr double kVague_deg = 12.0;
  const GyroAgreement& found = *check.agreement;
  const std::string name = "camera " + check.camera.name;
  const auto axis = unknown_axis(found);
  if (axis)
    out.note(fmt::format(
        "{}: turned about one axis only, ({:.2f}, {:.2f}, {:.2f}) of the camera: its rotation about that one is "
        "not checked",
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
  const std::string text = fmt::format("{}: its rotation to the IMU contradicts the gyro by {}", name, number);
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
  out.note(fmt::format(
               "camera {}: its rotation to the IMU is not calibrated; by its turning R_B_C is [{:.3f} {:.3f} {:.3f}; "
               "{:.3f} {:.3f} {:.3f}; {:.3f} {:.3f} {:.3f}] +- {:.1f} deg",
               check.camera.name, R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2),
               check.agreement->rotation_sigma * kDegreesPerRadian),
           "a run needs it and the lever arm: calibrate camera and IMU together, for instance with Kalibr");
}

void judge_scale(const CameraCheck& check, Findings& out) {
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
void judge_gyro_scale(const CameraCheck& check, Findings& out) {
  constexpr double kLeast = 0.04, kUnexplained = 0.1, kDetermined = 0.015, kEventImages = 0.05;
  const GyroAgreement& found = *check.agreement;
  if (found.scale_sigma <= 0.0 || found.scale_unexplained > kUnexplained) return;
  const double common = check.camera.modality == Modality::Events ? kEventImages : found.scale_unexplained / 10;
  const double sigma = std::hypot(found.scale_sigma, common);
  const double off = found.gyro_scale - 1.0;
  const std::string number = fmt::format("{:.1f} % +- {:.1f} %", 100 * std::abs(off), 100 * sigma);
  if (std::abs(off) > std::max(kLeast, kSigmas * sigma))
    out.warn(fmt::format("camera {}: the gyro reads {} too {} by its turning", check.camera.name, number,
                         off > 0 ? "much" : "little"),
             fmt::format("divide the gyro by {:.3f}; or the focal length is wrong by as much", found.gyro_scale));
  else if (sigma > kDetermined)
    out.note(fmt::format("camera {}: the gyro's scale cannot be determined by it (+- {:.1f} %)", check.camera.name,
                         100 * sigma));
  else
    out.good(fmt::format("camera {}: the gyro's scale agrees with it to {}", check.camera.name, number));
}

/// Uses the camera with the most information. Rotations overlap and displacements are noisy: the correlation of n
/// unrelated ones is 1.2 / sqrt(n).
void judge_accel(const std::vector<CameraCheck>& cameras, Findings& out) {
  constexpr double kLeast = 0.3, kByChance = 3.0;
  const CameraCheck* best = nullptr;
  const auto surety = [=](const CameraCheck& check) {
    const AccelAgreement& accel = check.agreement->accel;
    return std::abs(accel.correlation) / std::max(kLeast, kByChance / std::sqrt(static_cast<double>(accel.turns)));
  };
  for (const CameraCheck& check : cameras) {
    if (!check.agreement || check.agreement->mirrored || check.agreement->accel.turns < kFewestAccelTurns) continue;
    if (!best || surety(check) > surety(*best)) best = &check;
  }
  if (!best || surety(*best) <= 1.0) return;
  const AccelAgreement& accel = best->agreement->accel;
  if (accel.correlation < 0.0)
    out.error(fmt::format("accelerometer: camera {} moves against it (correlation {:.2f} over {} turns)",
                          best->camera.name, accel.correlation, accel.turns),
              "the sign of all its axes is wrong: multiply it by -1; at rest it must read +9.8 m/s^2 along the axis "
              "that points up");
  else
    out.good(fmt::format("camera {}: it agrees with the accelerometer (correlation {:.2f})", best->camera.name,
                         accel.correlation));
}

/// False if the calibration is for a sensor of another size.
bool judge_size(const CameraCheck& check, const Survey& s, Findings& out) {
  const cv::Size calibrated(check.camera.model.width(), check.camera.model.height());
  const bool events = check.camera.modality == Modality::Events;
  const auto further = std::ranges::find(s.more, check.camera.name, &Survey::camera);
  const Survey& of_camera = further == s.more.end() ? s : *further;
  const cv::Size seen = events ? of_camera.event_details.extent : of_camera.image_size;
  const bool fits = events ? seen.width <= calibrated.width && seen.height <= calibrated.height : seen == calibrated;
  if (!fits && !seen.empty())
    out.error(fmt::format("camera {}: calibrated for {} x {} px, recorded {} x {}", check.camera.name, calibrated.width,
                          calibrated.height, seen.width, seen.height),
              "choose the calibration of this camera, and of this resolution");
  return fits || seen.empty();
}

void judge_calibration(const CameraCheck& check, Findings& out) {
  if (check.agreement->mirrored)
    return out.error(
        fmt::format("camera {}: the gyro turns the other way, as if it were seen in a mirror", check.camera.name),
        "one or all three of its axes have the wrong sign: a right-handed IMU has x turning towards y about z");
  judge_shift(check, out);
  check.has_extrinsics ? judge_rotation(check, out) : tell_rotation(check, out);
  judge_scale(check, out);
  judge_gyro_scale(check, out);
}

void judge_camera(const CameraCheck& check, Findings& out) {
  const std::string& name = check.camera.name;
  if (!check.agreement)
    return out.note(
        fmt::format("camera {}: cannot be compared with the gyro: too few turns with corners and IMU samples", name));
  if (!check.sure())
    return out.note(fmt::format(
        "camera {}: turns too little, or too differently from the gyro, to check its calibration ({:.0f} % of "
        "its turning unexplained)",
        name, 100 * std::min(1.0, check.agreement->unexplained)));
  Findings found;
  judge_calibration(check, found);
  const bool contradicts =
      std::ranges::any_of(found.list, [](const Finding& f) { return f.severity >= Severity::Warning; });
  if (contradicts && check.agreement->turning < check.least_turning)
    return out.note(fmt::format("camera {}: turns for {:.1f} s only, too little to check its calibration ({} s are "
                                "needed)",
                                name, to_seconds(check.agreement->turning), to_seconds(check.least_turning)),
                    "record more in which the sensor turns about all axes before a scene with texture");
  out.list.insert(out.list.end(), found.list.begin(), found.list.end());
}

void judge_truth(const Survey& s, Findings& out) {
  if (!s.truth || s.truth->stream.count == 0 || s.imu.count == 0) return;
  const StreamSurvey& truth = s.truth->stream;
  if (*truth.begin > *s.imu.end || *truth.end < *s.imu.begin)
    out.warn("ground truth does not overlap: " + interval("truth", truth) + ", " + interval("IMU", s.imu),
             "its clock is another one: shift it before evaluating");
  else
    out.good(fmt::format("ground truth: {} poses, path {:.1f} m", truth.count, s.truth->path_m));
}

}  // namespace

bool imu_unusable(const std::vector<Finding>& findings) {
  return std::ranges::any_of(findings, &Finding::imu_unusable);
}

std::vector<Finding> diagnose(const Survey& survey, bool calibrated, const std::vector<CameraCheck>& cameras) {
  Findings out;
  judge_sensors(survey, out);
  judge_imu(survey, cameras, out);
  judge_events(survey, out);
  judge_frames(survey, out);
  judge_further_cameras(survey, out);
  judge_external(survey.external, survey.imu, out.list);
  const bool comparable = !imu_unusable(out.list);
  for (const CameraCheck& check : cameras)
    if (judge_size(check, survey, out) && comparable) judge_camera(check, out);
  if (comparable) judge_accel(cameras, out);
  if (!calibrated)
    out.note("no calibration, so none is checked", "give --rig NAME or --calib FILE");
  else if (cameras.empty())
    out.note("the calibration has no camera that could be compared with a gyro");
  judge_truth(survey, out);
  for (const auto& [kind, count] : survey.repairs)
    out.note(fmt::format("repaired while reading: {} ({})", kind, count));
  return out.list;
}

}  // namespace edged
