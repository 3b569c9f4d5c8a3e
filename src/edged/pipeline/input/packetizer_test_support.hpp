// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Recordings with known stamps and their packets, for tests of the packetizer. A camera has 100 pixels,
// so that 35 events make a packet.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <variant>
#include <vector>

#include "edged/measurement.hpp"
#include "edged/pipeline/input/packetizer.hpp"
#include "edged/pipeline/mode.hpp"
#include "edged/rig.hpp"

namespace edged {

inline constexpr std::size_t kCut = 35;  // events that make a packet
inline Timestamp ms_stamp(double ms) { return timestamp_from_seconds(1e-3 * ms); }
inline ImuSample imu_at(double ms) {
  // Linear in time, so that interpolation can be checked.
  return {ms_stamp(ms), Eigen::Vector3d(1e-3 * ms, 0, 0), Eigen::Vector3d(0, 0, 9.81)};
}

inline double to_ms(Timestamp t) { return 1e3 * to_seconds(t); }

inline Rig make_rig(double event_offset_ms = 0.0, double frame_offset_ms = 0.0) {
  const CameraModel model(10, 10, 10, 10, 5, 5);
  return {"test",
          {{"dvs", Modality::Events, model, SE3(), duration_from_seconds(1e-3 * event_offset_ms)},
           {"cam", Modality::Frames, model, SE3(), duration_from_seconds(1e-3 * frame_offset_ms)}}};
}

/// A recording under construction; stamps in ms as recorded.
struct TestStream {
  std::vector<std::pair<Timestamp, Measurement>> measurements;

  TestStream& imu(double from, double to, double step) {
    for (double ms = from; ms <= to + 1e-9; ms += step) measurements.emplace_back(ms_stamp(ms), imu_at(ms));
    return *this;
  }
  TestStream& events(double from, double to, double step) {
    for (double ms = from; ms <= to + 1e-9; ms += step) {
      measurements.emplace_back(ms_stamp(ms), EventBatch{"dvs", {{ms_stamp(ms), 1, 2, true}}});
    }
    return *this;
  }
  TestStream& frames(double from, double to, double step) {
    for (double ms = from; ms <= to + 1e-9; ms += step) {
      measurements.emplace_back(ms_stamp(ms), Frame{ms_stamp(ms), "cam", cv::Mat()});
    }
    return *this;
  }
};

struct PacketizerResult {
  std::vector<Packet> packets;
  PacketizerCounters counters;
};

inline constexpr PacketizerConfig kQuick{.min_interval_s = 0.015};  // many packets from little data
inline PacketizerResult packetize(TestStream stream, Mode mode, const Rig& rig = make_rig(),
                                  const PacketizerConfig& config = kQuick) {
  const auto rank = [](const Measurement& m) {
    return std::holds_alternative<ExternalSample>(m) ? -1
           : std::holds_alternative<ImuSample>(m)    ? 0
           : std::holds_alternative<EventBatch>(m)   ? 1
                                                     : 2;
  };
  std::stable_sort(stream.measurements.begin(), stream.measurements.end(), [&](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : rank(a.second) < rank(b.second);
  });
  Packetizer packetizer(used_cameras(rig, mode), config);
  PacketizerResult result;
  const auto collect = [&] {
    while (auto packet = packetizer.next()) result.packets.push_back(std::move(*packet));
  };
  for (const auto& [t, measurement] : stream.measurements) {
    packetizer.add(measurement);
    collect();
  }
  packetizer.finish();
  collect();
  result.counters = packetizer.counters();
  return result;
}

inline std::size_t sum_of_new_events(const PacketizerResult& result) {
  std::size_t sum = 0;
  for (const Packet& packet : result.packets) sum += packet.events[0].new_events;
  return sum;
}

}  // namespace edged
