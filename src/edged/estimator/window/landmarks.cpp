// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/landmarks.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "edged/camera/two_view.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/statistics.hpp"
#include "edged/estimator/tuning.hpp"
#include "edged/estimator/window/camera_poses.hpp"
#include "edged/estimator/window/cost.hpp"

namespace edged {
namespace {

/// The observation of the oldest keyframe that observes the feature.
std::optional<ObservationKey> oldest_view(const Window& window, const Feature& feature) {
  for (const auto& [view, observation] : feature.observations) {
    if (window.states().at(view.state).keyframe) return view;
  }
  return std::nullopt;
}

/// Two views of one camera fit almost any point, so three must agree, or two cameras at one instant, whose baseline is
/// known.
bool can_be_judged(const Feature& feature) {
  const auto same_instant = [](const auto& a, const auto& b) { return a.first.state == b.first.state; };
  const auto& seen = feature.observations;
  return seen.size() > 2 || std::adjacent_find(seen.begin(), seen.end(), same_instant) != seen.end();
}

bool depth_in_bounds(double inverse_depth, const LandmarkConfig& config) {
  return inverse_depth > 1.0 / config.max_depth_m && inverse_depth < 1.0 / config.min_depth_m;
}

/// Where the rays of a track with parallax meet.
struct Triangulation {
  ObservationKey anchor;
  std::optional<double> inverse_depth;  ///< nothing for a point behind a camera
};

/// Nothing where there is too little parallax, or the views contradict one another.
std::optional<Triangulation> triangulate_feature(const Window& window, const Feature& feature,
                                                 const LandmarkConfig& config) {
  const std::optional<ObservationKey> anchor = oldest_view(window, feature);
  if (!anchor || !can_be_judged(feature)) return std::nullopt;
  std::vector<Ray> rays;
  double sigma = 0.0;
  for (const auto& [view, observation] : feature.observations) {
    rays.push_back(ray_of({window.T_O_C(view), window.point(view, observation)}));
    sigma = observation.sigma;
  }
  const double parallax = largest_angle(rays);
  if (parallax < kLandmarkTuning.min_parallax_deg * kDegree) return std::nullopt;
  const auto point = triangulate(rays, parallax);
  if (!point) return Triangulation{*anchor, std::nullopt};
  if (point->rms_residual > config.max_residual_sigma * sigma) return std::nullopt;
  const auto inverse_depth = inverse_depth_in(window, *anchor, point->p_A, config);
  return inverse_depth ? std::optional(Triangulation{*anchor, inverse_depth}) : std::nullopt;
}

/// Landmarks of each camera: those that are no longer observed still constrain the window, but must not take the budget
/// of observed ones.
class LandmarkBudget {
 public:
  LandmarkBudget(std::size_t cameras, int most) : most_(most), observed_(cameras, 0), all_(cameras, 0) {}

  void add(const Window& window, const Feature& landmark) {
    for (const auto& [camera, last_seen] : landmark.last_seen) {
      ++all_[camera];
      if (window.alive(landmark, camera)) ++observed_[camera];
    }
  }
  bool has_room(const Window& window, const Feature& feature) const {
    return std::ranges::any_of(feature.last_seen, [&](const auto& seen) {
      const std::size_t camera = seen.first;
      return all_[camera] < 2 * most_ && (!window.alive(feature, camera) || observed_[camera] < most_);
    });
  }
  int observed(std::size_t camera) const { return observed_[camera]; }
  int all(std::size_t camera) const { return all_[camera]; }

 private:
  int most_;  ///< per camera
  std::vector<int> observed_, all_;
};

/// Without translation the errors of tracks pass for parallax, and put a point behind the cameras as often as before
/// them; with it, hardly any is behind them.
bool shows_translation(int before, int behind) {
  return behind == 0 || before - behind >= kLandmarkTuning.translation_sigmas * std::sqrt(before + behind);
}

/// Where the states of the present window see from.
class Fit {
 public:
  explicit Fit(const Window& window) : views_(window) {
    for (const auto& [id, state] : window.states()) place_.emplace(id, place_.size());
  }
  CameraView at(const ObservationKey& view) const { return views_.at(view.camera, place_.at(view.state)); }

 private:
  CameraPoses views_;
  std::map<StateId, std::size_t> place_;  ///< place of a state in the window
};

/// Residuals of the observations of a landmark.
class LandmarkFit {
 public:
  /// Both must outlive this.
  LandmarkFit(const Fit& fit, const Feature& feature)
      : fit_(fit),
        feature_(feature),
        landmark_(fit.at(*feature.anchor), feature.observations.at(*feature.anchor).image, feature.inverse_depth) {}

  /// Predicted minus observed position on the unit plane; false if it is behind the camera.
  bool error(const ObservationKey& view, const WindowObservation& observation, Eigen::Vector2d& e) const {
    return landmark_.error(fit_.at(view), observation.image, e);
  }

