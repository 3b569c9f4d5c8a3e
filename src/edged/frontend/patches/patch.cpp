// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/patches/patch.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstddef>

namespace edged {
namespace {

// The compared part: the patch without its rim, which serves the gradients.
constexpr int kInner = Patch::kSize - 2;
constexpr int kSamples = kInner * kInner;
using Samples = Eigen::Matrix<float, kSamples, 1>;

/// Positions of the inner pixels in the patch, relative to its centre.
struct Offsets {
  std::array<float, kSamples> x, y;
  constexpr Offsets() : x(), y() {
    for (int i = 0; i < kSamples; ++i) x[i] = i % kInner - 0.5F * (kInner - 1), y[i] = i / kInner - 0.5F * (kInner - 1);
  }
};
constexpr Offsets kOffsets;

float bilinear(const cv::Mat& image, double x, double y) {
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const auto fx = static_cast<float>(x - left), fy = static_cast<float>(y - top);
  const std::uint8_t* upper = image.ptr(top) + left;
  const std::uint8_t* lower = image.ptr(top + 1) + left;
  const float above = upper[0] + fx * static_cast<float>(upper[1] - upper[0]);
  const float below = lower[0] + fx * static_cast<float>(lower[1] - lower[0]);
  return above + fy * (below - above);
}

/// Removes the mean and normalizes to length one; false for a uniform patch.
bool normalise(Samples& samples) {
  samples.array() -= samples.mean();
  const float norm = samples.norm();
  if (norm < 1.0F) return false;
  samples /= norm;
  return true;
}

/// The normalized patch and its derivative with respect to its position.
struct NormalizedPatch {
  Samples grey;
  Eigen::Matrix<float, kSamples, 2> gradient;
};

std::optional<NormalizedPatch> normalized(const Patch& patch) {
  NormalizedPatch made;
  const auto at = [&](int x, int y) { return static_cast<float>(patch.pixels[y * Patch::kSize + x]); };
  for (int y = 0, i = 0; y < kInner; ++y) {
    for (int x = 0; x < kInner; ++x, ++i) {
      made.grey[i] = at(x + 1, y + 1);
      made.gradient(i, 0) = 0.5F * (at(x + 2, y + 1) - at(x, y + 1));
      made.gradient(i, 1) = 0.5F * (at(x + 1, y + 2) - at(x + 1, y));
    }
  }
  const float norm = (made.grey.array() - made.grey.mean()).matrix().norm();
  if (!normalise(made.grey)) return std::nullopt;
  made.gradient = (made.gradient.rowwise() - made.gradient.colwise().mean()) / norm;
  return made;
}

/// Samples the image at the place of the patch; false where that is outside, or uniform. Alignment and map spend most
/// of their time here: three plain loops, the first and the last of which the compiler vectorizes.
bool sample(const cv::Mat& image, const Eigen::Vector2d& middle, const Eigen::Matrix2d& A, Samples& samples) {
  const Eigen::Vector2d reach = 0.5 * (kInner - 1) * A.cwiseAbs().rowwise().sum();
  constexpr double kRounding = 1e-4;  // of the positions below [px]
  if (!((middle - reach).minCoeff() >= kRounding) || !(middle.x() + reach.x() < image.cols - 1 - kRounding) ||
      !(middle.y() + reach.y() < image.rows - 1 - kRounding))
    return false;
  const Eigen::Vector2d first = (middle - reach).array() - kRounding;  // all positions lie right of and below it
  const int left = static_cast<int>(first.x()), top = static_cast<int>(first.y());
  const Eigen::Vector2f m = (middle - Eigen::Vector2d(left, top)).cast<float>();
  const Eigen::Matrix2f a = A.cast<float>();
  std::array<int, kSamples> x, y, upper_left, upper_right, lower_left, lower_right;
  std::array<float, kSamples> fx, fy;
  for (int i = 0; i < kSamples; ++i) {
    const float place_x = m.x() + a(0, 0) * kOffsets.x[i] + a(0, 1) * kOffsets.y[i];
    const float place_y = m.y() + a(1, 0) * kOffsets.x[i] + a(1, 1) * kOffsets.y[i];
    x[i] = static_cast<int>(place_x), y[i] = static_cast<int>(place_y);
    fx[i] = place_x - static_cast<float>(x[i]), fy[i] = place_y - static_cast<float>(y[i]);
  }
  const std::uint8_t* feature = image.ptr(top) + left;
  const auto row = static_cast<std::ptrdiff_t>(image.step[0]);
  for (int i = 0; i < kSamples; ++i) {
    const std::uint8_t* upper = feature + y[i] * row + x[i];
    upper_left[i] = upper[0], upper_right[i] = upper[1];
    lower_left[i] = upper[row], lower_right[i] = upper[row + 1];
  }
  for (int i = 0; i < kSamples; ++i) {
    const float above = static_cast<float>(upper_left[i]) + fx[i] * static_cast<float>(upper_right[i] - upper_left[i]);
    const float below = static_cast<float>(lower_left[i]) + fx[i] * static_cast<float>(lower_right[i] - lower_left[i]);
    samples[i] = above + fy[i] * (below - above);
  }
  return normalise(samples);
}

/// The integer pixel within the radius with the best correlation.
std::optional<Eigen::Vector2d> search(const NormalizedPatch& wanted, const cv::Mat& image,
                                      const Eigen::Vector2d& expected, const Eigen::Matrix2d& A, double radius_px) {
  const int reach = static_cast<int>(std::ceil(radius_px));
  std::optional<Eigen::Vector2d> best;
  float most = 0.0F;
  Samples seen;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      if (dx * dx + dy * dy > radius_px * radius_px) continue;
      const Eigen::Vector2d place = expected + Eigen::Vector2d(dx, dy);
      if (!sample(image, place, A, seen)) continue;
      const float similarity = seen.dot(wanted.grey);
      if (similarity > most) most = similarity, best = place;
    }
  }
  return best;
}

}  // namespace

