// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "inspect/survey.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "common/json_text.hpp"
#include "common/reading.hpp"
#include "common/source.hpp"
#include "common/text.hpp"
#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

std::string survey_line(std::string_view name, const std::string& value) {
  return fmt::format("{:<15} {}\n", name, value);
}

std::string size_text(cv::Size size) {
  return size.empty() ? "size unknown" : fmt::format("{} x {} px", size.width, size.height);
}

std::string gap_text(const StreamStatistics& stream) {
  if (stream.gaps == 0) return "no gaps";
  std::string text = fmt::format("{} gaps of {:.3f} s together, longest:", stream.gaps, to_seconds(stream.missing));
  for (const Gap& gap : stream.longest)
    text += fmt::format(" {:.3f} s at {:.3f}", to_seconds(gap.length), to_seconds(gap.after));
  return text;
}

std::string stream_text(const StreamStatistics& stream, std::string_view unit = "Hz") {
  return fmt::format("{} in {:.3f} s ({:.3f} to {:.3f} s), {}{}", stream.count, to_seconds(stream.length()),
                     to_seconds(*stream.begin), to_seconds(*stream.end), si_number(stream.rate_hz()), unit);
}

/// "below 1 k", "1 k to 10 k", ..., "above 10 M", each with a bar.
std::string histogram(const EventStatistics& events) {
  constexpr double kBarColumns = 40;
  const auto& bands = EventStatistics::kRateBands;
  std::string text;
  for (std::size_t i = 0; i <= bands.size(); ++i) {
    const std::string name = i == 0 ? fmt::format("below {}", si_number(bands.front()))
                             : i == bands.size()
                                 ? fmt::format("above {}", si_number(bands.back()))
                                 : fmt::format("{} to {}", si_number(bands[i - 1]), si_number(bands[i]));
    const auto columns = static_cast<std::size_t>(kBarColumns * events.rate_shares[i] + 0.5);
    text += survey_line(
        "", fmt::format("{:>22} ev/s {:5.1f} % {}", name, 100 * events.rate_shares[i], std::string(columns, '#')));
  }
  return text;
}

std::string events_text(const RecordingStatistics& s, const std::string& name) {
  const EventStatistics& e = s.event_details;
  std::string text = survey_line(name, stream_text(s.events, "ev/s"));
  text += survey_line("", fmt::format("{}; pixels up to ({}, {}); {:.0f} % positive; {:.0f} % of the pixels fired",
                                      size_text(s.info.event_sensor), e.extent.width - 1, e.extent.height - 1,
                                      100 * e.positive_share, 100 * e.active_share));
  text += survey_line(
      "", s.events.gaps == 0 ? "never 0.1 s without events" : "periods of 0.1 s without events: " + gap_text(s.events));
  text += survey_line(
      "", fmt::format("highest rate {}ev/s over 10 ms; share of the time by rate:", si_number(e.peak_rate_hz)));
  text += histogram(e);
  if (e.flicker)
    text +=
        survey_line("", fmt::format("flicker at {:.1f} Hz for {:.0f} % of the time: about {:.0f} % of the events then, "
                                    "in {:.0f} % of the image",
                                    e.flicker->hz, 100 * e.flicker->time_share, 100 * e.flicker->event_share,
                                    100 * e.flicker->image_share));
  if (!e.hot_known) return text + survey_line("", "too short to detect hot pixels");
  std::string hot = fmt::format("{} hot pixels, {:.1f} % of the events", e.hot_pixels, 100 * e.hot_share);
  for (std::size_t i = 0; i < std::min<std::size_t>(e.hottest.size(), 5); ++i)
    hot +=
        fmt::format("{} ({}, {}) {:.0f} Hz", i == 0 ? ":" : ",", e.hottest[i].x, e.hottest[i].y, e.hottest[i].rate_hz);
  return text + survey_line("", hot);
}

std::string frames_text(const RecordingStatistics& s, const std::string& name) {
  return survey_line(name, stream_text(s.frames)) + survey_line("", gap_text(s.frames)) +
         survey_line("", fmt::format("{}, mean brightness {:.0f} of 255", size_text(s.image_size), s.mean_brightness));
}

/// One line for each camera, if there are several of a kind.
std::string cameras_text(const DatasetInfo& info) {
  std::string text;
  if (info.more_cameras.empty()) return text;
  for (const RecordedCamera& camera : recorded_cameras(info))
    text += survey_line("  camera",
                        fmt::format("{} ({}){}", camera.name, camera.modality == Modality::Events ? "events" : "frames",
                                    camera.stream.empty() ? "" : ": " + camera.stream));
  return text;
}

