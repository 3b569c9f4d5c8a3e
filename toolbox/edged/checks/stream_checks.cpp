// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "edged/checks/check_groups.hpp"
#include "edged/core/angles.hpp"

namespace edged {
namespace {

constexpr double kShortest_s = 1.0;     // a run needs this much to initialize
constexpr double kMostHot = 0.02;       // share of the events
constexpr double kMostLeftOut_s = 0.5;  // per end of the recording, not covered by all sensors

constexpr const char* kTruthRemedy =
    "remove the wrong poses, as gaps are evaluated correctly; until then no estimate is compared with it";

constexpr double kMostRepeated = 0.25;  // share of the frames

std::string interval(const char* name, const StreamStatistics& stream) {
  return fmt::format("{} {:.3f} to {:.3f} s", name, to_seconds(*stream.begin), to_seconds(*stream.end));
}

/// The longer of the times of the cameras before and after those of the IMU, if both are there [s].
double beyond_imu_s(const RecordingStatistics& s) {
  const auto cameras = s.cameras();
  if (!cameras || s.imu.count == 0) return 0.0;
  return to_seconds(std::max(*s.imu.begin - cameras->first, cameras->second - *s.imu.end));
}

/// The time that all present sensors cover.
void check_overlap(const CheckInput& input, Findings& out) {
  const RecordingStatistics& s = input.recording;
  std::string all;
  Duration shortest = Duration::max();
  int streams = 0;
  for (const auto& [name, stream] :
       {std::pair("IMU", &s.imu), std::pair("events", &s.events), std::pair("frames", &s.frames)}) {
    if (stream->count == 0) continue;
    all += (all.empty() ? "" : ", ") + interval(name, *stream);
    shortest = std::min(shortest, stream->length());
    ++streams;
  }
  if (streams < 2) return;
  const double common = to_seconds(s.overlap()), least = to_seconds(shortest);
  if (common < 0.0)
    out.error("the clocks of the sensors do not overlap: " + all,
              "--imu-time-offset auto finds the IMU's by the rotation; otherwise stamp all sensors on one clock when "
              "recording");
  else if (common < std::max(0.9 * least, least - kMostLeftOut_s) || beyond_imu_s(s) > kMostLeftOut_s)
    out.warn(fmt::format("all sensors together cover {:.1f} s only: {}", common, all),
             "the time that only some of them cover is not used; check that all were recorded");
  else if (common < kShortest_s)
    out.warn(fmt::format("all sensors together cover {:.2f} s: {}", common, all),
             "too short for a run, which needs about a second to start: record more");
  else
    out.good(fmt::format("all sensors cover {:.1f} s together", common));
}

void check_presence(const CheckInput& input, Findings& out) {
  const RecordingStatistics& s = input.recording;
  if (s.imu.count == 0)
    out.error("no IMU samples",
              "every mode needs them: record the IMU, or name its topic with --topic imu=NAME; those that lie outside "
              "the time of the cameras are on another clock, which `edged info REC` shows");
  if (s.events.count == 0 && s.frames.count == 0)
    out.error("neither events nor frames", "record one of them, or name the topic with --topic events=NAME");
}

void check_silence(const CheckInput& input, Findings& out) {
  const RecordingStatistics& s = input.recording;
  if (s.events.gaps > 0)
    out.note(fmt::format("{} periods without events, {:.2f} s together, the longest {:.2f} s at {:.3f} s",
                         s.events.gaps, to_seconds(s.events.missing), to_seconds(s.events.longest.front().length),
                         to_seconds(s.events.longest.front().after)),
             "a still scene, or lost data: compare with the motion");
}

void check_hot_pixels(const CheckInput& input, Findings& out) {
  const EventStatistics& e = input.recording.event_details;
  if (e.hot_share > kMostHot)
    out.warn(fmt::format("{} hot pixels send {:.1f} % of all events, most at ({}, {})", e.hot_pixels, 100 * e.hot_share,
                         e.hottest.front().x, e.hottest.front().y),
             "mask them in the camera, or raise its thresholds");
}

void check_flicker(const CheckInput& input, Findings& out) {
  constexpr double kFew = 0.05;
  if (!input.recording.event_details.flicker) return;
  const FlickerStatistics& flicker = *input.recording.event_details.flicker;
  const std::string text = fmt::format(
      "a lamp flickers at {:.0f} Hz: about {:.0f} % of the events, in {:.0f} % of the image, {:.0f} % of the time",
      flicker.hz, 100 * flicker.event_share, 100 * flicker.image_share, 100 * flicker.time_share);
  if (flicker.event_share * flicker.time_share < kFew) return out.note(text);
  out.warn(text,
           "a run leaves most of them out, but exposures of frames shift by a part of a millisecond: expose for whole "
           "cycles or very briefly, and prefer daylight or lamps on direct current");
}

void check_polarity(const CheckInput& input, Findings& out) {
  const EventStatistics& e = input.recording.event_details;
  if (e.positive_share < 0.05 || e.positive_share > 0.95)
    out.warn(fmt::format("{:.1f} % of the events are positive", 100 * e.positive_share),
             "check that both polarities are recorded and distinguished");
}

void confirm_events(const CheckInput& input, Findings& out) {
  const EventStatistics& e = input.recording.event_details;
  if (e.hot_share <= kMostHot)
    out.good(fmt::format("events: {}, {:.0f} % positive",
                         e.hot_known ? fmt::format("{} hot pixels", e.hot_pixels) : "too short to detect hot pixels",
                         100 * e.positive_share));
}

void check_frames(const CheckInput& input, Findings& out) {
  const RecordingStatistics& s = input.recording;
  if (s.frames.gaps > 0)
    out.warn(fmt::format("{} gaps of the frames, {:.2f} s together, the longest {:.2f} s at {:.3f} s", s.frames.gaps,
                         to_seconds(s.frames.missing), to_seconds(s.frames.longest.front().length),
                         to_seconds(s.frames.longest.front().after)),
             input.dropped_frames ? "this run dropped frames, as it was too slow"
                                  : "features are lost over long gaps; look for an overloaded bus");
  if (s.repeated_share > kMostRepeated)
    out.warn(fmt::format("{:.0f} % of the frames repeat the image before them", 100 * s.repeated_share),
             "the driver sends an image several times: remove the repeated ones, whose stamps are wrong",
             Unusable::Calibration);
  if (s.mean_brightness < 15.0)
    out.note(fmt::format("frames are dark: mean brightness {:.0f} of 255", s.mean_brightness),
             "expose longer, or use --mode events or fused");
  else if (s.frames.gaps == 0)
    out.good(fmt::format("frames at {:.1f} Hz, mean brightness {:.0f} of 255", s.frames.rate_hz(), s.mean_brightness));
}

constexpr Check kEventChecks[] = {check_silence, check_hot_pixels, check_flicker, check_polarity, confirm_events};

void check_one_camera(const CheckInput& input, Findings& out) {
  if (input.recording.events.count > 0)
    for (const Check check : kEventChecks) check(input, out);
  if (input.recording.frames.count > 0) check_frames(input, out);
}

}  // namespace

void check_streams(const CheckInput& input, Findings& out) {
  check_presence(input, out);
  check_overlap(input, out);
}

/// The findings of each further camera have its name.
void check_pictures(const CheckInput& input, Findings& out) {
  check_one_camera(input, out);
  for (const RecordingStatistics& camera : input.recording.more) {
    Findings own;
    if (camera.events.count + camera.frames.count == 0)
      own.error("no measurements", "leave it out with --cameras, or record it");
    check_one_camera({camera}, own);
    for (Finding& finding : own.list) {
      finding.text = fmt::format("camera {}: {}", camera.camera(), finding.text);
      out.list.push_back(std::move(finding));
    }
  }
}

void check_truth(const CheckInput& input, Findings& out) {
  const RecordingStatistics& s = input.recording;
  if (!s.truth || s.truth->stream.count == 0 || s.imu.count == 0) return;
  const StreamStatistics& truth = s.truth->stream;
  if (*truth.begin > *s.imu.end || *truth.end < *s.imu.begin)
    out.warn("ground truth does not overlap: " + interval("truth", truth) + ", " + interval("IMU", s.imu),
             "it is on another clock: shift its stamps before evaluating");
  else if (s.truth->frozen > Duration(0))
    out.warn(fmt::format("ground truth: the same pose for {:.3f} s from {:.3f} s on, in motion",
                         to_seconds(s.truth->frozen), to_seconds(s.truth->frozen_since)),
             kTruthRemedy, Unusable::Truth);
  else if (s.truth->jumps > 0)
    out.warn(fmt::format("ground truth: {} jumps, the first at {:.3f} s by {:.2f} m and {:.0f} deg", s.truth->jumps,
                         to_seconds(s.truth->first_jump.t), s.truth->first_jump.length_m,
                         s.truth->first_jump.angle_rad * kDegreesPerRadian),
             kTruthRemedy, Unusable::Truth);
  else
    out.good(fmt::format("ground truth: {} poses, path {:.1f} m", truth.count, s.truth->path_m));
}

}  // namespace edged
