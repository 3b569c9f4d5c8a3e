// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/found_imu_clock.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr double kPpm = 1e6;

/// The IMU samples at their place on the clock that is searched, all else as it is. Nothing after an interrupt.
std::optional<ImuOffset> search(const Recording& recording, const RigCamera& camera, const ReadThrough& read,
                                double rate) {
  ImuOffsetSearch search(camera, recording.calibration->has_extrinsics);
  if (camera.modality == Modality::Events) recording.dataset->leave_out(Modality::Frames);
  if (camera.modality == Modality::Frames) recording.dataset->leave_out(Modality::Events);
  std::optional<ClockLine> line;
  const bool whole = read(*recording.dataset, [&](const Measurement& measurement) {
    const auto* sample = std::get_if<ImuSample>(&measurement);
    if (!sample) return search.add(measurement);
    if (!line) line = ImuClock{Duration(0), rate}.from(sample->t);
    ImuSample corrected = *sample;
    corrected.t = line->at(sample->t);
    search.add(corrected);
  });
  return whole ? std::optional(search.result()) : std::nullopt;
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

InputError undetermined_offset(const std::string& recording, const std::string& camera, const ImuOffset& found) {
  return InputError::format(
      "{}: --imu-time-offset auto: the turn rates of camera {} and gyro do not determine it: {}; turn the camera by "
      "hand about several axes for 10 s when recording, check its calibration and the gyro's unit, or give the seconds",
      recording, camera, why_undetermined(found));
}

std::vector<RigCamera> calibrated_cameras(const Recording& recording) {
  std::vector<RigCamera> cameras;
  const DatasetInfo& info = recording.dataset->info();
  if (!info.has_imu) return cameras;
  const Rig& rig = recording.calibration->rig;
  for (const RecordedCamera& recorded : recorded_cameras(info)) {
    const auto named = std::ranges::find(rig.cameras, recorded.name, &RigCamera::name);
    const bool known = named != rig.cameras.end() && named->modality == recorded.modality;
    const bool first = recorded.name == info.event_camera || recorded.name == info.frame_camera;
    const RigCamera* camera = known ? &*named : first ? rig.find(recorded.modality) : nullptr;
    if (!camera) continue;
    cameras.push_back(*camera);
    cameras.back().name = recorded.name;
  }
  return cameras;
}

ChosenImuClock determine_imu_clock(const std::function<Recording()>& reopen, const ReadThrough& read, double rate) {
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
      found = search(recording, calibrated, read, rate);
      if (!found) return {};
      break;
    }
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

LiveImuClock::LiveImuClock(std::optional<double> offset_s, double rate, std::span<const RigCamera> cameras,
                           bool has_extrinsics)
    : rate_(rate),
      has_extrinsics_(has_extrinsics),
      given_(offset_s ? std::optional(duration_from_seconds(*offset_s)) : std::nullopt) {
  for (const Modality modality : {Modality::Frames, Modality::Events}) {
    const auto first = std::ranges::find(cameras, modality, &RigCamera::modality);
    if (first != cameras.end()) cameras_.push_back(*first);
  }
  if (!given_ && cameras_.empty())
    throw InputError("--imu-time-offset auto needs an IMU, and the lens of a camera: give --calib or --rig");
  begin();
}

void LiveImuClock::begin() {
  line_.reset();
  drift_.reset();
  first_.reset();
  searched_from_.reset();
  tries_ = 0;
  searches_.clear();
  for (const RigCamera& camera : cameras_) searches_.emplace_back(camera, has_extrinsics_);
}

/// Two samples far before two others. A single one is damaged.
bool LiveImuClock::begins_again(Timestamp stamp) {
  constexpr Duration kSetBack = std::chrono::seconds(1);
  if (!last_) last_.emplace().fill(stamp);
  std::rotate(last_->begin(), last_->begin() + 1, last_->end());  // clang 14 cannot parse that of std::ranges
  last_->back() = stamp;
  const auto& [before, then, now, newest] = *last_;
  return std::min(before, then) - std::max(now, newest) > kSetBack;
}

std::optional<Measurement> LiveImuClock::pass(Measurement measurement) {
  if (auto* sample = std::get_if<ImuSample>(&measurement)) {
    if (begins_again(sample->t) && !given_) {
      spdlog::warn("the IMU's clock has begun again: its offset is searched again");
      begin();
    }
    if (!first_) {
      first_ = sample->t;
      if (given_) line_ = line_by(*given_);
    }
    sample->t = line_.value_or(line_by(Duration(0))).at(sample->t);
  }
  if (!known()) search(measurement);
  if (drift_) drift_->add(measurement, *line_);
  return known() ? std::optional(std::move(measurement)) : std::nullopt;
}

void LiveImuClock::search(const Measurement& measurement) {
  constexpr Duration kTry = std::chrono::seconds(10);
  constexpr int kTries = 2;  // with the same measurements: more of them determine a drift, too
  for (ImuOffsetSearch& search : searches_) search.add(measurement);
  const auto t = first_stamp(measurement);
  if (camera_of(measurement) == nullptr || !t) return;
  if (!searched_from_ || *t < *searched_from_) searched_from_ = *t;
  if (*t - *searched_from_ < kTry * (tries_ + 1)) return;
  ++tries_;
  std::string why;
  for (std::size_t i = 0; i < searches_.size() && !line_; ++i) {
    const ImuOffset found = searches_[i].result();
    if (found.determined()) {
      line_ = line_by(found.offset);
      drift_.emplace(cameras_[i], found.sigma_s);
      spdlog::info(fmt::format("IMU clock: {} added to its stamps, {}", offset_text({{found.offset, rate_}, found}),
                               offset_evidence(found)));
    } else {
      why += fmt::format("; camera {}: {}", cameras_[i].name, why_undetermined(found));
    }
  }
  if (line_) return searches_.clear();
  spdlog::warn(
      fmt::format("the turn rates of camera and gyro do not determine the IMU's clock yet: turn the camera by "
                  "hand about several axes for 10 s{}",
                  why));
  if (tries_ == kTries) begin();
}

namespace {

class WithLiveImuClock final : public WrappedDataset {
 public:
  WithLiveImuClock(std::unique_ptr<Dataset> source, LiveImuClock clock)
      : WrappedDataset(std::move(source)), clock_(std::move(clock)) {}

  std::optional<Measurement> next() override {
    while (auto measurement = recording_->next())
      if (auto passed = clock_.pass(std::move(*measurement))) return passed;
    return std::nullopt;
  }

 private:
  LiveImuClock clock_;
};

}  // namespace

Recording with_live_imu_clock(Recording source, std::optional<double> offset_s, double rate) {
  const std::vector<RigCamera> cameras = source.calibration ? calibrated_cameras(source) : std::vector<RigCamera>();
  LiveImuClock clock(offset_s, rate, cameras, source.calibration && source.calibration->has_extrinsics);
  source.dataset = std::make_unique<WithLiveImuClock>(std::move(source.dataset), std::move(clock));
  return source;
}

}  // namespace edged
