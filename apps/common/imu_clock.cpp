// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/imu_clock.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/interrupt.hpp"
#include "common/json_text.hpp"
#include "common/reading.hpp"
#include "edged/core/check.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr double kPpm = 1e6;

/// The IMU samples at their place on the clock that is searched, all else as it is.
ImuOffset search(const Recording& recording, const RigCamera& camera, double rate) {
  ImuOffsetSearch search(camera, recording.calibration->has_extrinsics);
  if (camera.modality == Modality::Events) recording.dataset->leave_out(Modality::Frames);
  if (camera.modality == Modality::Frames) recording.dataset->leave_out(Modality::Events);
  std::optional<Timestamp> first;
  read_through(*recording.dataset, false, "read for the IMU's clock", [&](const Measurement& measurement) {
    const auto* sample = std::get_if<ImuSample>(&measurement);
    if (!sample) return search.add(measurement), true;
    if (!first) first = sample->t;
    ImuSample corrected = *sample;
    corrected.t = ImuClock{Duration(0), rate}.corrected(sample->t, *first);
    return search.add(corrected), true;
  });
  return search.result();
}

std::string why_undetermined(const ImuOffset& found) {
  if (!found.match) return "they do not change enough, few are seen, or the two hardly overlap";
  const RateMatch& match = *found.match;
  const std::string best =
      fmt::format("they correlate by {:.2f} at {:+.2f} s", match.correlation, -to_seconds(match.shift));
  if (match.unique) return best + ", but the rotations do not agree there";
  return fmt::format("{}, but by {:.2f} at {:+.2f} s", best, match.next_correlation, -to_seconds(match.next_shift));
}

}  // namespace

std::string offset_text(const ChosenImuClock& chosen) {
  return fmt::format("{:+.4f} s", to_seconds(chosen.clock.offset));
}

std::string offset_evidence(const ImuOffset& found) {
  const std::string drift =
      found.rate_sigma ? fmt::format("drift {:+.1f} +- {:.1f} ppm", kPpm * (found.rate - 1.0), kPpm * *found.rate_sigma)
                       : std::string("too short to determine a drift");
  return fmt::format("+- {:.1f} ms, {}; turn rates correlate by {:.2f}, at other offsets by at most {:.2f}",
                     1e3 * found.sigma_s, drift, found.match->correlation, found.match->next_correlation);
}

nlohmann::ordered_json to_json(const ChosenImuClock& chosen) {
  const ImuOffset& found = *chosen.found;
  return {{"offset_s", to_seconds(chosen.clock.offset)},
          {"rate", chosen.clock.rate},
          {"offset_sigma_s", found.sigma_s},
          {"rate_sigma", number_or_null(found.rate_sigma)},
          {"correlation", found.match->correlation},
          {"next_correlation", found.match->next_correlation}};
}

InputError undetermined_offset(const std::string& recording, const std::string& camera, const ImuOffset& found) {
  return InputError::format(
      "{}: --imu-time-offset auto: the turn rates of camera {} and gyro do not determine it: {}; turn the camera by "
      "hand about several axes for 10 s when recording, check its calibration and the gyro's unit, or give the seconds",
      recording, camera, why_undetermined(found));
}

ChosenImuClock determine_imu_clock(const std::function<Recording()>& reopen, double rate) {
  std::optional<ImuOffset> found;
  std::string name, camera;
  for (const Modality modality : {Modality::Frames, Modality::Events}) {
    const Recording recording = reopen();
    name = recording.dataset->info().name;
    if (!recording.calibration)
      throw InputError::format("{}: --imu-time-offset auto needs the lens of a camera: give --calib or --rig", name);
    for (const RigCamera& calibrated : calibrated_cameras(recording)) {
      if (calibrated.modality != modality) continue;
      camera = calibrated.name;
      found = search(recording, calibrated, rate);
      break;
    }
    if (interrupt_signal() != 0) return {};
    if (found && found->determined()) return {{found->offset, rate * found->rate}, found};
  }
  if (!found)
    throw InputError::format(
        "{}: --imu-time-offset auto: no camera of the calibration and IMU are in the recording; `edged info` lists "
        "both",
        name);
  throw undetermined_offset(name, camera, *found);
}

std::optional<double> given_imu_offset_s(const std::string& text) {
  if (text == "auto") return std::nullopt;
  const auto seconds = parse_number(text);
  if (!seconds || !std::isfinite(*seconds) || std::abs(*seconds) > 4e9)
    throw InputError::format("--imu-time-offset {}: give auto, or seconds such as -12.5", text);
  return seconds;
}

}  // namespace edged
