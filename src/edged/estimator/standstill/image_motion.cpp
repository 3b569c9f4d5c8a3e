// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/standstill/image_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
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
    for (const FeatureObservation& f : camera.features) view.points.emplace(f.id, f.point);
  }
  while (views_.size() > 1 && views_[1].t <= t - duration_from_seconds(window_s_)) views_.pop_front();
  travels_.reset();
}

bool ImageMotion::events_quiet() const { return std::ranges::all_of(views_, &View::events_quiet); }

/// From the first view to the last. Where cameras take turns these may share too few features: then from the first
/// observation of each to its last, if they are half of the window apart.
const std::vector<Eigen::Vector2d>& ImageMotion::travels() {
  if (travels_) return *travels_;
  travels_.emplace();
  for (const auto& [id, point] : views_.back().points) {
    const auto before = views_.front().points.find(id);
    if (before != views_.front().points.end()) travels_->push_back(point - before->second);
  }
  if (travels_->size() >= kStandstillTuning.min_features) return *travels_;
  struct Seen {
    Timestamp first_t, last_t;
    Eigen::Vector2d first, last;
  };
  std::map<FeatureId, Seen> features;
  for (const View& view : views_) {
    for (const auto& [id, point] : view.points) {
      Seen& seen = features.try_emplace(id, Seen{view.t, view.t, point, point}).first->second;
      seen.last_t = view.t, seen.last = point;
    }
  }
  travels_->clear();
  for (const auto& [id, seen] : features) {
    const double span_s = to_seconds(seen.last_t - seen.first_t);
    if (span_s >= 0.5 * window_s_) travels_->push_back((seen.last - seen.first) * (window_s_ / span_s));
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