void PatchConfig::visit(ConfigFields& fields) {
  fields.add("min_similarity", min_similarity,
             {"", 0, 1, "Least normalized cross correlation of a stored patch with the image for a match."});
}

std::optional<Patch> cut_patch(const cv::Mat& image, const PatchPlace& place) {
  constexpr double kHalf = 0.5 * (Patch::kSize - 1);
  const Eigen::Vector2d reach = kHalf * place.A.cwiseAbs().rowwise().sum();
  const Eigen::Vector2d first = place.pixel - place.A * Eigen::Vector2d::Constant(kHalf);
  if (!((place.pixel - reach).minCoeff() >= 0.0) || !(place.pixel.x() + reach.x() < image.cols - 1) ||
      !(place.pixel.y() + reach.y() < image.rows - 1))
    return std::nullopt;
  Patch patch;
  for (int y = 0, i = 0; y < Patch::kSize; ++y) {
    for (int x = 0; x < Patch::kSize; ++x, ++i) {
      const Eigen::Vector2d at = first + place.A * Eigen::Vector2d(x, y);
      patch.pixels[i] = static_cast<std::uint8_t>(std::lround(bilinear(image, at.x(), at.y())));
    }
  }
  return patch;
}

std::vector<double> correlations(const Patch& patch, const cv::Mat& image, std::span<const PatchPlace> places) {
  std::vector<double> found(places.size(), -1.0);
  const std::optional<NormalizedPatch> wanted = normalized(patch);
  if (!wanted) return found;
  Samples seen;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (sample(image, places[i].pixel, places[i].A, seen)) found[i] = seen.dot(wanted->grey);
  }
  return found;
}

std::optional<PatchMatch> match_patch(const Patch& patch, const cv::Mat& image, const Eigen::Vector2d& expected,
                                      const Eigen::Matrix2d& A, double radius_px, const PatchConfig& config) {
  constexpr int kIterations = 10;
  constexpr double kConverged_px = 0.02, kFarthest_px = 2.0;
  const std::optional<NormalizedPatch> wanted = normalized(patch);
  if (!wanted) return std::nullopt;
  const std::optional<Eigen::Vector2d> nearest = search(*wanted, image, expected, A, radius_px);
  if (!nearest) return std::nullopt;
  const Eigen::Matrix2f H = wanted->gradient.transpose() * wanted->gradient;
  if (H.determinant() < 1e-8F) return std::nullopt;
  const Eigen::Matrix2d H_inverse = H.cast<double>().inverse();
  PatchMatch match{*nearest, 0.0};
  Samples seen;
  for (int i = 0; i < kIterations; ++i) {
    if (!sample(image, match.pixel, A, seen)) return std::nullopt;
    const Eigen::Vector2d wrong = (wanted->gradient.transpose() * (seen - wanted->grey)).cast<double>();
    const Eigen::Vector2d step = A * (H_inverse * wrong);
    match.pixel -= step;
    if ((match.pixel - *nearest).norm() > kFarthest_px) return std::nullopt;
    if (step.norm() < kConverged_px) break;
  }
  if (!sample(image, match.pixel, A, seen)) return std::nullopt;
  match.similarity = seen.dot(wanted->grey);
  return match.similarity >= config.min_similarity ? std::optional(match) : std::nullopt;
}

}  // namespace edged
