// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How many measurements were used or dropped, and why.
#pragma once

#include <array>
#include <cstddef>
#include <variant>

#include "edged/measurement.hpp"

namespace edged {

/// One number for each kind of external sensor, in the order of ExternalSample.
using ExternalCounts = std::array<std::size_t, std::variant_size_v<ExternalSample>>;

/// Why a sample of the IMU is refused. Clipped ones pass with a mark, those that are Spread with another stamp.
enum class ImuFault : std::size_t { NotFinite, Late, BeyondRange, Spike, Repeated, Clipped, SharedStamp, Spread };
inline constexpr std::size_t kImuFaults = 8;

/// One value for each.
template <typename T>
struct ByImuFault : std::array<T, kImuFaults> {
  using std::array<T, kImuFaults>::operator[];
  T& operator[](ImuFault fault) { return (*this)[static_cast<std::size_t>(fault)]; }
  const T& operator[](ImuFault fault) const { return (*this)[static_cast<std::size_t>(fault)]; }
};
using ImuFaultCounts = ByImuFault<std::size_t>;

/// Samples of height and velocity sensors that arrived while there was an estimate.
struct ExternalCounters {
  ExternalCounts used{};      ///< by the estimator
  ExternalCounts rejected{};  ///< because they contradicted the estimate

  void add(const ExternalCounters& more) {
    for (std::size_t i = 0; i < used.size(); ++i) used[i] += more.used[i], rejected[i] += more.rejected[i];
  }
};

/// Measurements that were dropped on arrival.
struct IntakeCounters {
  std::size_t unknown_camera = 0;  ///< measurements of a camera that the rig does not have
  std::size_t unused_camera = 0;   ///< measurements of a camera of the rig that the run does not use
  std::size_t absurd_stamps = 0;   ///< events and measurements more than 146 years from zero
  std::size_t far_ahead =
      0;  ///< events and measurements more than 10 s ahead of all others and contradicted by the next
  std::size_t clocks_set_back = 0;  ///< number of clock jumps; the estimator restarts at each
  std::size_t events_outside = 0;   ///< events beyond the pixels of their camera
  std::size_t frames_unfit = 0;     ///< not grey (CV_8UC1), or not of their camera's size
  std::size_t external_unfit = 0;   ///< samples of other sensors: not finite, or more than such a sensor measures
  std::size_t no_room = 0;          ///< measurements that arrived with full queues, or after finish()
};

/// Input used and dropped. Every event added is in `new_events` of exactly one packet or in one of these counts.
struct PacketizerCounters {
  std::size_t packets = 0;             ///< handed out
  std::size_t packets_before_imu = 0;  ///< dropped: not after the first IMU sample
  std::size_t packets_after_imu = 0;   ///< dropped at the end: after the last IMU sample
  std::size_t packets_overflow = 0;    ///< dropped: the IMU stayed away for too long
  std::size_t events_late = 0;         ///< dropped: older than an event or a cut before them
  std::size_t events_surplus = 0;      ///< dropped: of bursts that no packet can hold, more than 4 million in 30 ms
  std::size_t events_flicker = 0;      ///< dropped: of lamps that flicker
  std::size_t events_lost = 0;         ///< new events of dropped packets, and those after the last cut
  std::size_t frames_late = 0;         ///< dropped: not after the last cut
  std::size_t frames_missing = 0;      ///< Frames mode: packets without one, as none came for 5 s
  ImuFaultCounts imu{};                ///< dropped IMU samples, and those that were spread
  ExternalCounts external{};           ///< samples of height and velocity sensors in packets
  ExternalCounts external_late{};      ///< dropped: of a time whose packet has been handed out
  ExternalCounts external_lost{};      ///< dropped: before the first packet, after the last, or too many waited
};

struct OdometryCounters {
  IntakeCounters intake;
  PacketizerCounters packets;
  ExternalCounters external;
};

}  // namespace edged
