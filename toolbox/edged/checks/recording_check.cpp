// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/recording_check.hpp"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "edged/camera/field_of_view.hpp"
#include "edged/checks/agreement/lens_agreement.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

constexpr int kCorners = 40;
constexpr double kNewest = 0.05;                             // weight of a sample in the running mean of the gyro rate
constexpr Duration kEnough = std::chrono::seconds(3);        // duration of rotation after which more data adds little
constexpr Duration kBurst = std::chrono::milliseconds(500);  // tracking runs for this time, then pauses for it
constexpr Duration kCounted = std::chrono::milliseconds(10);
constexpr double kMostDetailed = 5e6;  // events a second of a burst whose pixels are counted
constexpr int kOneOf = 4;              // share 1 / kOneOf of the bursts of events and frames is counted in detail
constexpr Duration kPatience = std::chrono::seconds(6);  // with frames; then the events of the same lens are used, too
constexpr Duration kFirstUnits = std::chrono::seconds(5);  // before it, units are checked by a camera only

/// Of rotation, before which a contradiction of the gyro does not count. With less, corners on images of events may
/// give a rotation or a time offset far from a right calibration: 13 of 60 simulated flights with 1.8 s of motion did,
/// 7 of 60 with 2.8. What is inflated needs less.
Duration least_turning(const RigCamera& camera, bool is_inflated) {
  return std::chrono::seconds(camera.modality == Modality::Frames ? 1 : is_inflated ? 2 : 3);
}

/// Inflates the result for the limits of `edged doctor`, which assume more corners over a longer time. The scatter
/// between parts of the recording does not contain common errors of few corners. (Mirror recordings, pieces of 8 s,
/// calibrated right: events up to 14 deg off at a sigma of 1 deg and up to 100 ms, so that their time offset is left to
/// the estimator; frames up to 12 deg at 0.8 deg in the dark.)
GyroAgreement inflated(GyroAgreement agreement, const RigCamera& given) {
  constexpr double kLess = 2.0;
  const bool events = given.modality == Modality::Events;
  const double common = (events ? 5.0 : 3.0) * kDegree;
  agreement.rotation_covariance *= kLess * kLess;
  agreement.rotation_covariance += common * common * Eigen::Matrix3d::Identity();
  agreement.time_sigma_s *= kLess;
  agreement.scale_sigma *= kLess;
  if (events) {
    agreement.time_offset = given.time_offset;
    agreement.at_bound = false;
  }
  return agreement;
}

/// True if the comparison is finished.
bool confirms(const CameraCheck& check) {
  constexpr double kMostOff = 5.0 * kDegree, kSureOf = 2.0 * kDegree;  // [rad]
  return check.sure() && !check.agreement->mirrored && check.agreement->rotation_sigma < kSureOf &&
         check.agreement->accel.turns >= kFewestAccelTurns &&
         Eigen::AngleAxisd(check.camera.T_B_C.R().transpose() * check.agreement->R_B_C).angle() < kMostOff;
}

/// The text before its colon, which contains no numbers of the result.
std::string subject_of(const Finding& finding) { return finding.text.substr(0, finding.text.find(':')); }

/// A run is checked by the first camera of each kind.
DatasetInfo without_further_cameras(DatasetInfo info) {
  info.more_cameras.clear();
  return info;
}

std::vector<RigCamera> first_of_each_kind(const std::vector<RigCamera>& cameras) {
  std::vector<RigCamera> first;
  for (const Modality modality : {Modality::Frames, Modality::Events})
    if (const auto camera = std::ranges::find(cameras, modality, &RigCamera::modality); camera != cameras.end())
      first.push_back(*camera);
  return first;
}

void check_stream(const RigCamera& camera, const RecordingStatistics& statistics, Findings& out) {
  const bool events = camera.modality == Modality::Events;
  const std::string kind = events ? "events" : "frames";
  if ((events ? statistics.events : statistics.frames).count == 0)
    out.error(fmt::format("no {}: the mode needs them, and the recording has none", kind),
              fmt::format("record them, name their topic with --topic {}=NAME, or choose another --mode", kind));
}

}  // namespace

