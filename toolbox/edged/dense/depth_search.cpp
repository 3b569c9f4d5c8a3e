// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/dense/depth_search.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace edged {
namespace {

using Eigen::Matrix2f;
using Eigen::Matrix3d;
using Eigen::Vector2f;

constexpr int kSamples = 13;
/// A disc around the pixel.
constexpr std::array<std::array<float, 2>, kSamples> kPattern = {
    {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}, {2, 0}, {-2, 0}, {0, 2}, {0, -2}}};
constexpr float kMostMagnified = 2.0F;
constexpr float kMargin_px = 3.0F * kMostMagnified + 1.0F;  // of a pixel in a view, so that its patch lies inside
constexpr float kUnrelated = 1.0F;  // cost of a view that does not correlate, or does not show the place
constexpr int kReach = 4;           // steps of a pixel from the expected place, at most

/// A patch of mean zero and norm one.
using Samples = std::array<float, kSamples>;

std::optional<Samples> normalized(Samples samples) {
  float sum = 0.0F;
  for (const float x : samples) sum += x;
  float squares = 0.0F;
  for (float& x : samples) x -= sum / kSamples, squares += x * x;
  constexpr float kLeastSquares = 13.0F;  // a deviation of one grey level
  if (!(squares > kLeastSquares)) return std::nullopt;
  const float scale = 1.0F / std::sqrt(squares);
  for (float& x : samples) x *= scale;
  return samples;
}

Samples samples_at(const cv::Mat& image, const Vector2f& at, const Matrix2f& A) {
  const auto* data = image.ptr<float>();
  const auto row = static_cast<std::ptrdiff_t>(image.step1());
  Samples samples;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const auto& [dx, dy] = kPattern[i];
    const float x = at.x() + A(0, 0) * dx + A(0, 1) * dy, y = at.y() + A(1, 0) * dx + A(1, 1) * dy;
    const int x_0 = static_cast<int>(x), y_0 = static_cast<int>(y);
    const float fx = x - static_cast<float>(x_0), fy = y - static_cast<float>(y_0);
    const float* p = data + y_0 * row + x_0;
    const float top = p[0] + fx * (p[1] - p[0]), bottom = p[row] + fx * (p[row + 1] - p[row]);
    samples[i] = top + fy * (bottom - top);
  }
  return samples;
}

float correlation(const Samples& reference, const Samples& samples) {
  float sum = 0.0F, squares = 0.0F, product = 0.0F;
  for (std::size_t i = 0; i < kSamples; ++i)
    sum += samples[i], squares += samples[i] * samples[i], product += samples[i] * reference[i];
  const float variance = squares - sum * sum / kSamples;  // reference has mean zero
  return variance > 1.0F ? product / std::sqrt(variance) : 0.0F;
}

Matrix3d matrix_of(const CameraModel& pinhole) {
  Matrix3d K;
  K << pinhole.fx(), 0.0, pinhole.cx(), 0.0, pinhole.fy(), pinhole.cy(), 0.0, 0.0, 1.0;
  return K;
}

/// The patch around a pixel of the reference.
struct ReferencePatch {
  Vector2f pixel;
  float scale;  ///< scale of the pattern
  Samples samples;
};

float cost_of(const ReferencePatch& reference, const EpipolarView& view, float w) {
  const auto place = view.place(reference.pixel, w);
  if (!place) return std::numeric_limits<float>::quiet_NaN();
  return std::min(kUnrelated, 1.0F - correlation(reference.samples, samples_at(view.smooth(), place->pixel,
                                                                               reference.scale * place->by_reference)));
}

/// Where the parabola through three costs at -1, 0 and 1 is least.
float vertex(float before, float here, float after) {
  const float curvature = before - 2.0F * here + after;
  return curvature > 1e-6F ? std::clamp(0.5F * (before - after) / curvature, -0.5F, 0.5F) : 0.0F;
}

/// What one search finds.
struct Found {
  float w, sigma;
  float px_per_w = 0.0F;  ///< pixels of the view per inverse depth
};

