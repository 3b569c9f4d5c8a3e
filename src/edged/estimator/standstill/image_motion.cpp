// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/standstill/image_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "edged/core/statistics.hpp"
#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

Eigen::Vector2d median_of(const std::vector<Eigen::Vector2d>& vectors) {
  std::vector<double> x, y;
  for (const Eigen::Vector2d& v : vectors) x.push_back(v.x()), y.push_back(v.y());
  return {median(std::move(x)), median(std::move(y))};
}

}  // namespace

void ImageMotion::add(Timestamp t, const std::vector<CameraObservations>& observations, bool events_quiet) {
  View& view = views_.emplace_back(View{t, {}, events_quiet});
  for (const CameraObservations& camera : observations) {
    std::map<FeatureId, Eigen::Vector2d>& points = view.points[camera.camera];
    for (const FeatureObservation& f : camera.features) points.emplace(f.id, f.point);
  }
  while (views_.size() > 1 && views_[1].t <= t - duration_from_seconds(window_s_)) views_.pop_front();
  travels_.reset();
}

bool ImageMotion::events_quiet() const { return std::ranges::all_of(views_, &View::events_quiet); }

/// From the first image of each camera to its last: cameras take turns, so that these need not be in the first and the
/// last packet. Half of the window must lie between them.
const std::vector<Eigen::Vector2d>& ImageMotion::travels() {
  if (travels_) return *travels_;
  travels_.emplace();
  std::set<std::string> done;
  for (auto last = views_.rbegin(); last != views_.rend(); ++last) {
    for (const auto& [camera, points] : last->points) {
      if (!done.insert(camera).second) continue;
      const auto first = std::ranges::find_if(
          views_, [&, &camera = camera](const View& view) { return view.points.contains(camera); });
      const double span_s = to_seconds(last->t - first->t);
      if (span_s < 0.5 * window_s_) continue;
      for (const auto& [id, point] : points) {
        const auto before = first->points.at(camera).find(id);
        if (before == first->points.at(camera).end()) continue;
        travels_->push_back((point - before->second) * (window_s_ / span_s));
      }
    }
  }
  return *travels_;
}

std::optional<double> ImageMotion::median_travel() {
  std::vector<double> lengths;
  for (const Eigen::Vector2d& travel : travels()) lengths.push_back(travel.norm());
  if (lengths.size() < kStandstillTuning.min_features) return std::nullopt;
  return median(std::move(lengths));
}

ImageMotion::Common ImageMotion::common_travel() {
  std::vector<Eigen::Vector2d> all = travels();
  if (all.empty()) return {};
  Eigen::Vector2d middle = median_of(all);
  const auto half = static_cast<std::ptrdiff_t>((all.size() + 1) / 2);
  const auto error = [&](const Eigen::Vector2d& travel) { return (travel - middle).squaredNorm(); };
  for (int round = 0; round < kStandstillTuning.common_rounds; ++round) {
    std::nth_element(all.begin(), all.begin() + half - 1, all.end(),
                     [&](const auto& a, const auto& b) { return error(a) < error(b); });
    middle = std::accumulate(all.begin(), all.begin() + half, Eigen::Vector2d(0.0, 0.0)) / static_cast<double>(half);
  }
  double sum = 0.0;
  for (auto travel = all.begin(); travel != all.begin() + half; ++travel) sum += error(*travel);
  return {middle.norm(), std::sqrt(sum) / static_cast<double>(half)};
}

bool ImageMotion::glides() {
  if (travels().size() < kStandstillTuning.min_features) return false;
  const Eigen::Vector2d middle = median_of(travels());
  if (middle.norm() <= kStandstillTuning.max_image_motion) return false;
  const auto alike = std::ranges::count_if(travels(), [&](const Eigen::Vector2d& travel) {
    return (travel - middle).norm() < kStandstillTuning.glide_spread * middle.norm();
  });
  return static_cast<double>(alike) > kStandstillTuning.glide_share * static_cast<double>(travels().size());
}

}  // namespace edged
