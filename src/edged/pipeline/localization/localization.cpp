// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/localization.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "edged/core/check.hpp"

namespace edged {
namespace {

/// With localize_only: without enough landmarks or rest. An event frame holds events of up to 0.25 s before.
constexpr double kSilentAfter_s = 0.2;

/// The covariance of the pose changes slowly, and costs a third of an optimisation.
constexpr Duration kCovarianceEvery = std::chrono::milliseconds(100);

/// With fewer features on frames than this the map uses event frames.
constexpr double kFeaturesForMap = 20.0;

/// After a loss of vision, dead reckoning is used for this time.
constexpr Duration kDeadReckoning = std::chrono::seconds(10);

TrackedImage without(TrackedImage image, const std::vector<FeatureId>& outliers) {
  std::erase_if(image.tracks, [&](const Track& track) { return std::ranges::count(outliers, track.id) > 0; });
  return image;
}

/// The records of a step: the public API calls the map frame W.
std::vector<KeyframeRecord> in_map(const SE3& T_M_O, std::vector<MarginalizedKeyframe> in_O) {
  std::vector<KeyframeRecord> in_W;
  for (MarginalizedKeyframe& keyframe : in_O)
    in_W.push_back({keyframe.t, T_M_O * keyframe.T_O_B, std::move(keyframe.views)});
  return in_W;
}

}  // namespace

Rig without_offsets(Rig rig) {
  for (RigCamera& camera : rig.cameras) camera.time_offset = Duration(0);
  return rig;
}

Localization::Localization(const Rig& cameras, const ImuNoise& noise, const OdometryConfig& config,
                           StageTimings& timings)
    : config_(config),
      noise_(noise),
      given_rig_(cameras),
      rig_(without_offsets(given_rig_)),
      intrinsics_(cameras.cameras.size(), IntrinsicsCorrection::Zero()),
      image_models_(cameras.cameras.size()),
      lens_models_(cameras.cameras.size()),
      timings_(&timings),
      estimator_(fresh_estimator()),
      mapper_(config.map, config.status.lost_after_s),
      judge_(config.status),
      biases_(noise),
      body_(noise, duration_from_seconds(config.packets.max_age_s)),
      attitude_(noise) {}

void Localization::begin_estimate() {
  counters_before_.add(estimator_.external_counters());
  estimator_ = fresh_estimator();
  biases_ = BiasHistory(noise_);
  bias_change_ = 0.0;
}

/// For the start after the end of an estimate. Where the cameras contradict the IMU, its biases are those from before;
/// where they do so again, after a start that has relied on these, they may be the wrong ones.
void Localization::learn_biases() {
  if (judge_.contradicted() && known_biases_) {
    known_biases_.reset();
  } else if (const std::optional<BiasPrior> found = judge_.contradicted() ? biases_.oldest() : biases_.newest()) {
    known_biases_ = found;
  }
}

ExternalCounters Localization::external_counters() const {
  ExternalCounters counters = counters_before_;
  counters.add(estimator_.external_counters());
  return counters;
}

void Localization::begin_time() {
  begin_estimate();
  before_ = final_trajectory();
  mapper_.begin_time();
  judge_.lose("a clock was set back");
  dead_reckoning_until_ = Timestamp::min();
  covariance_.reset();
  if (attitude_) attitude_.emplace(noise_);
}

Preintegration Localization::predict(const std::vector<ImuSample>& imu) {
  const auto timer = timings_->measure("predict");
  if (attitude_) attitude_->add(imu);
  Preintegration motion = body_.predict(imu, estimator_.initialized() || imu.back().t < dead_reckoning_until_);
  turned_unseen_ = gyro_clipped_ && !motion.gyro_clipped();
  gyro_clipped_ = motion.gyro_clipped();
  return motion;
}

LocalizationOutput Localization::process(Preintegration motion, const VisionOutput& seen,
                                         std::vector<ExternalSample> external) {
  const Timestamp t = motion.end();
  LocalizationOutput output;
  EstimatorResult result = estimate(
      {t, std::move(motion), seen.observations, seen.keyframe, seen.events_quiet, seen.depth, std::move(external)},
      output.correction);
  const TrackingStatus of_odometry = judge_.judge(result, bias_change_, estimator_.initialized(), t);
  const bool relocalized = follow_map(t, seen, result);
  const TrackingStatus status = status_in_map(of_odometry);
  update_covariance(t);
  if (is_tracking(status)) mapper_.note(body_.now());
  output.step = describe(t, status, std::move(result));
  output.step.keyframe = seen.keyframe;
  output.step.scene_depth = seen.scene_depth;
  output.step.relocalized = relocalized;
  output.step.loop_closure = mapper_.loop_closure(t);
  output.correction.ended = of_odometry == TrackingStatus::Lost && estimator_.initialized();
  if (output.correction.ended) {
    learn_biases();
    begin_estimate();
    dead_reckoning_until_ = judge_.vision_lost() ? t + kDeadReckoning : t;
  }
  output.correction.provisional = estimator_.provisional();
  return output;
}

Step Localization::describe(Timestamp t, TrackingStatus status, EstimatorResult result) const {
  const OdomToMap& odom_to_map = mapper_.odom_to_map();
  Step step;
  step.t = t;
  step.status = status;
  step.state = odom_to_map.in_map(body_.now());
  step.covariance = covariance_;
  if (status == TrackingStatus::Initializing && attitude_) step.attitude = attitude_->attitude();
  step.waiting_for = std::move(result.waiting_for);
  if (status == TrackingStatus::Initializing && estimator_.initialized()) step.waiting_for = missing_localization();
  step.started = std::move(result.started);
  if (status == TrackingStatus::Lost) {
    step.lost_because = judge_.reason();
    step.contradicted = judge_.contradicted();
  }
  step.T_M_O = odom_to_map.T_M_O();
  step.ln_depth_scale = estimator_.depth_scale();
  if (config_.map.localize_only && !is_tracking(status)) return step;  // what follows would be in another frame
  step.map_matches = mapper_.map_matches(t);
  step.landmarks = odom_to_map.in_map(std::move(result.landmarks));
  step.marginalized_keyframes = in_map(odom_to_map.T_M_O(), std::move(result.marginalized_keyframes));
  return step;
}

EstimatorResult Localization::estimate(const EstimatorInput& input, VisionCorrection& correction) {
  const auto timer = timings_->measure("estimate");
  EstimatorResult result = estimator_.add(input);
  correction.outliers = result.outliers;
  if (!estimator_.initialized()) return result;
  attitude_.reset();
  const SE3 T_new_old = body_.correct(estimator_.newest(), result.new_frame);
  if (result.new_frame) correction.T_new_old = T_new_old;
  take_calibrations();
  correction.cameras = rig_.cameras;
  correction.landmarks = landmark_depths();
  // The drift of the map filter is that of an odometry with a gyro: without one, the pose is as uncertain as after a
  // loss.
  if (result.new_frame) {
    mapper_.restart(T_new_old, body_.now());
  } else if (turned_unseen_) {
    mapper_.doubt(body_.now());
  }
  return result;
}

void Localization::take_calibrations() {
  constexpr double kMoved = 1e-5;  // a few thousandths of a pixel
  for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
    rig_.cameras[camera] = estimator_.window().cameras()[camera].calibrated();
    intrinsics_[camera] = estimator_.window().cameras()[camera].intrinsics();
    if (!lens_models_[camera].holds(intrinsics_[camera], kMoved))
      lens_models_[camera] = {intrinsics_[camera], estimator_.window().cameras()[camera].model()};
  }
}