RecordingCheck::RecordingCheck(const DatasetInfo& info, std::optional<CheckedCalibration> given, Effort effort)
    : effort_(effort),
      given_(std::move(given)),
      collector_(during_run() ? without_further_cameras(info) : info),
      stereo_(given_ ? given_->cameras : std::vector<RigCamera>()),
      event_edges_(given_ ? given_->cameras : std::vector<RigCamera>()) {
  if (!given_) return;
  for (const RigCamera& camera : during_run() ? first_of_each_kind(given_->cameras) : given_->cameras) {
    CameraCheck check{camera, given_->has_extrinsics, std::nullopt, std::nullopt, least_turning(camera, during_run())};
    cameras_.push_back({std::move(check), during_run() ? VisualTurns(camera, kCorners) : VisualTurns(camera)});
    cameras_.back().next_look = cameras_.back().check.least_turning;
    cameras_.back().deferred = during_run() && cameras_.size() > 1 && is_same_lens(cameras_.front().given(), camera);
  }
}

void RecordingCheck::add(const Measurement& measurement) {
  stereo_.add(measurement);
  event_edges_.add(measurement);
  const std::string* name = camera_of(measurement);
  const auto is_own = [name](const Camera& camera) { return camera.given().name == *name; };
  if (during_run() && name && std::ranges::none_of(cameras_, is_own)) return;
  using Detail = RecordingCollector::Detail;
  const bool in_detail = !during_run() || (visual_.length / kBurst) % kOneOf == 0;
  collector_.add(measurement, in_detail ? Detail::All : Detail::Stamps, during_run() ? thinning_.next(measurement) : 1);
  const auto first = first_stamp(measurement), last = last_stamp(measurement);
  if (!first) return;
  if (std::holds_alternative<ImuSample>(measurement)) {
    imu_.extend(*first, *last);
    add_imu(collector_.imu_passed());
  } else if (name) {
    visual_.extend(*first, *last);
    for (Camera& camera : cameras_)
      if (is_own(camera)) follow(camera, measurement);
    if (visual_.length > kPatience && !cameras_.empty() && !cameras_.front().check.sure())
      cameras_.back().deferred = false;
  } else if (!during_run()) {
    external_.add(std::get<ExternalSample>(measurement));
  }
  if (!looked_ && std::min(imu_.length, visual_.length) >= kFirstUnits) look_ = true;
}

void RecordingCheck::add_imu(std::span<const ImuSample> passed) {
  for (const ImuSample& sample : passed) accel_axes_.add(sample);
  const bool all_told =
      during_run() && std::ranges::all_of(cameras_, [](const Camera& camera) {
        return camera.deferred || (camera.done && camera.check.sure());  // an IMU on another clock may lag
      });
  if (all_told) return;
  for (const ImuSample& sample : passed) {
    gyro_.add(sample);
    rate_ += kNewest * (sample.gyro_B.norm() - rate_);
  }
}

/// By the rate of the last kCounted.
std::size_t RecordingCheck::EventThinning::next(const Measurement& measurement) {
  const auto* batch = std::get_if<EventBatch>(&measurement);
  if (batch == nullptr || batch->events.empty()) return 1;
  const Timestamp begin = batch->events.front().t;
  // Before the first batch, and where the stamps go back, nothing has passed.
  const bool goes_on = counted_from != Timestamp::min() && begin >= counted_from;
  const Duration passed = goes_on ? begin - counted_from : Duration(0);
  if (!goes_on || passed >= kCounted) {
    const double most = kMostDetailed * to_seconds(passed);
    every = goes_on ? 1 + static_cast<std::size_t>(static_cast<double>(counted) / most) : 1;
    counted_from = begin;
    counted = 0;
  }
  counted += batch->events.size();
  return every;
}

void RecordingCheck::follow(Camera& camera, const Measurement& measurement) {
  if (!during_run()) return camera.visual.add(measurement);
  if (camera.done || camera.deferred) return;
  const bool pauses = camera.turning >= camera.check.least_turning && (visual_.length / kBurst) % 2 == 1;
  if (pauses || !(rate_ > kLeastTurningRate)) return;
  camera.visual.add(measurement);
  const std::vector<Turn>& turns = camera.visual.turns();
  camera.turning += turning_time(turns, camera.counted);
  camera.counted = turns.size();
  if (camera.turning < camera.next_look) return;
  camera.next_look = camera.turning * 3 / 2;
  compare(camera);
  look_ |= camera.done;
}

