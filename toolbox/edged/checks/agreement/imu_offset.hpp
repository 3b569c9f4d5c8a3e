// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The offset of an IMU whose clock has an epoch of its own, and its drift, by the turn rates of a camera.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/checks/agreement/rate_match.hpp"
#include "edged/rig.hpp"

namespace edged {

/// How the clock of an IMU becomes that of the cameras: t = t_first + offset + (t_imu - t_first) / rate, with t_first
/// the IMU's first stamp.
struct ImuOffset {
  Duration offset{0};
  double rate = 1.0;                   ///< seconds of the IMU per second of the cameras
  double sigma_s = 0.0;                ///< of the offset in the middle of the recording
  std::optional<double> rate_sigma{};  ///< nothing if the recording is too short to determine the rate, which is then 1
  std::optional<RateMatch> match{};    ///< how clearly the turn rates determine the offset
  std::size_t pieces = 0;              ///< of the recording, in which the rotations agree
  /// One offset is far better than all others, and the rotations agree there.
  bool determined() const { return match && match->unique && pieces > 0; }
};

/// The offset in one piece of the recording.
struct PieceOffset {
  double t_s;  ///< of the IMU from its first sample on
  double x_s;  ///< what is to be added to its stamps
  double sigma_s;
};

/// turns: of a piece. shift: t_imu = t_camera + shift, to 0.1 s. Nothing where the rotations do not determine it.
std::optional<PieceOffset> offset_of(std::span<const Turn> turns, std::span<const ImuSample> samples,
                                     const RigCamera& camera, Duration shift);

/// pieces: the turns of parts of the recording, in time order. camera: that of the turns. has_extrinsics: its rotation
/// to the body is calibrated.
ImuOffset find_imu_offset(std::span<const std::vector<Turn>> pieces, std::span<const ImuSample> samples,
                          const RigCamera& camera, bool has_extrinsics);

/// Collects what find_imu_offset() needs in one pass: of the first minute all turns, then those of a third of the time.
class ImuOffsetSearch {
 public:
  ImuOffsetSearch(RigCamera camera, bool has_extrinsics);

  /// To be called with each measurement, in any order of the sensors.
  void add(const Measurement& measurement);
  ImuOffset result();

 private:
  void end_piece();

  RigCamera camera_;
  bool has_extrinsics_;
  std::vector<ImuSample> samples_;
  std::vector<std::vector<Turn>> pieces_;
  std::optional<VisualTurns> visual_;
  std::optional<Timestamp> begin_;  ///< first stamp of the camera
  Duration::rep piece_ = 0;         ///< number of the current one
};

}  // namespace edged