LandmarkDepths Localization::landmark_depths() const {
  LandmarkDepths depths(rig_.cameras.size());
  for (const auto& [id, feature] : estimator_.window().features()) {
    if (!feature.anchor) continue;
    for (const auto& [camera, last_seen] : feature.last_seen) {
      if (const std::optional<double> z = estimator_.depth(id, rig_.cameras[camera].name))
        depths[camera].emplace(id, *z);
    }
  }
  return depths;
}

/// The map uses frames if these have enough features, as the appearance of an event frame depends on the motion; those
/// of all cameras of the kind that have one in the packet.
std::vector<PosedImage> Localization::mapping_images(const VisionOutput& seen, const std::vector<FeatureId>& outliers) {
  const auto is_frames = [&](std::size_t camera) { return rig_.cameras[camera].modality == Modality::Frames; };
  double carried_by_frames = 0.0;
  std::vector<TrackedImage> images;
  for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
    images.push_back(without(seen.images[camera], outliers));
    if (is_frames(camera)) carried_by_frames += images.back().carried();
  }
  const bool frames = is_frames(0) || carried_by_frames >= kFeaturesForMap;  // event cameras come first
  std::vector<PosedImage> mapping;
  for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
    if (is_frames(camera) != frames || images[camera].image.empty()) continue;
    const RigCamera& calibrated = rig_.cameras[camera];
    images[camera].model = image_model(camera, images[camera].model);
    mapping.push_back({std::move(images[camera]), body_.moved_on(calibrated.time_offset) * calibrated.T_B_C});
  }
  return mapping;
}

