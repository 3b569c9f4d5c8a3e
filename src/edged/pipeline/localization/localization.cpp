// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/localization.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/directions.hpp"
#include "edged/pipeline/tuning.hpp"

namespace edged {
namespace {

TrackedImage without(TrackedImage image, const std::vector<FeatureId>& outliers) {
  std::erase_if(image.tracks, [&](const Track& track) { return std::ranges::count(outliers, track.id) > 0; });
  return image;
}

/// The records of a step: the public API calls the map frame W.
std::vector<KeyframeRecord> in_map(const SE3& T_M_O, std::vector<MarginalizedKeyframe> in_O) {
  std::vector<KeyframeRecord> in_W;
  in_W.reserve(in_O.size());
  for (MarginalizedKeyframe& keyframe : in_O)
    in_W.push_back({keyframe.t, T_M_O * keyframe.T_O_B, std::move(keyframe.views)});
  return in_W;
}

}  // namespace

Localization::Localization(const Rig& cameras, const ImuNoise& noise, const OdometryConfig& config,
                           StageTimings& timings, bool keeps_measurements)
    : config_(config),
      keeps_measurements_(keeps_measurements),
      noise_(noise),
      timings_(&timings),
      calibration_(cameras),
      session_(new_session({}, {}, Timestamp::min())),
      mapper_(config.map, config.status.lost_after_s),
      status_(config.status),
      body_(noise, duration_from_seconds(config.packets.max_age_s)),
      attitude_(noise) {}

Localization::Session Localization::new_session(const std::optional<BiasPrior>& prior, const ExternalCounters& earlier,
                                                Timestamp until) const {
  Session session{{calibration_.rig(), noise_, config_.estimator, calibration_.intrinsics(), prior},
                  prior,
                  earlier,
                  until,
                  BiasHistory(noise_)};
  if (!keeps_measurements_) session.estimator.keep_no_record();
  return session;
}

/// Another one begins.
void Localization::end_session(const std::optional<BiasPrior>& prior, Timestamp dead_reckoning_until) {
  mapper_.end_start(session_.estimator.record());
  session_ = new_session(prior, external_counters(), dead_reckoning_until);
}

/// For the start after the end of an estimate. Where the cameras contradict the IMU, its biases are those from before;
/// where they do so again, after a start that has relied on these, they may be the wrong ones.
std::optional<BiasPrior> Localization::prior_after_loss() const {
  if (status_.contradicted() && session_.bias_prior) return std::nullopt;
  const std::optional<BiasPrior> found = status_.contradicted() ? session_.biases.oldest() : session_.biases.newest();
  return found ? found : session_.bias_prior;
}

ExternalCounters Localization::external_counters() const {
  ExternalCounters counters = session_.earlier_counters;
  counters.add(session_.estimator.external_counters());
  return counters;
}

void Localization::begin_epoch() {
  if (session_.estimator.initialized()) place_.end_estimate(in_place());
  end_session(session_.bias_prior, Timestamp::min());
  mapper_.begin_epoch();
  status_.set_lost("a clock was set back");
  if (attitude_) attitude_.emplace(noise_);
}

Preintegration Localization::predict(const std::vector<ImuSample>& imu) {
  const auto timer = timings_->measure("predict");
  if (attitude_) attitude_->add(imu);
  Preintegration motion =
      body_.predict(imu, session_.estimator.initialized() || imu.back().t < session_.dead_reckoning_until);
  if (!session_.estimator.initialized()) place_.dead_reckon(motion);
  return motion;
}

LocalizationOutput Localization::process(Preintegration motion, const VisionOutput& seen,
                                         std::vector<ExternalSample> external) {
  const Timestamp t = motion.end();
  if (session_.estimator.initialized()) {
    if (body_.gap_s() > kPipelineTuning.max_gap_s) map_window();
    if (body_.gap_s() > kPipelineTuning.longest_gap_s ||
        (body_.silent_s() > kPipelineTuning.longest_gap_s && !seen_by_frames(seen)))
      return end_at_gap(motion, seen);
  }
  LocalizationOutput output;
  EstimatorResult result = estimate(
      {t, std::move(motion), seen.observations, seen.keyframe, seen.events_static, seen.depth, std::move(external)},
      output.correction);
  session_.uncertainty.place_sigma = place_.doubt();
  const TrackingStatus of_odometry = status_.update(result, session_.uncertainty, session_.estimator.initialized(), t);
  const bool relocalized = update_map(t, seen, result);
  const TrackingStatus status = status_in_map(of_odometry);
  if (relocalized) {
    place_.relocalize();
    session_.covariance.reset();
  }
  update_covariance(t);
  if (is_tracking(status)) mapper_.add_pose(body_.now());
  output.step = describe(t, status, std::move(result));
  output.step.keyframe = seen.keyframe;
  output.step.scene_depth = seen.scene_depth;
  output.step.relocalized = relocalized;
  output.step.loop_closure = mapper_.loop_closure(t);
  output.correction.ended = of_odometry == TrackingStatus::Lost && session_.estimator.initialized();
  if (output.correction.ended) {
    if (status_.vision_lost()) map_window();
    place_.end_estimate(status_.vision_lost()    ? dead_reckoning()
                        : status_.contradicted() ? contradicted()
                                                 : in_place());
    end_session(prior_after_loss(), status_.vision_lost() ? t + kPipelineTuning.dead_reckoning : t);
  }
  output.correction.provisional = session_.estimator.provisional();
  return output;
}

/// The map takes the keyframes of the window: by them the body finds its place again.
void Localization::map_window() {
  if (!config_.map.enabled) return;
  for (const MarginalizedKeyframe& record : keyframe_records(session_.estimator.window()))
    mapper_.add_keyframe(record, !session_.estimator.provisional());
}

/// Without a gyro frames tell the motion, event frames do not: their events are compensated by it.
bool Localization::seen_by_frames(const VisionOutput& seen) const {
  std::size_t features = 0;
  for (const CameraObservations& view : seen.observations) {
    const std::optional<std::size_t> camera = calibration_.find(view.camera);
    if (camera && calibration_.cameras()[*camera].modality == Modality::Frames) features += view.features.size();
  }
  return features >= static_cast<std::size_t>(config_.status.min_landmarks);
}

/// Nothing is estimated across a gap whose end shows another view, or that only event frames show.
LocalizationOutput Localization::end_at_gap(const Preintegration& motion, const VisionOutput& seen) {
  const Timestamp t = motion.end();
  const double gap_s = std::max(body_.gap_s(), body_.silent_s());
  LocalizationOutput output;
  status_.set_lost(fmt::format("no IMU for {:.1f} s, nor frames", gap_s));
  mapper_.reset_uncertainty(body_.now(), gap_s);
  output.step = describe(t, TrackingStatus::Lost, {});
  for (const CameraObservations& view : seen.observations)
    for (const FeatureObservation& feature : view.features) output.correction.outliers.push_back(feature.id);
  output.correction.ended = true;
  place_.end_estimate(in_place());
  place_.dead_reckon(motion);
  end_session(prior_after_loss(), t);
  return output;
}

Step Localization::describe(Timestamp t, TrackingStatus status, EstimatorResult result) const {
  const OdomToMap& odom_to_map = mapper_.odom_to_map();
  Step step;
  step.t = t;
  step.status = status;
  step.state = odom_to_map.in_map(body_.now());
  step.covariance = session_.covariance;
  if (status == TrackingStatus::Initializing && attitude_) step.attitude = attitude_->attitude();
  step.waiting_for = std::move(result.waiting_for);
  if (status == TrackingStatus::Initializing && session_.estimator.initialized())
    step.waiting_for = missing_localization();
  step.started = std::move(result.started);
  if (status == TrackingStatus::Lost) {
    step.lost_because = status_.reason();
    step.contradicted = status_.contradicted();
  }
  if (status == TrackingStatus::Degraded) step.degraded_because = status_.reason();
  step.T_M_O = odom_to_map.T_M_O();
  step.ln_depth_scale = session_.estimator.depth_scale();
  if (config_.map.localize_only && !is_tracking(status)) return step;  // what follows would be in another frame
  step.map_matches = mapper_.map_matches(t);
  step.landmarks = odom_to_map.in_map(std::move(result.landmarks));
  step.marginalized_keyframes = in_map(odom_to_map.T_M_O(), std::move(result.marginalized_keyframes));
  return step;
}

EstimatorResult Localization::estimate(const EstimatorInput& input, VisionCorrection& correction) {
  const auto timer = timings_->measure("estimate");
  EstimatorResult result = session_.estimator.add(input);
  correction.outliers = result.outliers;
  if (result.noise_at_rest) body_.set_noise_at_rest(*result.noise_at_rest);
  if (!session_.estimator.initialized()) return result;
  attitude_.reset();
  const SE3 T_new_old = body_.correct(session_.estimator.newest(), result.new_frame, result.standstill);
  if (result.new_frame) correction.T_new_old = T_new_old;
  calibration_.update(session_.estimator.window());
  correction.cameras = calibration_.cameras();
  correction.landmarks = landmark_depths();
  // The drift of the map filter is that of an odometry with a gyro: without one, the pose is as uncertain as after a
  // loss.
  if (result.new_frame) {
    session_.started_at_O = body_.now().T_O_B.translation();
    session_.scale = ScaleUncertainty(to_seconds(kPipelineTuning.judged));
    session_.uncertainty.scale_sigma.reset();
    if (const std::optional<Matrix15d> P = session_.estimator.covariance()) session_.known = uncertainty(*P);
    mapper_.restart(T_new_old, body_.now(), session_.known ? session_.known->tilt : 0.0);
  } else if (body_.gyro_was_saturated() || body_.gap_s() > kPipelineTuning.max_gap_s) {
    mapper_.reset_uncertainty(body_.now(), body_.gap_s());
    if (body_.gap_s() > kPipelineTuning.max_gap_s) place_.end_gap();
  }
  return result;
}

LandmarkDepths Localization::landmark_depths() const {
  LandmarkDepths depths(calibration_.cameras().size());
  for (const auto& [id, feature] : session_.estimator.window().features()) {
    if (!feature.anchor) continue;
    for (const auto& [camera, last_seen] : feature.last_seen) {
      if (const std::optional<double> z = session_.estimator.depth(id, calibration_.cameras()[camera].name))
        depths[camera].emplace(id, *z);
    }
  }
  return depths;
}

/// The map uses frames if these have enough features, as the appearance of an event frame depends on the motion; those
/// of all cameras of the kind that have one in the packet.
std::vector<PosedImage> Localization::mapping_images(const VisionOutput& seen, const std::vector<FeatureId>& outliers) {
  const std::vector<RigCamera>& cameras = calibration_.cameras();
  const auto is_frames = [&](std::size_t camera) { return cameras[camera].modality == Modality::Frames; };
  double effective_frame_tracks = 0.0;
  std::vector<TrackedImage> images;
  for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
    images.push_back(without(seen.images[camera], outliers));
    if (is_frames(camera)) effective_frame_tracks += images.back().effective_tracks();
  }
  const bool frames =
      is_frames(0) || effective_frame_tracks >= kPipelineTuning.min_frame_tracks_for_map;  // event cameras come first
  std::vector<PosedImage> mapping;
  for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
    if (is_frames(camera) != frames || images[camera].image.empty()) continue;
    const RigCamera& calibrated = cameras[camera];
    images[camera].model = calibration_.image_model(camera, images[camera].model);
    mapping.push_back({std::move(images[camera]), body_.extrapolate(calibrated.time_offset) * calibrated.T_B_C});
  }
  return mapping;
}