std::string imu_text(const RecordingStatistics& s) {
  const ImuStatistics& imu = s.imu_details;
  std::string text = survey_line("IMU", stream_text(s.imu)) + survey_line("", gap_text(s.imu));
  text +=
      survey_line("", fmt::format("mean specific force {:.2f} m/s^2, angular speed mean {:.2f}, highest {:.2f} rad/s",
                                  imu.mean_accel, imu.mean_gyro, imu.max_gyro));
  if (!imu.rest) return text + survey_line("", "never at rest for half a second: no estimate of its noise");
  const ImuRest& rest = *imu.rest;
  text += survey_line(
      "", fmt::format(
              "noise at rest ({:.1f} s at {:.1f} s): gyro {:.2g} rad/s/sqrt(Hz), accelerometer {:.2g} m/s^2/sqrt(Hz)",
              to_seconds(rest.length), to_seconds(rest.begin), rest.gyro_noise, rest.accel_noise));
  return text +
         survey_line(
             "",
             fmt::format("at rest: gyro ({:.4f}, {:.4f}, {:.4f}) rad/s, accelerometer ({:.2f}, {:.2f}, {:.2f}) m/s^2",
                         rest.gyro.x(), rest.gyro.y(), rest.gyro.z(), rest.accel.x(), rest.accel.y(), rest.accel.z()));
}

nlohmann::ordered_json stream_json(const StreamStatistics& stream) {
  if (stream.count == 0) return {{"count", 0}};
  nlohmann::ordered_json json = {{"count", stream.count},        {"begin_ns", to_ns(*stream.begin)},
                                 {"end_ns", to_ns(*stream.end)}, {"rate_hz", stream.rate_hz()},
                                 {"gaps", stream.gaps},          {"missing_s", to_seconds(stream.missing)}};
  for (const Gap& gap : stream.longest)
    json["longest_gaps"].push_back({{"after_ns", to_ns(gap.after)}, {"length_s", to_seconds(gap.length)}});
  return json;
}

nlohmann::ordered_json events_json(const RecordingStatistics& s) {
  const EventStatistics& e = s.event_details;
  nlohmann::ordered_json json = stream_json(s.events);
  if (s.events.count > 0) {
    json.update({{"width", s.info.event_sensor.width},
                 {"height", s.info.event_sensor.height},
                 {"max_x", e.extent.width - 1},
                 {"max_y", e.extent.height - 1},
                 {"positive_share", e.positive_share},
                 {"active_share", e.active_share},
                 {"peak_rate_hz", e.peak_rate_hz},
                 {"rate_bands_hz", EventStatistics::kRateBands},
                 {"rate_shares", e.rate_shares},
                 {"hot_known", e.hot_known},
                 {"hot_pixels", e.hot_pixels},
                 {"hot_share", e.hot_share}});
    if (e.flicker)
      json["flicker"] = {{"hz", e.flicker->hz},
                         {"time_share", e.flicker->time_share},
                         {"event_share", e.flicker->event_share},
                         {"image_share", e.flicker->image_share}};
    for (const HotPixel& pixel : e.hottest)
      json["hottest"].push_back({{"x", pixel.x}, {"y", pixel.y}, {"events", pixel.events}, {"rate_hz", pixel.rate_hz}});
  }
  return json;
}

nlohmann::ordered_json frames_json(const RecordingStatistics& s) {
  nlohmann::ordered_json json = stream_json(s.frames);
  if (s.frames.count > 0)
    json.update(
        {{"width", s.image_size.width}, {"height", s.image_size.height}, {"mean_brightness", s.mean_brightness}});
  return json;
}

/// All cameras by name, if there are several of a kind.
nlohmann::ordered_json cameras_json(const RecordingStatistics& s) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  const auto add = [&json](const RecordingStatistics& of, const RecordedCamera& camera) {
    const bool events = camera.modality == Modality::Events;
    json[camera.name] = {{"kind", events ? "events" : "frames"}, {"stream", camera.stream}};
    json[camera.name].update(events ? events_json(of) : frames_json(of));
  };
  for (const RecordedCamera& camera : recorded_cameras(s.info)) {
    const auto further = std::ranges::find(s.more, camera.name, &RecordingStatistics::camera);
    add(further == s.more.end() ? s : *further, camera);
  }
  return json;
}

std::string external_survey_text(const std::string& name, const ExternalStatistics& s) {
  const ExternalSensor& sensor = *find_external_sensor(name);
  std::string text = survey_line(name, stream_text(s.stream)) + survey_line("", gap_text(s.stream));
  std::string range;
  for (std::size_t i = 0; i < sensor.columns.size(); ++i)
    range += fmt::format("{}{} {:.2f} to {:.2f}", i == 0 ? "" : ", ", sensor.columns[i], s.least[i], s.most[i]);
  text += survey_line("", fmt::format("{} {}; noise {:.2g} {}", range, sensor.unit, s.noise, sensor.unit) +
                              (s.sigma > 0.0 ? fmt::format(" (stated in its samples: {:.2g})", s.sigma) : ""));
  return text;
}

