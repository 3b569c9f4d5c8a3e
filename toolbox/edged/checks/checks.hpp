// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Checks of a recording and its calibration: each reports findings with severity, cause and remedy.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/checks/agreement/gyro_agreement.hpp"
#include "edged/checks/agreement/imu_clock.hpp"
#include "edged/checks/agreement/readout.hpp"
#include "edged/checks/finding.hpp"
#include "edged/checks/statistics/recording_statistics.hpp"
#include "edged/imu_noise.hpp"
#include "edged/rig.hpp"

namespace edged {

/// A camera compared with the gyro.
struct CameraCheck {
  RigCamera camera;  ///< as calibrated
  bool has_extrinsics = true;
  std::optional<GyroAgreement> agreement;  ///< nothing without enough rotations to compare
  std::optional<ClockRate> clock = {};     ///< if the IMU clock runs at another rate than the camera clock
  Duration least_turning{0};               ///< a contradiction in a shorter turning_time() does not count
  std::optional<std::string> lens = {};    ///< better_lens()
  double gross_deg = 0.0;                  ///< grossly_off_deg()
  std::optional<Readout> readout = {};     ///< readout_of() standard frames

  /// True if the gyro explains enough of the rotation for the other results to be reliable.
  bool sure() const { return agreement && agreement->unexplained < 0.5; }
  /// True if the gyro is in deg/s.
  bool in_degrees() const;
};

/// What the checks judge.
struct CheckInput {
  const RecordingStatistics& recording;
  bool calibrated = false;  ///< there is a calibration, possibly of other cameras than the recorded ones
  std::vector<CameraCheck> cameras = {};
  bool dropped_frames = false;                 ///< by the run itself, which was too slow for them
  std::optional<std::string> accel_axes = {};  ///< AccelAxes::better()
  std::optional<ImuNoise> noise = {};          ///< as calibrated
  std::vector<std::string> exchanged = {};     ///< StereoAgreement::exchanged()
  std::optional<std::string> flipped = {};     ///< EventAgreement::better()
};

/// The remedy for a camera whose inverse transform fits.
inline constexpr const char* kTurnRound =
    "the transform points the other way, and so does its translation, which no run corrects: write it as T_C_B "
    "(`edged calib` shows both directions)";

/// True if a finding makes that unusable.
bool is_unusable(Unusable what, const std::vector<Finding>& findings);

/// All checks, in the order of their subjects: streams, IMU, events, frames, external sensors, calibration, ground
/// truth, repairs.
std::vector<Finding> check_recording(const CheckInput& input);

}  // namespace edged
