// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The clock of an IMU by --imu-time-offset and --imu-clock-rate: as given, or determined from the recording.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "edged/checks/agreement/imu_offset.hpp"
#include "edged/input_error.hpp"
#include "edged/io/core/replaced_streams.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// The clock of an IMU, and how it was determined.
struct ChosenImuClock {
  ImuClock clock;
  std::optional<ImuOffset> found;  ///< of `auto`
};

/// "+1000.0031 s", and "+- 0.4 ms, drift -48.1 +- 3.0 ppm; turn rates correlate by 0.98, at other offsets by at most
/// 0.41".
std::string offset_text(const ChosenImuClock& chosen);
std::string offset_evidence(const ImuOffset& found);
/// Of one that was found.
nlohmann::ordered_json to_json(const ChosenImuClock& chosen);

/// Reads the recording through, once for each kind of camera until one determines the offset. reopen: opens it, without
/// any correction. rate: of --imu-clock-rate. Throws InputError if the rotation does not determine it.
ChosenImuClock determine_imu_clock(const std::function<Recording()>& reopen, double rate);

/// Why the turn rates of this camera and the gyro do not determine the offset.
InputError undetermined_offset(const std::string& recording, const std::string& camera, const ImuOffset& found);

/// The seconds of --imu-time-offset; nothing for "auto". Throws InputError for other text.
std::optional<double> given_imu_offset_s(const std::string& text);

}  // namespace edged