/// True when the body has been relocalized in the map.
bool Localization::update_map(Timestamp t, const VisionOutput& seen, const EstimatorResult& result) {
  if (!session_.estimator.initialized() || !config_.map.enabled) return false;
  const auto timer = timings_->measure("map");
  bool relocalized = false;
  if (config_.map.localize_only && mapper_.localized() &&
      status_.since_visual_update_s() > kPipelineTuning.max_unsupported_s)
    mapper_.reset_uncertainty(body_.now());
  const Motion motion = result.turning ? Motion::Turning : result.standstill ? Motion::None : Motion::Any;
  mapper_.predict(body_.now(), motion, session_.known);
  const std::vector<PosedImage> images = mapping_images(seen, result.outliers);
  if (!images.empty()) {
    relocalized = mapper_.localize(t, images, place_.doubt());
    if (seen.keyframe) mapper_.keyframe(t, images);
  }
  for (const MarginalizedKeyframe& record : result.marginalized_keyframes) mapper_.add_keyframe(record);
  return relocalized;
}

std::string Localization::missing_localization() const {
  return fmt::format("localization in the map, {:.1f} s without a match", mapper_.unmatched_s());
}

TrackingStatus Localization::status_in_map(TrackingStatus of_odometry) {
  if (!config_.map.localize_only) return of_odometry;
  return status_.update_in_map(of_odometry, mapper_.localized() ? "" : "no " + missing_localization());
}