/// How far the pixel's place moves in a view, at most, with the inverse depth [px m].
float speed_over(const InverseDepthRange& range, const ReferencePatch& reference,
                 std::span<const EpipolarView* const> views) {
  const float low = static_cast<float>(range.low), high = static_cast<float>(range.high);
  float speed = 0.0F;
  for (const EpipolarView* view : views)
    for (const float w : {low, 0.5F * (low + high), high})
      if (const auto place = view->place(reference.pixel, w)) speed = std::max(speed, place->by_inverse_depth.norm());
  return speed;
}

/// Of the views that show the place, if at least half of them do.
float mean_cost(const ReferencePatch& reference, std::span<const EpipolarView* const> views, float w) {
  float sum = 0.0F;
  int count = 0;
  for (const EpipolarView* view : views) {
    const float cost = cost_of(reference, *view, w);
    if (!std::isnan(cost)) sum += cost, ++count;
  }
  return 2 * count >= static_cast<int>(views.size()) ? sum / static_cast<float>(count) : kUnrelated;
}

/// Whether another minimum, more than two steps away, is about as low as that at `best`.
bool has_rival(const std::vector<float>& costs, std::ptrdiff_t best, float least_distinction) {
  const float most = costs[static_cast<std::size_t>(best)] + least_distinction;
  for (std::ptrdiff_t i = 1; i + 1 < std::ssize(costs); ++i) {
    const float* cost = costs.data() + i;
    if (std::abs(i - best) > 2 && cost[0] < most && cost[0] <= cost[-1] && cost[0] <= cost[1]) return true;
  }
  return false;
}

/// The minimum of the mean cost of the first views over the range.
std::optional<Found> first_search(const ReferencePatch& reference, std::span<const EpipolarView* const> views,
                                  const InverseDepthRange& range, const SearchConfig& config) {
  const float low = static_cast<float>(range.low), high = static_cast<float>(range.high);
  const float speed = speed_over(range, reference, views);
  const int steps =
      std::min(config.most_steps, static_cast<int>((high - low) * speed / static_cast<float>(config.step_px)));
  if (steps < 4) return std::nullopt;  // no parallax
  const float step = (high - low) / static_cast<float>(steps);
  thread_local std::vector<float> costs;
  costs.clear();
  for (int i = 0; i <= steps; ++i) costs.push_back(mean_cost(reference, views, low + step * static_cast<float>(i)));
  const auto best = std::ranges::min_element(costs);
  const std::ptrdiff_t at = best - costs.begin();
  if (*best > config.most_first_cost || at == 0 || at == steps) return std::nullopt;
  if (has_rival(costs, at, config.least_distinction)) return std::nullopt;
  return Found{low + step * (static_cast<float>(at) + vertex(best[-1], best[0], best[1])), step};
}

/// The search in one view near an estimate.
std::optional<Found> measure(const ReferencePatch& reference, const EpipolarView& view, const Found& expected,
                             const SearchConfig& config) {
  const auto place = view.place(reference.pixel, expected.w);
  if (!place) return std::nullopt;
  const float px_per_w = place->by_inverse_depth.norm();
  const int reach = std::clamp(static_cast<int>(std::ceil(2.0F * expected.sigma * px_per_w)), 1, kReach) + 1;
  std::array<float, 2 * kReach + 3> costs;
  const auto cost_at = [&](int i) -> float& { return costs[static_cast<std::size_t>(i + reach)]; };
  int best = 0;
  for (int i = -reach; i <= reach; ++i) {
    cost_at(i) = cost_of(reference, view, expected.w + static_cast<float>(i) / px_per_w);
    if (std::isnan(cost_at(i))) return std::nullopt;
    if (cost_at(i) < cost_at(best)) best = i;
  }
  if (std::abs(best) == reach || cost_at(best) > 1.0F - config.least_correlation) return std::nullopt;
  const float curvature = cost_at(best - 1) - 2.0F * cost_at(best) + cost_at(best + 1);
  if (curvature < 1e-4F) return std::nullopt;
  const float at = static_cast<float>(best) + vertex(cost_at(best - 1), cost_at(best), cost_at(best + 1));
  // The cost is half the squared difference of normalized patches: what is left of it is noise of kSamples values.
  const float noise = 2.0F * cost_at(best) / kSamples;
  const float floor = static_cast<float>(config.least_sigma_px);
  return Found{expected.w + at / px_per_w, std::sqrt(noise / curvature + floor * floor) / px_per_w, px_per_w};
}

}  // namespace

