// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/run_check.hpp"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "edged/camera/field_of_view.hpp"
#include "edged/checks/agreement/lens_agreement.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr int kCorners = 40;
constexpr double kNewest = 0.05;                             // weight of a sample in the running mean of the gyro rate
constexpr double kUnexplained = 0.5;                         // above it the comparison is unreliable
constexpr Duration kEnough = std::chrono::seconds(3);        // duration of rotation after which more data adds little
constexpr Duration kBurst = std::chrono::milliseconds(500);  // tracking runs for this time, then pauses for it
constexpr Duration kCounted = std::chrono::milliseconds(10);
constexpr double kMostDetailed = 5e6;  // events a second of a burst whose pixels are counted
constexpr int kOneOf = 4;              // share 1 / kOneOf of the bursts of events and frames is counted in detail
constexpr Duration kPatience = std::chrono::seconds(6);  // with frames; then the events of the same lens are used, too
constexpr Duration kFirstUnits = std::chrono::seconds(5);  // before it, units are checked by a camera only

bool agrees(const std::optional<GyroAgreement>& found) { return found && found->unexplained < kUnexplained; }

/// Median over the rotations of the part that the gyro does not explain with R_B_C [rad/s].
double median_error(const std::vector<Turn>& turns, const GyroIntegral& gyro, const GyroAgreement& found,
                    const Eigen::Matrix3d& R_B_C) {
  std::vector<double> errors;
  for (const Turn& turn : turns) {
    const auto phi = gyro.between(turn.begin + found.time_offset, turn.end + found.time_offset);
    if (!phi) continue;
    errors.push_back((*phi / found.gyro_scale - R_B_C * turn.phi_C).norm() / to_seconds(turn.end - turn.begin));
  }
  return median(std::move(errors));
}

/// Rotations that are too noisy to determine R_B_C still detect a grossly wrong one: the best rotation explains clearly
/// more. (Mirror recordings, two people in view included: correct calibrations reach 22 deg and 1.22 times the error,
/// but not both; those wrong by 90 deg have at least 80 deg and 1.20 times.)
double grossly_off_deg(const std::vector<Turn>& turns, const GyroIntegral& gyro, const RigCamera& given,
                       const GyroAgreement& found) {
  constexpr double kGross_deg = 45.0, kClearlyWorse = 1.15;
  const Eigen::Matrix3d R = given.T_B_C.R();
  const double off_deg = Eigen::AngleAxisd(R.transpose() * found.R_B_C).angle() * 180.0 / std::numbers::pi;
  if (off_deg < kGross_deg) return 0.0;
  const double best = median_error(turns, gyro, found, found.R_B_C);
  return median_error(turns, gyro, found, R) > kClearlyWorse * best ? off_deg : 0.0;
}

/// The duration of rotation before the first comparison. With less, corners on images of events may give wrong
/// rotations that resemble those of a mirrored gyro.
Duration first_look(const RigCamera& camera) {
  return std::chrono::seconds(camera.modality == Modality::Events ? 2 : 1);
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
bool confirms(const GyroAgreement& found, const RigCamera& given) {
  constexpr double kMostOff = 5.0 * kDegree, kSureOf = 2.0 * kDegree;  // [rad]
  return !found.mirrored && found.unexplained < kUnexplained && found.rotation_sigma < kSureOf &&
         found.accel.turns >= kFewestAccelTurns &&
         Eigen::AngleAxisd(given.T_B_C.R().transpose() * found.R_B_C).angle() < kMostOff;
}

/// The text before its colon, which contains no numbers of the result.
std::string subject_of(const Finding& finding) { return finding.text.substr(0, finding.text.find(':')); }

void check_lever_arm(const RigCamera& camera, Findings& out) {
  constexpr double kLongest_m = 2.0;
  const double arm_m = camera.T_B_C.translation().norm();
  if (arm_m > kLongest_m)
    out.error(fmt::format("camera {}: calibrated {:.4g} m away from the IMU, as if its translation were in millimetres",
                          camera.name, arm_m),
              "translations are in metres: divide that of T_B_C by 1000");
}

/// A run is checked by the first camera of each kind.
DatasetInfo without_further_cameras(DatasetInfo info) {
  info.more_cameras.clear();
  return info;
}

}  // namespace

RunCheck::RunCheck(const DatasetInfo& info, const Rig& used, bool has_extrinsics, std::optional<ImuNoise> noise)
    : has_extrinsics_(has_extrinsics), noise_(noise), collector_(without_further_cameras(info)), stereo_(used.cameras) {
  for (const Modality modality : {Modality::Frames, Modality::Events}) {
    if (used.find(modality) == nullptr) continue;
    const RigCamera& camera = *used.find(modality);
    cameras_.push_back({camera, VisualTurns(camera, kCorners)});
    cameras_.back().next_look = first_look(camera);
    cameras_.back().same_lens = cameras_.size() > 1 && is_same_lens(cameras_.front().given, camera);
    cameras_.back().deferred = cameras_.back().same_lens;
  }
}