void Localization::load_map(std::string_view bytes) {
  if (mapper_.started()) throw InputError("a map can be loaded only before the first pose");
  const SavedMap map = saved_map_from_bytes(bytes);
  check_fits(map, calibration_.given());
  mapper_.load(map);
}

std::optional<std::string> Localization::save_map() const {
  std::optional<SavedMap> map = mapper_.save();
  if (!map) return std::nullopt;
  for (const auto& [name, modality, model, T_B_C, time_offset] : calibration_.given().cameras)
    map->cameras.push_back({name, model.width(), model.height(), model.mean_focal()});
  return to_bytes(*map);
}

PlaceUncertainty::DeadReckoning Localization::dead_reckoning() const {
  if (!session_.covariance) return {};
  const Eigen::Vector3d up_B = body_.now().T_O_B.R().row(2);
  const auto& [position, rotation, velocity] = *session_.covariance;
  return {.velocity = std::sqrt(velocity.diagonal().maxCoeff()),
          .tilt = std::sqrt(rotation.diagonal().maxCoeff()),
          .yaw = std::sqrt(up_B.dot(rotation * up_B))};
}

/// After a loss without dead reckoning the body stays in place, which is wrong by all of its velocity.
PlaceUncertainty::DeadReckoning Localization::in_place() const {
  PlaceUncertainty::DeadReckoning begin = dead_reckoning();
  begin.velocity = std::hypot(begin.velocity, body_.now().v_O.norm());
  return begin;
}

