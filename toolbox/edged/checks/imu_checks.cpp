// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "edged/checks/check_groups.hpp"
#include "edged/core/angles.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/se3.hpp"

namespace edged {
namespace {

constexpr Duration kLongGap = std::chrono::milliseconds(500);  // a longer one loses a run

void check_imu_rate(const CheckInput& input, Findings& out) {
  const RecordingStatistics& s = input.recording;
  const double rate = s.imu.typical_step > Duration(0) ? 1.0 / to_seconds(s.imu.typical_step) : 0.0;
  if (rate < 100.0)
    out.warn(fmt::format("IMU at {:.0f} Hz", rate),
             "record it at 200 Hz or more: between samples the motion is interpolated");
  else
    out.good(fmt::format("IMU at {:.0f} Hz", rate));
}

/// Time of the IMU's samples in stretches that the gate refuses.
Duration refused_time(const RecordingStatistics& s) {
  std::size_t samples = 0;
  for (const ImuFaultRecord& fault : s.imu_faults)
    if (fault.longest > Duration(0)) samples += fault.count;
  return s.imu.typical_step * static_cast<Duration::rep>(samples);
}

/// Gaps that the gate makes are no findings of their own.
void check_gaps(const CheckInput& input, Findings& out) {
  const StreamStatistics& imu = input.recording.imu;
  if (imu.gaps == 0 || refused_time(input.recording) > imu.missing * 9 / 10) return;
  const Gap& longest = imu.longest.front();
  const std::string text = fmt::format("{} IMU gaps of {:.3f} s together, the longest {:.3f} s at {:.3f} s", imu.gaps,
                                       to_seconds(imu.missing), to_seconds(longest.length), to_seconds(longest.after));
  const std::string remedy =
      "in a gap the cameras alone determine the motion; look for an overloaded USB bus or a full disk";
  longest.length > kLongGap ? out.error(text, remedy) : out.warn(text, remedy);
}

/// A working sensor does not repeat its readings to the last bit for long, neither all axes nor one of them.
void check_frozen(const char* sensor, const char* unit, const FrozenReadings& f, Findings& out) {
  constexpr Duration kShort = std::chrono::seconds(1);
  const std::string value = fmt::format("({:.4g}, {:.4g}, {:.4g}) {}", f.value.x(), f.value.y(), f.value.z(), unit);
  if (f.dead())
    return out.error(
        f.value.isZero(0.0) ? fmt::format("{} is constant zero", sensor)
                            : fmt::format("{} does not change: it is {} all the time", sensor, value),
        fmt::format("the driver does not set it, or it has a topic of its own: record the {}, too", sensor),
        Unusable::Calibration);
  for (const std::size_t axis : {0, 1, 2})
    if (f.dead(axis))
      out.error(fmt::format("{}: its {} axis does not change", sensor, "xyz"[axis]),
                "check its columns and the driver: two axes are not enough", Unusable::Calibration);
  if (f.longest >= kShort)
    out.error(fmt::format("{} does not change for {:.1f} s from {:.3f} s: it reads {}", sensor, to_seconds(f.longest),
                          to_seconds(f.since), value),
              "the driver repeats its last sample: remove these samples, then they count as a gap");
}

/// Limits far beyond the factor of 2 to 5 of usual calibrations, and that of vibration.
void check_noise(const CheckInput& input, Findings& out) {
  constexpr double kTimes = 30.0, kFatal = 100.0;
  const std::optional<ImuRest>& rest = input.recording.imu_details.rest;
  if (!input.noise || !rest) return;
  const auto compare = [&](const char* sensor, const char* unit, double given, double found) {
    const double times = given / found;
    if (found <= 0.0 || (times < kTimes && times > 1.0 / kTimes)) return;
    const std::string text =
        fmt::format("{}: calibrated noise of {:.2g} {}/sqrt(Hz), but {:.2g} at rest, for {:.1f} s from {:.3f} s on",
                    sensor, given, unit, found, to_seconds(rest->length), to_seconds(rest->begin));
    const std::string remedy =
        "it is a density, not a deviation: write 2 to 5 times that at rest, which "
        "`edged calib REC --imu-noise` measures";
    times > kFatal ? out.error(text, remedy) : out.warn(text, remedy);
  };
  compare("gyro", "rad/s", input.noise->gyro_noise, rest->gyro_noise);
  compare("accelerometer", "m/s^2", input.noise->accel_noise, rest->accel_noise);
}

std::string axes_text(unsigned axes) {
  switch (axes) {
    case 0b111111:
      return "gyro and accelerometer";
    case 0b000111:
      return "gyro";
    case 0b111000:
      return "accelerometer";
    default: {
      const int axis = std::countr_zero(axes);
      return fmt::format("{}'s {} axis", axis < 3 ? "gyro" : "accelerometer", "xyz"[axis % 3]);
    }
  }
}

/// What the gate of a run refuses, or gives another stamp.
void check_gate(const CheckInput& input, Findings& out) {
  for (std::size_t i = 0; i < kImuFaults; ++i) {
    const ImuFaultRecord& fault = input.recording.imu_faults[i];
    if (fault.count == 0) continue;
    const std::string where =
        fault.axes == 0 ? fmt::format("the first at {:.3f} s", to_seconds(fault.from))
                        : fmt::format("{} for {:.3f} s from {:.3f} s on is the longest", axes_text(fault.axes),
                                      to_seconds(fault.longest), to_seconds(fault.from));
    const std::string text = fmt::format("{} IMU samples {}: {}", fault.count, imu_fault_infos()[i].text, where);
    const std::string remedy(imu_fault_infos()[i].remedy);
    fault.longest > kLongGap ? out.error(text, remedy) : out.warn(text, remedy);
  }
  // Readers drop some before the gate.
  const auto dropped = input.recording.repairs.find("imu: out of order, dropped");
  const std::size_t late = input.recording.imu_faults[ImuFault::Late].count +
                           (dropped == input.recording.repairs.end() ? 0 : dropped->second);
  if (late > input.recording.imu.count)
    out.error(fmt::format("{} IMU samples are late, {} are not", late, input.recording.imu.count),
              std::string(imu_fault_infos()[ImuFault::Late].remedy), Unusable::Calibration);
}

void check_frozen_readings(const CheckInput& input, Findings& out) {
  check_frozen("gyro", "rad/s", input.recording.imu_details.gyro_frozen, out);
  check_frozen("accelerometer", "m/s^2", input.recording.imu_details.accel_frozen, out);
}

std::string lengths_text(const RecordingStatistics& s, double cameras_s) {
  return fmt::format("the IMU covers {:.1f} s, the other sensors {:.1f} s", to_seconds(s.imu.length()), cameras_s);
}

/// The ratio of the durations of IMU and cameras, if it is close to two or a power of a thousand: another clock or
/// unit.
std::optional<double> known_span_ratio(const RecordingStatistics& s, double cameras_s) {
  constexpr double kNear = 0.02, kLeast_s = 1.0;
  const double ratio = s.imu_span_ratio();
  for (const double known : {2.0, 0.5, 1e3, 1e-3, 1e6, 1e-6, 1e9, 1e-9})
    if (cameras_s > kLeast_s && std::abs(ratio / known - 1.0) < kNear) return known;
  return std::nullopt;
}

/// True if the gyro explains the rotations with about the calibrated R_B_C. With clocks of different rates, a very
/// different R_B_C may seem to fit.
bool turns_as_calibrated(const CameraCheck& check) {
  constexpr double kMost_deg = 20.0;
  if (!check.sure() || !check.has_extrinsics) return check.sure();
  const Eigen::Quaterniond R_B_C(check.agreement->R_B_C);
  return so3::log(check.camera.T_B_C.rotation().conjugate() * R_B_C).norm() < kMost_deg * kDegree;
}

/// By the rotation of camera and gyro. known: the ratio of their durations, where it is a known one.
void tell_clock_rate(const CheckInput& input, const CameraCheck& measured, double cameras_s,
                     const std::optional<double>& known, Findings& out) {
  constexpr double kSameLength = 0.05;
  const bool as_lasts = known && std::abs(measured.clock->rate / *known - 1.0) < kSameLength;
  // A few seconds of rotation determine the rate to a few per cent only.
  const double rate = as_lasts ? *known : measured.clock->rate;
  const bool far_off = std::abs(rate - 1.0) > 0.1;
  const bool lasts = far_off && std::abs(input.recording.imu_span_ratio() / rate - 1.0) < kSameLength;
  out.error(fmt::format("{} clock runs at {:.{}f} times that of camera {}, by the rotation of both",
                        lasts ? lengths_text(input.recording, cameras_s) + ": its" : "the IMU's", rate, far_off ? 2 : 3,
                        measured.camera.name),
            fmt::format("--imu-clock-rate {:.3f} corrects the stamps from the first sample on; then correct the driver",
                        rate),
            Unusable::Calibration);
}

void check_clock(const CheckInput& input, Findings& out) {
  constexpr double kTogether_s = 0.3;
  const RecordingStatistics& s = input.recording;
  const auto visual = s.cameras();
  if (!visual) return;
  const double cameras_s = to_seconds(visual->second - visual->first);
  const auto known = known_span_ratio(s, cameras_s);
  const bool agrees = std::ranges::any_of(input.cameras, turns_as_calibrated);
  // Rates that differ by less than a tenth let a camera turn about as calibrated.
  const auto measured = std::ranges::find_if(
      input.cameras, [=](const CameraCheck& c) { return c.clock && !(agrees && std::abs(c.clock->rate - 1.0) > 0.1); });
  if (measured != input.cameras.end()) return tell_clock_rate(input, *measured, cameras_s, known, out);
  if (agrees || !known || std::abs(to_seconds(*s.imu.begin - visual->first)) > kTogether_s * std::max(1.0, *known))
    return;
  const bool unit = *known > 10.0 || *known < 0.1;
  out.error(lengths_text(s, cameras_s) + (unit ? ": its stamps are in another unit"
                                               : fmt::format(": its clock runs at {:.1f} times theirs", *known)),
            unit ? "write all stamps in one unit"
                 : fmt::format(
                       "--imu-clock-rate {:.3g} corrects the stamps from the first sample on; then correct the driver",
                       *known),
            Unusable::Calibration);
}

/// True if gravity, which has a constant norm, is in the columns of the gyro and not in those of the accelerometer.
bool columns_swapped(const ImuStatistics& imu) {
  const double calm = imu.calm ? imu.calm->gyro.norm() : imu.mean_gyro;  // a mean, so that motion does not count
  return imu.mean_gyro > 8.0 && imu.mean_gyro < 16.0 && calm > 8.5 && calm < 11.5 &&
         imu.mean_accel < 0.6 * imu.mean_gyro;
}

void check_columns(const CheckInput& input, Findings& out) {
  const ImuStatistics& imu = input.recording.imu_details;
  if (columns_swapped(imu))
    out.error(
        fmt::format("gyro and accelerometer are swapped: the gyro has gravity (mean {:.2f}), the accelerometer a mean "
                    "of {:.2f}",
                    imu.mean_gyro, imu.mean_accel),
        "exchange the columns: an imu.txt has t ax ay az gx gy gz, EuRoC's data.csv t gx gy gz ax ay az");
}

void check_accel_unit(const CheckInput& input, Findings& out) {
  const ImuStatistics& imu = input.recording.imu_details;
  if (columns_swapped(imu) || imu.accel_frozen.dead()) return;
  const double g = imu.mean_accel;
  const double calm = imu.calm ? imu.calm->accel.norm() : g;  // a mean, so that motion does not count
  if (g > 0.7 && g < 2.5 && calm > 0.8 && calm < 1.25)
    out.error(fmt::format("accelerometer in g: its mean is {:.2f}, not about 9.8 m/s^2", g), "multiply it by 9.80665");
  else if (g > 8000 && g < 12000)
    out.error(fmt::format("accelerometer in mm/s^2: its mean is {:.0f}", g), "divide it by 1000");
  else if (g < 2.5)
    out.error(fmt::format("accelerometer without gravity: its mean is {:.2f} m/s^2", g),
              "record the raw specific force, not the linear acceleration");
  else if (g < 8.0 || g > 13.0)
    out.warn(fmt::format("accelerometer with a mean of {:.2f} m/s^2, not about 9.8", g), "check its scale and unit");
  else
    out.good(fmt::format("accelerometer in m/s^2 (mean {:.2f})", g));
}

/// At rest one attitude cannot separate scale from bias. Right recordings read up to 0.1 m/s^2 off (simulator,
/// mirrors).
void check_gravity(const CheckInput& input, Findings& out) {
  constexpr double kLeast = 0.25, kMost = 1.8;  // [m/s^2] beyond the latter it is the unit
  const std::optional<ImuRest>& rest = input.recording.imu_details.rest;
  if (!rest || input.recording.imu_details.accel_frozen.dead()) return;
  const double off = rest->accel.norm() - kGravity;
  if (std::abs(off) < kLeast || std::abs(off) > kMost) return;
  out.warn(fmt::format("accelerometer: it reads {:.2f} m/s^2 at rest, for {:.1f} s from {:.3f} s on, not {:.2f}",
                       rest->accel.norm(), to_seconds(rest->length), to_seconds(rest->begin), kGravity),
           fmt::format("a scale {:.1f} % too {}, or a bias as large: calibrate it at rest in six attitudes",
                       100.0 * std::abs(off) / kGravity, off > 0.0 ? "large" : "small"));
}

void check_gyro_unit(const CheckInput& input, Findings& out) {
  constexpr double kFastest = 6.0;  // mean angular speed of a flight [rad/s]: a turn a second, all the time
  const ImuStatistics& imu = input.recording.imu_details;
  if (columns_swapped(imu) || imu.gyro_frozen.dead()) return;
  const bool compared = std::ranges::any_of(input.cameras, &CameraCheck::sure);
  if (std::ranges::any_of(input.cameras, &CameraCheck::in_degrees))
    out.error("gyro in deg/s: it turns 57 times as fast as the camera", "multiply it by pi / 180");
  else if (!compared && imu.mean_gyro > kFastest)
    out.error(fmt::format("gyro probably in deg/s: its mean is {:.1f}", imu.mean_gyro), "multiply it by pi / 180");
  else
    out.good(fmt::format("gyro with a mean of {:.2f}, highest {:.2f} rad/s{}", imu.mean_gyro, imu.max_gyro,
                         compared ? "" : " (its unit is not checked against a camera)"));
}

constexpr Check kImuChecks[] = {check_imu_rate, check_gate,       check_gaps,    check_clock,     check_frozen_readings,
                                check_columns,  check_accel_unit, check_gravity, check_gyro_unit, check_noise};

}  // namespace

// Corners on images of events underestimate rotation by a third, and no other unit is within a factor of two.
bool CameraCheck::in_degrees() const {
  const double ratio = sure() ? agreement->gyro_scale / kDegreesPerRadian : 0.0;
  return ratio > 0.5 && ratio < 2.0;
}

void check_imu(const CheckInput& input, Findings& out) {
  if (input.recording.imu.count == 0) return;
  for (const Check check : kImuChecks) check(input, out);
}

}  // namespace edged