/// What was recorded of a camera, or of the first ones, under these names.
std::string camera_text(const RecordingStatistics& s, const std::string& events, const std::string& frames) {
  return (s.events.count > 0 ? events_text(s, events) : "") + (s.frames.count > 0 ? frames_text(s, frames) : "");
}

nlohmann::ordered_json numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

std::string to_text(const RecordingStatistics& s) {
  std::string text = survey_line("recording", fmt::format("{} ({})", s.info.name, s.info.format));
  for (const StreamInfo& stream : s.info.streams)
    text += survey_line("  stream", fmt::format("{} ({}){}{}", stream.name, stream.type,
                                                stream.count > 0 ? fmt::format(", {} recorded", stream.count) : "",
                                                stream.role.empty() ? "" : " -> " + stream.role));
  text += cameras_text(s.info);
  text += survey_line("all sensors", fmt::format("{:.3f} s together", std::max(0.0, to_seconds(s.overlap()))));
  const bool several = !s.more.empty();
  text += camera_text(s, several ? s.info.event_camera : "events", several ? s.info.frame_camera : "frames");
  for (const RecordingStatistics& camera : s.more) {
    const std::string recorded = camera_text(camera, camera.camera(), camera.camera());
    text += recorded.empty() ? survey_line(camera.camera(), "nothing recorded") : recorded;
  }
  if (s.imu.count > 0) text += imu_text(s);
  for (const auto& [name, survey] : s.external) text += external_survey_text(name, survey);
  if (s.truth && s.truth->stream.count > 0)
    text += survey_line("ground truth", fmt::format("{}, path {:.2f} m, of {}", stream_text(s.truth->stream),
                                                    s.truth->path_m, s.truth->frame));
  for (const auto& [kind, count] : s.repairs) text += survey_line("repaired", fmt::format("{} ({})", kind, count));
  return text;
}

nlohmann::ordered_json to_json(const RecordingStatistics& s) {
  nlohmann::ordered_json json = {
      {"name", s.info.name}, {"format", s.info.format}, {"overlap_s", to_seconds(s.overlap())}};
  json["streams"] = nlohmann::ordered_json::array();
  for (const StreamInfo& stream : s.info.streams)
    json["streams"].push_back(
        {{"name", stream.name}, {"type", stream.type}, {"count", stream.count}, {"role", stream.role}});
  json["events"] = events_json(s);
  json["frames"] = frames_json(s);
  if (!s.more.empty()) json["cameras"] = cameras_json(s);
  json["imu"] = stream_json(s.imu);
  if (const ImuStatistics& imu = s.imu_details; s.imu.count > 0) {
    json["imu"].update({{"mean_accel", imu.mean_accel}, {"mean_gyro", imu.mean_gyro}, {"max_gyro", imu.max_gyro}});
    json["imu"]["at_rest"] = imu.rest.has_value();
    if (imu.rest)
      json["imu"].update({{"rest_s", to_seconds(imu.rest->length)},
                          {"gyro_noise", imu.rest->gyro_noise},
                          {"accel_noise", imu.rest->accel_noise},
                          {"rest_gyro", numbers(imu.rest->gyro)},
                          {"rest_accel", numbers(imu.rest->accel)}});
  }
  for (const auto& [name, survey] : s.external) {
    json[name] = stream_json(survey.stream);
    json[name].update({{"least", survey.least},
                       {"most", survey.most},
                       {"noise", survey.noise},
                       {"sigma", survey.sigma},
                       {"longest_constant_s", to_seconds(survey.constant)}});
  }
  if (s.truth) {
    json["ground_truth"] = stream_json(s.truth->stream);
    json["ground_truth"].update({{"path_m", s.truth->path_m}, {"frame", s.truth->frame}});
  }
  json["repairs"] = s.repairs;
  return json;
}

WholeRead read_whole(Dataset& dataset, bool quiet, const std::function<void(const Measurement&)>& use) {
  WholeRead read;
  try {
    read_through(dataset, quiet, "read", [&](const Measurement& measurement) {
      use(measurement);
      return true;
    });
  } catch (const InputError& error) {
    read.damage = error.what();
  }
  OwnTruth truth = read_truth(dataset);
  if (!read.damage && !truth.problem.empty()) read.damage = truth.problem;
  read.truth = std::move(truth.truth);
  return read;
}

}  // namespace edged
