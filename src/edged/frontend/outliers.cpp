// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Outlier rejection between two views on OpenGV.
#include "edged/frontend/outliers.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <opengv/relative_pose/CentralRelativeAdapter.hpp>
#include <opengv/sac/Ransac.hpp>
#include <opengv/sac_problems/relative_pose/CentralRelativePoseSacProblem.hpp>
#include <opengv/sac_problems/relative_pose/RotationOnlySacProblem.hpp>
#include <opengv/sac_problems/relative_pose/TranslationOnlySacProblem.hpp>

#include "edged/camera/two_view.hpp"
#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"
#include "edged/frontend/tuning.hpp"

namespace edged {
namespace {

using Adapter = opengv::relative_pose::CentralRelativeAdapter;
namespace sac_problems = opengv::sac_problems::relative_pose;

struct Rays {
  opengv::bearingVectors_t reference, current;
};

Rays make_rays(std::span<const Correspondence> pairs) {
  Rays rays;
  for (const Correspondence& pair : pairs) {
    rays.reference.push_back(pair.reference.homogeneous().normalized());
    rays.current.push_back(pair.current.homogeneous().normalized());
  }
  return rays;
}

// Angle between each pair of rays after rotation compensation [rad].
std::vector<double> rotation_residuals(std::span<const Correspondence> pairs, const Eigen::Matrix3d& R_ref_cur) {
  std::vector<double> angles;
  angles.reserve(pairs.size());
  for (const Correspondence& pair : pairs) angles.push_back(ray_angle(pair.reference, R_ref_cur, pair.current));
  return angles;
}

std::vector<char> below(const std::vector<double>& values, double limit) {
  std::vector<char> mask(values.size());
  std::transform(values.begin(), values.end(), mask.begin(), [&](double v) { return v < limit ? 1 : 0; });
  return mask;
}

int count(const std::vector<char>& mask) { return static_cast<int>(std::count(mask.begin(), mask.end(), 1)); }

template <typename Problem>
std::optional<typename Problem::model_t> ransac(const std::shared_ptr<Problem>& problem, double threshold) {
  opengv::sac::Ransac<Problem> search(kFrontendTuning.ransac_iterations, threshold, kFrontendTuning.ransac_confidence);
  search.sac_model_ = problem;
  if (!search.computeModel()) return std::nullopt;
  return search.model_coefficients_;
}

// OpenGV scores a pair by the sum of 1 - cos over both views; the triangulated point halves the distance from the
// epipolar line between them.
double epipolar_score(double distance_rad) { return 2.0 * (1.0 - std::cos(0.5 * distance_rad)); }

// Pairs that fit the motion, together with those too far away to have parallax: there the triangulated depth, and so
// OpenGV's score, is dominated by noise.
template <typename Problem>
std::vector<char> motion_inliers(Problem& problem, const typename Problem::model_t& model,
                                 std::span<const Correspondence> pairs, double threshold_rad) {
  std::vector<double> scores;
  problem.getDistancesToModel(model, scores);
  std::vector<char> mask = below(scores, epipolar_score(threshold_rad));
  const std::vector<char> still = below(rotation_residuals(pairs, model.template leftCols<3>()), threshold_rad);
  std::transform(mask.begin(), mask.end(), still.begin(), mask.begin(), [](char a, char b) { return a | b; });
  return mask;
}

OutlierResult make_result(OutlierModel model, std::vector<char> inlier) {
  const int inliers = count(inlier);
  return {model, std::move(inlier), inliers};
}

OutlierResult keep_all(std::size_t n) { return make_result(OutlierModel::None, std::vector<char>(n, 1)); }

OutlierResult known_rotation(std::span<const Correspondence> pairs, const Eigen::Matrix3d& R_ref_cur, double focal_px,
                             const OutlierConfig& config) {
  if (pairs.size() < kFrontendTuning.min_pairs_translation) return keep_all(pairs.size());
  const Rays rays = make_rays(pairs);
  Adapter adapter(rays.reference, rays.current, R_ref_cur);
  const double threshold_rad = config.threshold_px / focal_px;
  const auto problem = std::make_shared<sac_problems::TranslationOnlySacProblem>(adapter, false);
  const auto model = ransac(problem, epipolar_score(threshold_rad));
  if (!model) return keep_all(pairs.size());
  return make_result(OutlierModel::Translation, motion_inliers(*problem, *model, pairs, threshold_rad));
}

OutlierResult unknown_rotation(std::span<const Correspondence> pairs, double focal_px, const OutlierConfig& config) {
  if (pairs.size() < 2 * kFrontendTuning.min_pairs_translation) return keep_all(pairs.size());
  const Rays rays = make_rays(pairs);
  Adapter adapter(rays.reference, rays.current);
  const double threshold_rad = config.threshold_px / focal_px;

  OutlierResult rotation = keep_all(pairs.size());
  const auto turn = std::make_shared<sac_problems::RotationOnlySacProblem>(adapter, false);
  if (const auto R = ransac(turn, 1.0 - std::cos(threshold_rad))) {
    rotation = make_result(OutlierModel::RotationOnly, below(rotation_residuals(pairs, *R), threshold_rad));
  }
  const auto problem = std::make_shared<sac_problems::CentralRelativePoseSacProblem>(
      adapter, sac_problems::CentralRelativePoseSacProblem::NISTER, false);
  const auto model = ransac(problem, epipolar_score(threshold_rad));
  if (!model) return rotation;
  OutlierResult motion = make_result(OutlierModel::FivePoint, motion_inliers(*problem, *model, pairs, threshold_rad));
  const bool rotates_only = rotation.model == OutlierModel::RotationOnly &&
                            rotation.inliers >= kFrontendTuning.rotation_preference * motion.inliers;
  return rotates_only ? rotation : motion;
}

}  // namespace

void OutlierConfig::visit(ConfigFields& fields) {
  fields.add("threshold_px", threshold_px, {"px", 0.1, 20, "Largest distance of an inlier from its epipolar line."});
  fields.add("rotation_only_px", rotation_only_px,
             {"px", 0, 20, "No translation is estimated below this median parallax."});
  fields.add("rotation_gate_px", rotation_gate_px,
             {"px", 0.1, 100, "Largest parallax of an inlier while no translation is estimated."});
}

OutlierResult find_inliers(std::span<const Correspondence> pairs, const std::optional<Eigen::Matrix3d>& R_ref_cur,
                           double focal_px, const OutlierConfig& config) {
  EDGED_CHECK(focal_px > 0.0, "focal length {}", focal_px);
  const auto n = static_cast<double>(pairs.size());
  OutlierResult result = keep_all(pairs.size());
  if (R_ref_cur) {
    const std::vector<double> parallax = rotation_residuals(pairs, *R_ref_cur);
    if (median(parallax) * focal_px < config.rotation_only_px) {
      result = make_result(OutlierModel::RotationOnly, below(parallax, config.rotation_gate_px / focal_px));
    } else {
      result = known_rotation(pairs, *R_ref_cur, focal_px, config);
    }
  }
  if (!R_ref_cur || result.inliers < kFrontendTuning.fallback_share * n) {
    OutlierResult free = unknown_rotation(pairs, focal_px, config);
    const bool better = free.model != OutlierModel::None && free.inliers > result.inliers;
    if (!R_ref_cur || better) result = std::move(free);
  }
  if (result.inliers < kFrontendTuning.min_inlier_share * n) result = keep_all(pairs.size());
  return result;
}

}  // namespace edged