void RunCheck::add(const Measurement& measurement) {
  stereo_.add(measurement);
  const std::string* name = camera_of(measurement);
  if (name && std::ranges::none_of(cameras_, [&](const Camera& camera) { return camera.given.name == *name; })) return;
  using Detail = RecordingCollector::Detail;
  collector_.add(measurement, (visual_.length / kBurst) % kOneOf == 0 ? Detail::All : Detail::Stamps,
                 thinning_.next(measurement));
  const auto first = first_stamp(measurement), last = last_stamp(measurement);
  if (!first) return;
  if (std::holds_alternative<ImuSample>(measurement)) {
    imu_.extend(*first, *last);
    for (const ImuSample& sample : collector_.imu_passed()) accel_axes_.add(sample);
    const bool all_told = std::ranges::all_of(cameras_, [](const Camera& camera) {
      return camera.deferred || (camera.done && agrees(camera.agreement));  // an IMU on another clock may lag
    });
    if (all_told) return;
    for (const ImuSample& sample : collector_.imu_passed()) {
      gyro_.add(sample);
      rate_ += kNewest * (sample.gyro_B.norm() - rate_);
    }
  } else if (name) {
    visual_.extend(*first, *last);
    for (Camera& camera : cameras_) follow(camera, measurement);
    if (visual_.length > kPatience && !agrees(cameras_.front().agreement)) cameras_.back().deferred = false;
  }
  if (!looked_ && std::min(imu_.length, visual_.length) >= kFirstUnits) look_ = true;
}

/// By the rate of the last kCounted.
std::size_t RunCheck::EventThinning::next(const Measurement& measurement) {
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

void RunCheck::follow(Camera& camera, const Measurement& measurement) {
  if (camera.done || camera.deferred) return;
  const bool pauses = camera.turning >= first_look(camera.given) && (visual_.length / kBurst) % 2 == 1;
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
void RunCheck::compare(Camera& camera) {
  const std::vector<Turn>& turns = camera.visual.turns();
  camera.agreement = compare_with_gyro(turns, gyro_, camera.given.time_offset);
  const bool known = agrees(camera.agreement);
  if (camera.agreement) camera.lens = better_lens(camera.given, turns, gyro_, camera.agreement->unexplained);
  camera.contradiction_deg =
      camera.agreement && !known && !camera.lens ? grossly_off_deg(turns, gyro_, camera.given, *camera.agreement) : 0.0;
  camera.done = camera.turning >= kEnough || (camera.agreement && confirms(*camera.agreement, camera.given));
}

void RunCheck::check_camera(const Camera& camera, const RecordingStatistics& statistics, Findings& out) {
  const bool events = camera.given.modality == Modality::Events;
  const std::string kind = events ? "events" : "frames";
  if ((events ? statistics.events : statistics.frames).count == 0)
    out.error(fmt::format("no {}: the mode needs them, and the recording has none", kind),
              fmt::format("record them, name their topic with --topic {}=NAME, or choose another --mode", kind));
  if (camera.done && camera.contradiction_deg > 0.0 && !is_unusable(Unusable::Calibration, out.list))
    out.error(fmt::format("camera {}: turns as if mounted about {:.0f} deg off the calibration, by the gyro",
                          camera.given.name, camera.contradiction_deg),
              "check the rotation of T_B_C and its direction: `edged calib` shows both");
  if (!camera.same_lens) check_lever_arm(camera.given, out);
}

std::vector<Finding> RunCheck::check(const RecordingStatistics& statistics, bool dropped_frames) const {
  CheckInput input{statistics, true, {}, dropped_frames, accel_axes_.better(), noise_, stereo_.exchanged()};
  for (const Camera& camera : cameras_) {
    if (camera.deferred) continue;
    input.cameras.push_back(
        {camera.given, has_extrinsics_, std::nullopt,
         other_clock_rate(camera.visual.turns(), gyro_, camera.given.time_offset, statistics.imu_span_ratio())});
    if (!camera.done || !camera.agreement) continue;
    input.cameras.back().agreement = inflated(*camera.agreement, camera.given);
    input.cameras.back().lens = camera.lens;
  }
  Findings out{check_recording(input)};
  for (const Camera& camera : cameras_) check_camera(camera, statistics, out);
  std::erase_if(out.list, [](const Finding& f) { return f.severity < Severity::Warning; });
  return out.list;
}

std::vector<Finding> RunCheck::news() {
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

bool RunCheck::agrees_with(const RigCamera& estimated) const {
  constexpr double kLeast = 1.5 * kDegree, kSureOf = 2.0 * kDegree, kSigmas = 3.0;
  const auto own = std::ranges::find(cameras_, estimated.name, [](const Camera& camera) { return camera.given.name; });
  if (own == cameras_.end()) return false;
  return std::ranges::any_of(cameras_, [&](const Camera& camera) {
    if (!is_same_lens(camera.given, own->given) || !agrees(camera.agreement) || camera.agreement->mirrored)
      return false;
    const double sigma = camera.agreement->rotation_sigma;
    const double off = Eigen::AngleAxisd(estimated.T_B_C.R().transpose() * camera.agreement->R_B_C).angle();
    return sigma < kSureOf && off < std::max(kLeast, kSigmas * sigma);
  });
}

std::vector<Finding> RunCheck::findings(const Dataset& dataset, const std::optional<GroundTruth>& truth,
                                        bool dropped_frames) {
  for (Camera& camera : cameras_) {
    if (!camera.done && !camera.deferred && camera.turning >= first_look(camera.given)) compare(camera);
    camera.done = true;
  }
  return check(collector_.result(dataset, truth), dropped_frames);
}

}  // namespace edged