/// Checks undetermined cameras again.
void RecordingCheck::compare(Camera& camera) {
  const std::vector<Turn>& turns = camera.visual.turns();
  CameraCheck& check = camera.check;
  check.agreement = compare_with_gyro(turns, gyro_, check.camera.time_offset);
  check.lens.reset();
  check.gross_deg = 0.0;
  check.readout.reset();
  if (check.agreement) {
    check.lens = better_lens(check.camera, turns, gyro_, check.agreement->unexplained);
    if (check.sure() && !check.lens && check.camera.modality == Modality::Frames)
      check.readout = readout_of(turns, gyro_, check.camera.model, *check.agreement);
    if (!check.sure() && !check.lens) check.gross_deg = grossly_off_deg(turns, gyro_, check.camera, *check.agreement);
  }
  camera.done = camera.turning >= kEnough || confirms(check);
}

std::vector<Finding> RecordingCheck::check(const RecordingStatistics& statistics, bool dropped_frames) const {
  CheckInput input{statistics,          given_.has_value(),   {},
                   dropped_frames,      accel_axes_.better(), given_ ? given_->noise : std::nullopt,
                   stereo_.exchanged(), event_edges_.better()};
  for (const Camera& camera : cameras_) {
    const RigCamera& given = camera.given();
    CameraCheck& check = input.cameras.emplace_back(
        camera.done ? camera.check : CameraCheck{given, given_->has_extrinsics, std::nullopt});
    check.clock = other_clock_rate(camera.visual.turns(), gyro_, given.time_offset, statistics.imu_span_ratio());
    if (during_run() && check.agreement) check.agreement = inflated(*check.agreement, given);
  }
  Findings out{check_recording(input)};
  if (!during_run()) {
    external_.judge(gyro_, statistics.external, out.list);
    return out.list;
  }
  for (const Camera& camera : cameras_) check_stream(camera.given(), statistics, out);
  std::erase_if(out.list, [](const Finding& f) { return f.severity < Severity::Warning; });
  return out.list;
}

std::vector<Finding> RecordingCheck::news() {
  if (!std::exchange(look_, false)) return {};
  looked_ = true;
  std::vector<Finding> fresh = check(collector_.so_far(), false);
  std::erase_if(fresh, [this](const Finding& finding) {
    const bool known = std::ranges::find(reported_, subject_of(finding)) != reported_.end();
    return known || finding.severity != Severity::Error;
  });
  for (const Finding& finding : fresh) reported_.push_back(subject_of(finding));
  return fresh;
}

bool RecordingCheck::agrees_with(const RigCamera& estimated) const {
  constexpr double kLeast = 1.5 * kDegree, kSureOf = 2.0 * kDegree, kSigmas = 3.0;
  const auto own =
      std::ranges::find(cameras_, estimated.name, [](const Camera& camera) { return camera.given().name; });
  if (own == cameras_.end()) return false;
  return std::ranges::any_of(cameras_, [&](const Camera& camera) {
    if (!is_same_lens(camera.given(), own->given()) || !camera.check.sure() || camera.check.agreement->mirrored)
      return false;
    const double sigma = camera.check.agreement->rotation_sigma;
    const double off = Eigen::AngleAxisd(estimated.T_B_C.R().transpose() * camera.check.agreement->R_B_C).angle();
    return sigma < kSureOf && off < std::max(kLeast, kSigmas * sigma);
  });
}

std::vector<Finding> RecordingCheck::findings(const Dataset& dataset, const std::optional<GroundTruth>& truth,
                                              bool dropped_frames) {
  for (Camera& camera : cameras_) {
    const bool has_enough = !during_run() || camera.turning >= camera.check.least_turning;
    if (!camera.done && !camera.deferred && has_enough) compare(camera);
    camera.done = true;
  }
  return check(collector_.result(dataset, truth), dropped_frames);
}

}  // namespace edged
