// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The clock of an IMU with an epoch of its own: as given, determined from a recording, or from what arrives live.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/checks/agreement/imu_drift.hpp"
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

/// The recorded cameras that the calibration has: those of the same name, and of each kind its first for the first.
/// Without a recorded IMU none.
std::vector<RigCamera> calibrated_cameras(const Recording& recording);

/// Passes all measurements to `use`. False if the user has interrupted that.
using ReadThrough = std::function<bool(Dataset&, const std::function<void(const Measurement&)>& use)>;

/// Reads the recording through, once for each kind of camera until one determines the offset. reopen: opens it, without
/// any correction. rate: of --imu-clock-rate. Nothing is found if the user interrupts that. Throws InputError if the
/// rotation does not determine it.
ChosenImuClock determine_imu_clock(const std::function<Recording()>& reopen, const ReadThrough& read, double rate);

/// Why the turn rates of this camera and the gyro do not determine the offset.
InputError undetermined_offset(const std::string& recording, const std::string& camera, const ImuOffset& found);

/// The seconds of --imu-time-offset; nothing for "auto". Throws InputError for other text.
std::optional<double> given_imu_offset_s(const std::string& text);

/// For measurements that arrive live and are seen once. Where the offset is not given, the rotation of the first 10 s
/// determines it, else that of the next: nothing is passed on until then; then its drift is followed. An IMU that
/// begins to count again is searched again. Says in the log what is found, and why nothing is.
class LiveImuClock {
 public:
  /// offset_s: nothing if it is to be found, by the first of these cameras of each kind, frames before events.
  /// Throws InputError without any.
  LiveImuClock(std::optional<double> offset_s, double rate, std::span<const RigCamera> cameras, bool has_extrinsics);

  /// The measurement, on one clock; nothing while the offset is not known. Those of a sensor in their order.
  std::optional<Measurement> pass(Measurement measurement);
  bool known() const { return given_ || line_; }

 private:
  bool begins_again(Timestamp stamp);
  ClockLine line_by(Duration offset) const { return ImuClock{offset, rate_}.from(*first_); }
  void begin();
  void search(const Measurement& measurement);

  const double rate_;
  std::vector<RigCamera> cameras_;
  const bool has_extrinsics_;
  const std::optional<Duration> given_;  ///< offset
  std::optional<ClockLine> line_;
  std::optional<ImuDrift> drift_;                 ///< of a line that was found
  std::vector<ImuOffsetSearch> searches_;         ///< one a camera; none while the line is known
  std::optional<Timestamp> searched_from_;        ///< by the cameras
  int tries_ = 0;                                 ///< since then
  std::optional<Timestamp> first_;                ///< of the IMU
  std::optional<std::array<Timestamp, 4>> last_;  ///< of the IMU, the newest last
};

/// A live source of which each measurement passes that clock.
Recording with_live_imu_clock(Recording source, std::optional<double> offset_s, double rate);

}  // namespace edged