EpipolarView::EpipolarView(const cv::Mat& smooth, const CameraModel& pinhole, const CameraModel& reference,
                           const SE3& T_V_R)
    : smooth_(&smooth),
      H_((matrix_of(pinhole) * T_V_R.R() * matrix_of(reference).inverse()).cast<float>()),
      e_((matrix_of(pinhole) * T_V_R.translation()).cast<float>()) {}

std::optional<EpipolarView::Place> EpipolarView::place(const Vector2f& pixel, float inverse_depth) const {
  const Eigen::Vector3f p = H_ * pixel.homogeneous() + inverse_depth * e_;
  if (!(p.z() > 0.5F && p.z() < 2.0F)) return std::nullopt;
  const float scale = 1.0F / p.z();
  Place place;
  place.pixel = scale * p.head<2>();
  if (!(place.pixel.x() >= kMargin_px && place.pixel.y() >= kMargin_px &&
        place.pixel.x() < static_cast<float>(smooth_->cols) - kMargin_px - 1.0F &&
        place.pixel.y() < static_cast<float>(smooth_->rows) - kMargin_px - 1.0F))
    return std::nullopt;
  place.by_inverse_depth = scale * (e_.head<2>() - e_.z() * place.pixel);
  place.by_reference = scale * (H_.topLeftCorner<2, 2>() - place.pixel * H_.bottomLeftCorner<1, 2>());
  if (place.by_reference.cwiseAbs().maxCoeff() > kMostMagnified) return std::nullopt;
  return place;
}

std::optional<InverseDepth> search_depth(const cv::Mat& smooth, const cv::Point& pixel,
                                         std::span<const EpipolarView> views, const InverseDepthRange& range,
                                         const SearchConfig& config) {
  const Vector2f at(static_cast<float>(pixel.x), static_cast<float>(pixel.y));
  const auto scale = static_cast<float>(config.patch_scale);
  const std::optional<Samples> samples = normalized(samples_at(smooth, at, scale * Matrix2f::Identity()));
  if (!samples) return std::nullopt;
  const ReferencePatch reference{at, scale, *samples};
  const auto middle = static_cast<float>(0.5 * (range.low + range.high));
  std::vector<const EpipolarView*> visible;
  for (const EpipolarView& view : views)
    if (view.place(at, middle)) visible.push_back(&view);
  if (static_cast<int>(visible.size()) < config.least_views) return std::nullopt;
  std::optional<Found> found =
      first_search(reference, std::span(visible).first(std::min(config.first_views, visible.size())), range, config);
  if (!found) return std::nullopt;
  // A filter over the views: the prior only bounds the search, as the same images gave it.
  float information = 0.0F, weighted = 0.0F, px_per_w = 0.0F;
  int agree = 0;
  Found expected = *found;
  for (const EpipolarView* view : visible) {
    const std::optional<Found> measured = measure(reference, *view, expected, config);
    if (!measured) continue;
    const float gate = static_cast<float>(config.gate_sigmas) * std::hypot(measured->sigma, expected.sigma);
    if (std::abs(measured->w - expected.w) > gate) continue;
    const float weight = 1.0F / (measured->sigma * measured->sigma);
    information += weight, weighted += weight * measured->w, ++agree;
    px_per_w = std::max(px_per_w, measured->px_per_w);
    expected = {weighted / information, 1.0F / std::sqrt(information)};
  }
  if (agree < config.least_views) return std::nullopt;
  const float sigma = std::hypot(expected.sigma, static_cast<float>(config.common_sigma_px) / px_per_w);
  const bool known = expected.w > 0.0F && sigma < static_cast<float>(config.most_sigma) * expected.w;
  return known ? std::optional(InverseDepth{expected.w, sigma, agree}) : std::nullopt;
}

}  // namespace edged