const CameraModel& Localization::image_model(std::size_t camera, const CameraModel& given) {
  constexpr double kMoved = 2e-4;
  KnownModel& known = image_models_[camera];
  const IntrinsicsCorrection& now = intrinsics_[camera];
  if (!known.holds(now, kMoved)) {
    const std::optional<CameraModel> corrected = corrected_image_model(given, rig_.cameras[camera].model, now);
    known = {now, corrected ? *corrected : known.model.value_or(given)};
  }
  return *known.model;
}

/// True when the body has been relocalized in the map.
bool Localization::follow_map(Timestamp t, const VisionOutput& seen, const EstimatorResult& result) {
  if (!estimator_.initialized() || !config_.map.enabled) return false;
  const auto timer = timings_->measure("map");
  bool relocalized = false;
  if (config_.map.localize_only && mapper_.localized() && judge_.unsupported_s() > kSilentAfter_s)
    mapper_.doubt(body_.now());
  mapper_.predict(body_.now(), result.standstill);
  const std::vector<PosedImage> images = mapping_images(seen, result.outliers);
  if (!images.empty()) {
    relocalized = mapper_.localize(t, images);
    if (seen.keyframe) mapper_.keyframe(t, images);
  }
  for (const MarginalizedKeyframe& record : result.marginalized_keyframes) mapper_.take(record);
  return relocalized;
}

std::string Localization::missing_localization() const {
  return fmt::format("localization in the map, {:.1f} s without a match", mapper_.unmatched_s());
}

/// With map.localize_only there is a pose only while it is localized in the map.
TrackingStatus Localization::status_in_map(TrackingStatus of_odometry) {
  if (!config_.map.localize_only) return of_odometry;
  if (is_tracking(of_odometry)) {
    if (mapper_.localized()) {
      localized_ = true;
      return of_odometry;
    }
    judge_.lose("no " + missing_localization());
  }
  return localized_ ? TrackingStatus::Lost : TrackingStatus::Initializing;
}

void Localization::load_map(std::string_view bytes) {
  if (mapper_.started()) throw InputError("a map can be loaded only before the first pose");
  const SavedMap map = saved_map_from_bytes(bytes);
  check_fits(map, given_rig_);
  mapper_.load(map);
}

std::optional<std::string> Localization::save_map() const {
  std::optional<SavedMap> map = mapper_.save();
  if (!map) return std::nullopt;
  for (const auto& [name, modality, model, T_B_C, time_offset] : given_rig_.cameras)
    map->cameras.push_back({name, model.width(), model.height(), model.mean_focal()});
  return to_bytes(*map);
}

FinalTrajectory Localization::final_trajectory() const {
  FinalTrajectory all = before_, now = mapper_.final_trajectory();
  std::ranges::move(now.poses, std::back_inserter(all.poses));
  std::ranges::move(now.keyframes, std::back_inserter(all.keyframes));
  return all;
}

void Localization::update_covariance(Timestamp t) {
  if (covariance_ && t - covariance_at_ < kCovarianceEvery && estimator_.initialized()) return;
  const auto timer = timings_->measure("covariance");
  covariance_.reset();
  covariance_at_ = t;
  if (const std::optional<Matrix15d> P = estimator_.covariance()) {
    if (!estimator_.provisional()) bias_change_ = biases_.add(estimator_.newest(), *P);
    const Eigen::Matrix3d R_M_O = mapper_.odom_to_map().T_M_O().R();
    covariance_ = {R_M_O * P->block<3, 3>(0, 0) * R_M_O.transpose(), P->block<3, 3>(3, 3),
                   R_M_O * P->block<3, 3>(6, 6) * R_M_O.transpose()};
  }
}

Rig Localization::rig() const {
  Rig rig = rig_;
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    if (lens_models_[camera].model) rig.cameras[camera].model = *lens_models_[camera].model;
    rig.cameras[camera].time_offset += given_rig_.cameras[camera].time_offset;
  }
  return rig;
}

std::optional<CalibrationCovariance> Localization::calibration_covariance(const std::string& camera) const {
  const auto found = std::ranges::find(rig_.cameras, camera, &RigCamera::name);
  if (found == rig_.cameras.end()) return std::nullopt;
  return estimator_.calibration_covariance(static_cast<std::size_t>(found - rig_.cameras.begin()));
}

}  // namespace edged
