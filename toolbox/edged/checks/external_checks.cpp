// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "edged/core/measurements/external_sensor.hpp"

namespace edged {
namespace {

constexpr double kFewest_hz = 2.0;
constexpr Duration kFrozen = std::chrono::seconds(5);
constexpr double kFastestClimb_mps = 30.0, kFastest_mps = 60.0;
constexpr double kTooSure = 3.0;

void check_rate(const std::string& name, const ExternalStatistics& s, Findings& out) {
  const StreamStatistics& stream = s.stream;
  const double rate = stream.typical_step > Duration(0) ? 1.0 / to_seconds(stream.typical_step) : 0.0;
  if (rate < kFewest_hz)
    out.warn(fmt::format("{} at {:.1f} Hz", name, rate),
             "record it at 10 Hz or more: one sample per second bounds the drift only for an instant");
  else if (stream.gaps > 0)
    out.warn(fmt::format("{} at {:.0f} Hz, {} gaps of {:.1f} s together, the longest {:.1f} s at {:.3f} s", name, rate,
                         stream.gaps, to_seconds(stream.missing), to_seconds(stream.longest.front().length),
                         to_seconds(stream.longest.front().after)),
             "within a gap it does not bound the drift; remove the samples of a range finder that is out of range "
             "instead of repeating them");
  else
    out.good(fmt::format("{} at {:.0f} Hz", name, rate));
}

/// The unit, by the fastest change; with the right one, the noise.
void check_values(const std::string& name, const ExternalStatistics& s, Findings& out) {
  const ExternalSensor& sensor = *find_external_sensor(name);
  const bool speed = sensor.unit == "m/s";
  double most = 0.0;
  for (std::size_t i = 0; i < s.most.size(); ++i) most = std::max({most, s.most[i], -s.least[i]});
  if (speed ? most > kFastest_mps : s.fastest > kFastestClimb_mps)
    out.error(speed ? fmt::format("{}: up to {:.0f} m/s", name, most)
                    : fmt::format("{}: changes by {:.0f} m in a second", name, s.fastest),
              fmt::format("its unit is {}, not mm or feet: name it in the first line, such as `{} [mm{}]`", sensor.unit,
                          sensor.columns[0], speed ? "/s" : ""));
  else if (s.sigma > 0.0 && s.noise > kTooSure * s.sigma)
    out.warn(fmt::format("{}: noise of {:.2g} {}, its samples state {:.2g}", name, s.noise, sensor.unit, s.sigma),
             "give a larger sigma, or none and the option");
}

}  // namespace

void check_external(const CheckInput& input, Findings& out) {
  const StreamStatistics& imu = input.recording.imu;
  for (const auto& [name, s] : input.recording.external) {
    if (s.stream.count < 3) {
      out.warn(fmt::format("{}: {} samples", name, s.stream.count), "too few to be of use");
      continue;
    }
    check_rate(name, s, out);
    if (imu.count > 0 && (*s.stream.begin > *imu.end || *s.stream.end < *imu.begin))
      out.error(fmt::format("{}: none of its time is covered by the IMU", name),
                "stamp it on the clock of the IMU, or shift its stamps");
    if (s.constant >= kFrozen)
      out.warn(fmt::format("{}: the same numbers for {:.1f} s", name, to_seconds(s.constant)),
               "a sensor that is frozen or out of range: leave these samples out; one at rest for that long has noise");
    check_values(name, s, out);
  }
}

}  // namespace edged