  /// Residual of one observation in standard deviations; infinite when it is behind the camera.
  double sigmas(const ObservationKey& view, const WindowObservation& observation) const {
    Eigen::Vector2d e;
    if (!error(view, observation, e)) return std::numeric_limits<double>::infinity();
    return e.norm() / observation.sigma;
  }

  /// Root mean square of the residuals [sigma]; nothing if it has too few observations.
  std::optional<double> rms_sigmas() const {
    if (feature_.observations.size() < kLandmarkTuning.min_observations) return std::nullopt;
    double sum = 0.0;
    for (const auto& [view, observation] : feature_.observations) {
      if (view != *feature_.anchor) sum += std::pow(sigmas(view, observation), 2);
    }
    return std::sqrt(sum / (2.0 * static_cast<double>(feature_.observations.size() - 1)));
  }

 private:
  const Fit& fit_;
  const Feature& feature_;
  AnchoredLandmark landmark_;
};

/// The observations beyond the limit, but for the anchor's.
std::vector<ObservationKey> bad_observations(const LandmarkFit& fit, const Feature& feature, double max_sigmas) {
  std::vector<ObservationKey> bad;
  for (const auto& [view, observation] : feature.observations) {
    if (view != *feature.anchor && fit.sigmas(view, observation) > max_sigmas) bad.push_back(view);
  }
  return bad;
}

/// Per camera: the limit for the RMS residual of the landmarks anchored in it [sigma].
std::vector<double> misfit_limits(const Window& window, const Fit& fit, double max_misfit) {
  std::vector<std::vector<double>> rms(window.cameras().size());
  for (const auto& [id, feature] : window.features()) {
    if (!feature.anchor) continue;
    if (const auto value = LandmarkFit(fit, feature).rms_sigmas()) rms[feature.anchor->camera].push_back(*value);
  }
  std::vector<double> limits;
  for (std::vector<double>& of_camera : rms) {
    const bool judged = of_camera.size() >= kLandmarkTuning.min_landmarks;
    limits.push_back(judged ? max_misfit * std::max(kLandmarkTuning.min_median_sigma, median(std::move(of_camera)))
                            : std::numeric_limits<double>::infinity());
  }
  return limits;
}

}  // namespace

void LandmarkConfig::visit(ConfigFields& fields) {
  fields.add("min_depth_m", min_depth_m, {"m", 0.01, 10, "Nearer landmarks are rejected."});
  fields.add("max_depth_m", max_depth_m, {"m", 1, 1000, "Farther landmarks are rejected."});
  fields.add("max_residual_sigma", max_residual_sigma,
             {"sigma", 1, 20, "Observations with larger residuals are removed."});
  fields.add("max_misfit", max_misfit,
             {"", 1, 1000,
              "A landmark is removed as dynamic when its residuals exceed the median landmark's by this factor."});
  fields.add("max_per_camera", max_per_camera,
             {"", 10, 500, "Number of landmarks in the cost, per camera. More are more accurate and slower."});
}

bool rotation_measured(const Window& window) {
  return std::ranges::none_of(window.states(), [](const auto& entry) { return entry.second.imu.gyro_clipped(); });
}

void triangulate_features(Window& window, const LandmarkConfig& config, Tracks tracks) {
  const bool ended_too = tracks == Tracks::All;
  LandmarkBudget budget(window.cameras().size(), config.max_per_camera);
  std::vector<std::map<FeatureId, Feature>::const_iterator> candidates;
  for (auto entry = window.features().begin(); entry != window.features().end(); ++entry) {
    const Feature& feature = entry->second;
    if (feature.anchor) {
      budget.add(window, feature);
    } else if (ended_too || window.alive(feature)) {
      candidates.push_back(entry);
    }
  }
  std::ranges::stable_sort(candidates, std::ranges::greater(),
                           [](const auto& entry) { return entry->second.observations.size(); });
  std::vector<std::pair<FeatureId, NewAnchor>> found;
  std::vector<int> behind(window.cameras().size(), 0);
  for (const auto& candidate : candidates) {
    const auto& [id, feature] = *candidate;
    if (!budget.has_room(window, feature)) continue;
    const auto point = triangulate_feature(window, feature, config);
    if (!point) continue;
    if (point->inverse_depth) {
      found.emplace_back(id, NewAnchor{point->anchor, *point->inverse_depth});
      budget.add(window, feature);
    } else {
      ++behind[point->anchor.camera];
    }
  }
  // Rotation that is not measured puts points behind cameras as well.
  const bool measured = rotation_measured(window);
  for (const auto& [id, anchor] : found) {
    const std::size_t camera = anchor.key.camera;
    const int before = ended_too ? budget.all(camera) : budget.observed(camera);
    if (!measured || shows_translation(before, behind[camera])) window.make_landmark(id, anchor);
  }
}

std::vector<FeatureId> reject_unexpected(Window& window) {
  const StateId newest = window.newest_id();
  const Fit fit(window);
  std::vector<FeatureId> unexpected;
  for (std::size_t camera = 0; camera < window.cameras().size(); ++camera) {
    std::vector<FeatureId> far;
    std::size_t seen = 0;
    for (const auto& [id, feature] : window.features()) {
      const auto observation = feature.observations.find({newest, camera});
      if (!feature.anchor || observation == feature.observations.end()) continue;
      ++seen;
      if (LandmarkFit(fit, feature).sigmas(observation->first, observation->second) >
          kLandmarkTuning.max_innovation_sigma)
        far.push_back(id);
    }
    if (2 * far.size() > seen) continue;
    for (const FeatureId id : far) window.remove_observation(id, {newest, camera});
    unexpected.insert(unexpected.end(), far.begin(), far.end());
  }
  return unexpected;
}

std::vector<FeatureId> remove_outliers(Window& window, const LandmarkConfig& config) {
  const Fit fit(window);
  const std::vector<double> limits = misfit_limits(window, fit, config.max_misfit);
  std::vector<FeatureId> wrong, gone;
  std::vector<std::pair<FeatureId, ObservationKey>> taken_out;
  for (const auto& [id, feature] : window.features()) {
    if (!feature.anchor) continue;
    // Before its worst observations are removed: these say more about it than the remaining ones.
    const LandmarkFit landmark(fit, feature);
    const bool misfit = !depth_in_bounds(feature.inverse_depth, config) ||
                        landmark.rms_sigmas().value_or(0.0) > limits[feature.anchor->camera];
    const auto bad =
        misfit ? std::vector<ObservationKey>() : bad_observations(landmark, feature, config.max_residual_sigma);
    const bool newest_bad = std::ranges::any_of(bad, [&last_seen = feature.last_seen](const ObservationKey& view) {
      return view.state == last_seen.at(view.camera);
    });
    // Right after a change of anchor a landmark has one observation until its camera's next image.
    const bool goes = misfit || (feature.observations.size() - bad.size() < 2 && !window.alive(feature));
    if (goes) gone.push_back(id);
    for (const ObservationKey& view : bad) taken_out.emplace_back(id, view);
    if (window.alive(feature) && (goes || newest_bad)) wrong.push_back(id);
  }
  for (const auto& [id, view] : taken_out) window.remove_observation(id, view);
  for (const FeatureId id : gone) window.remove_feature(id);
  return wrong;
}

void remove_hidden(Window& window) {
  const Fit fit(window);
  std::vector<std::pair<FeatureId, ObservationKey>> hidden;
  std::vector<FeatureId> gone;
  for (const auto& [id, feature] : window.features()) {
    if (!feature.anchor) continue;
    const LandmarkFit landmark(fit, feature);
    std::size_t left = feature.observations.size();
    for (const auto& [view, observation] : feature.observations) {
      if (view == *feature.anchor || std::isfinite(landmark.sigmas(view, observation))) continue;
      hidden.emplace_back(id, view);
      --left;
    }
    if (left < 2) gone.push_back(id);
  }
  for (const auto& [id, view] : hidden) window.remove_observation(id, view);
  for (const FeatureId id : gone) window.remove_feature(id);
}

void predict_observations(Window& window) {
  const Fit fit(window);
  std::vector<std::tuple<FeatureId, ObservationKey, Eigen::Vector2d>> due;
  for (const auto& [id, feature] : window.features()) {
    if (!feature.anchor) continue;
    const LandmarkFit landmark(fit, feature);
    for (const auto& [view, observation] : feature.observations) {
      Eigen::Vector2d e;
      if (observation.predicted || view == *feature.anchor || !landmark.error(view, observation, e)) continue;
      due.emplace_back(id, view, window.point(view, observation) + e);
    }
  }
  for (const auto& [id, view, point] : due) window.predict(id, view, point);
}

std::optional<double> median_residual(const Window& window, std::size_t camera, Newness newness) {
  constexpr double kMedianOfNorm = 1.1774;  // of a two-dimensional unit normal
  const StateId newest = window.newest_id();
  const Fit fit(window);
  std::vector<double> residuals;
  for (const auto& [id, feature] : window.features()) {
    if (!feature.anchor || !feature.last_seen.contains(camera)) continue;
    const LandmarkFit landmark(fit, feature);
    Eigen::Vector2d before = Eigen::Vector2d::Zero(), error;
    for (const TrackStep& step : track_steps(window, feature)) {
      if (step.before == *feature.anchor) before.setZero();
      if (!landmark.error(step.seen, feature.observations.at(step.seen), error)) break;
      if (step.seen.camera == camera && (newness == Newness::Any || step.seen.state == newest)) {
        residuals.push_back((error - step.correlation * before).norm() / step.sigma);
      }
      before = error;
    }
  }
  if (residuals.size() < kLandmarkTuning.min_landmarks) return std::nullopt;
  return median(std::move(residuals)) / kMedianOfNorm;
}

std::optional<double> inverse_depth_in(const Window& window, const ObservationKey& view, const Eigen::Vector3d& p_O,
                                       const LandmarkConfig& config) {
  const double inverse_depth = 1.0 / (window.T_O_C(view).inverse() * p_O).z();
  return depth_in_bounds(inverse_depth, config) ? std::optional(inverse_depth) : std::nullopt;
}

}  // namespace edged