/// The motion of a contradicted estimate is wrong by an unknown share; it would have been contradicted before if it
/// were wrong for long.
PlaceUncertainty::DeadReckoning Localization::contradicted() const {
  PlaceUncertainty::DeadReckoning begin = in_place();
  begin.position = std::min((body_.now().T_O_B.translation() - session_.started_at_O).norm(),
                            begin.velocity * to_seconds(kPipelineTuning.judged));
  return begin;
}

/// P is relative to the start of the estimator; what earlier losses leave uncertain comes on top.
StateCovariance Localization::covariance_in_map(const Matrix15d& P) const {
  const Eigen::Matrix3d R_M_O = mapper_.odom_to_map().T_M_O().R();
  const OdomState& now = body_.now();
  const Eigen::Vector3d up_B = now.T_O_B.R().row(2);
  const auto by_yaw = [&](const Eigen::Vector3d& v_O) -> Eigen::Matrix3d {
    const Eigen::Vector3d swing = place_.yaw() * Eigen::Vector3d::UnitZ().cross(R_M_O * v_O);
    return swing * swing.transpose();
  };
  const auto in_M = [&](const Eigen::Matrix3d& P_O) -> Eigen::Matrix3d { return R_M_O * P_O * R_M_O.transpose(); };
  return {in_M(P.block<3, 3>(0, 0)) + place_.position() * place_.position() * Eigen::Matrix3d::Identity() +
              by_yaw(now.T_O_B.translation() - session_.started_at_O),
          P.block<3, 3>(3, 3) + place_.yaw() * place_.yaw() * up_B * up_B.transpose(),
          in_M(P.block<3, 3>(6, 6)) + by_yaw(now.v_O)};
}

OdomUncertainty Localization::uncertainty(const Matrix15d& P) const {
  const auto sigma = [&](Eigen::Index first) { return std::sqrt(P.diagonal().segment<3>(first).mean()); };
  return {.tilt = tilt_sigma(session_.estimator.newest().T_O_B.R(), P.block<3, 3>(3, 3)),
          .velocity = sigma(6),
          .gyro_bias = sigma(9)};
}

void Localization::update_covariance(Timestamp t) {
  if (session_.covariance && t - session_.covariance_at < kPipelineTuning.covariance_interval) return;
  const auto timer = timings_->measure("covariance");
  session_.covariance.reset();
  session_.covariance_at = t;
  if (const std::optional<Matrix15d> P = session_.estimator.covariance()) {
    const OdomState& newest = session_.estimator.newest();
    if (!session_.estimator.provisional()) session_.uncertainty.bias_change = session_.biases.add(newest, *P);
    place_.update(std::sqrt(P->diagonal().head<3>().maxCoeff()), config_.status.max_place_sigma);
    session_.uncertainty.velocity_sigma = std::max(
        0.0, std::sqrt(P->diagonal().segment<3>(6).maxCoeff()) - kPipelineTuning.velocity_share * newest.v_O.norm());
    if (session_.uncertainty.velocity_sigma < config_.status.max_velocity_sigma)  // else unknown, whatever the scale
      session_.scale.add(t, newest.v_O, P->block<3, 3>(6, 6));
    session_.uncertainty.scale_sigma = session_.scale.sigma();
    session_.covariance = covariance_in_map(*P);
    session_.known = uncertainty(*P);
  }
}

std::optional<CalibrationCovariance> Localization::calibration_covariance(const std::string& camera) const {
  const std::optional<std::size_t> index = calibration_.find(camera);
  return index ? session_.estimator.calibration_covariance(*index) : std::nullopt;
}

}  // namespace edged
