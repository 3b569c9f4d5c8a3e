// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/patch.hpp"

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

/// Positions of a square of samples in the patch, relative to its middle.
template <int Size>
struct Offsets {
  std::array<float, Size * Size> x, y;
  constexpr Offsets() : x(), y() {
    for (int i = 0; i < Size * Size; ++i) x[i] = i % Size - 0.5F * (Size - 1), y[i] = i / Size - 0.5F * (Size - 1);
  }
};
template <int Size>
constexpr Offsets<Size> kOffsets;

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
struct Template {
  Samples grey;
  Eigen::Matrix<float, kSamples, 2> gradient;
};

std::optional<Template> template_of(const Patch& patch) {
  Template made;
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

/// Samples the image around the middle of the patch, Size x Size pixels of the patch, row by row; false where that is
/// outside. Alignment and map spend most of their time here: three plain loops, two of which the compiler vectorizes.
template <int Size>
bool sample(const cv::Mat& image, const Eigen::Vector2d& middle, const Eigen::Matrix2d& A, float* samples) {
  constexpr int kCount = Size * Size;
  constexpr double kRounding = 1e-4;  // of the positions below [px]
  const Eigen::Vector2d reach = 0.5 * (Size - 1) * A.cwiseAbs().rowwise().sum();
  if (!((middle - reach).minCoeff() >= kRounding) || !(middle.x() + reach.x() < image.cols - 1 - kRounding) ||
      !(middle.y() + reach.y() < image.rows - 1 - kRounding))
    return false;
  const Eigen::Vector2d first = (middle - reach).array() - kRounding;  // all positions lie right of and below it
  const int left = static_cast<int>(first.x()), top = static_cast<int>(first.y());
  const Eigen::Vector2f m = (middle - Eigen::Vector2d(left, top)).cast<float>();
  const Eigen::Matrix2f a = A.cast<float>();
  const std::uint8_t *upper = image.ptr(top) + left, *lower = image.ptr(top + 1) + left;
  const auto bytes_of_row = static_cast<float>(static_cast<int>(image.step[0]));
  std::array<float, kCount> fx, fy;
  std::array<std::int32_t, kCount> offset;   // of the upper left pixel: below 2^24, so exact as a float
  std::array<std::uint32_t, kCount> pixels;  // the four around a position, a byte each
  for (int i = 0; i < kCount; ++i) {
    const float right = kOffsets<Size>.x[i], down = kOffsets<Size>.y[i];
    const float x = m.x() + a(0, 0) * right + a(0, 1) * down, y = m.y() + a(1, 0) * right + a(1, 1) * down;
    const auto whole_x = static_cast<float>(static_cast<std::int32_t>(x));
    const auto whole_y = static_cast<float>(static_cast<std::int32_t>(y));
    offset[i] = static_cast<std::int32_t>(whole_y * bytes_of_row + whole_x);
    fx[i] = x - whole_x, fy[i] = y - whole_y;
  }
  for (int i = 0; i < kCount; ++i) {
    const std::uint8_t *above = upper + offset[i], *below = lower + offset[i];
    pixels[i] = static_cast<std::uint32_t>(above[0] | above[1] << 8U) |
                static_cast<std::uint32_t>(below[0] | below[1] << 8U) << 16U;
  }
  const auto byte = [&](int i, int shift) {
    return static_cast<float>(static_cast<std::int32_t>(pixels[i] >> shift & 255U));
  };
  for (int i = 0; i < kCount; ++i) {
    const float above = byte(i, 0) + fx[i] * (byte(i, 8) - byte(i, 0));
    const float below = byte(i, 16) + fx[i] * (byte(i, 24) - byte(i, 16));
    samples[i] = above + fy[i] * (below - above);
  }
  return true;
}

/// The patch at a place, normalized; false where that is outside, or uniform.
bool sample(const cv::Mat& image, const Eigen::Vector2d& middle, const Eigen::Matrix2d& A, Samples& samples) {
  return sample<kInner>(image, middle, A, samples.data()) && normalise(samples);
}

/// The position with the best correlation, whole steps of the patch away from `expected`, up to `radius` of them and in
/// x and y up to Reach. The image is sampled once for all of them.
template <int Reach>
std::optional<Eigen::Vector2d> search(const Template& wanted, const cv::Mat& image, const Eigen::Vector2d& expected,
                                      const Eigen::Matrix2d& A, double radius) {
  using Square = Eigen::Matrix<float, kInner, kInner, Eigen::RowMajor>;
  constexpr int kSize = kInner + 2 * Reach;
  Eigen::Matrix<float, kSize, kSize, Eigen::RowMajor> around;
  if (!sample<kSize>(image, expected, A, around.data())) {
    if constexpr (Reach > 0) return search<Reach / 2>(wanted, image, expected, A, radius);
    return std::nullopt;
  }
  around.array() -= around.mean();
  const Eigen::Map<const Square> grey(wanted.grey.data());
  std::optional<Eigen::Vector2d> best;
  float most = 0.0F;
  for (int dy = -Reach; dy <= Reach; ++dy) {
    for (int dx = -Reach; dx <= Reach; ++dx) {
      if (dx * dx + dy * dy > radius * radius) continue;
      const auto seen = around.template block<kInner, kInner>(dy + Reach, dx + Reach);
      const float sum = seen.sum(), squares = seen.squaredNorm() - sum * sum / kSamples;
      if (!(squares >= 1.0F)) continue;
      const float similarity = seen.cwiseProduct(grey).sum() / std::sqrt(squares);
      if (similarity > most) most = similarity, best = expected + A * Eigen::Vector2d(dx, dy);
    }
  }
  return best;
}

std::optional<Eigen::Vector2d> search(const Template& wanted, const cv::Mat& image, const Eigen::Vector2d& expected,
                                      const Eigen::Matrix2d& A, double radius_px) {
  const double radius = radius_px / std::sqrt(std::abs(A.determinant()));  // in pixels of the patch
  if (radius < 1.0) return expected;
  return radius < 4.0 ? search<3>(wanted, image, expected, A, radius) : search<8>(wanted, image, expected, A, radius);
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
  const std::optional<Template> wanted = template_of(patch);
  if (!wanted) return found;
  Samples seen;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (sample(image, places[i].pixel, places[i].A, seen)) found[i] = seen.dot(wanted->grey);
  }
  return found;
}

std::optional<PatchMatch> match_patch(const Patch& patch, const cv::Mat& image, const Eigen::Vector2d& expected,
                                      const Eigen::Matrix2d& A, double radius_px, const PatchConfig& config) {
  constexpr double kConverged_px = 0.02, kFarthest_px = 2.0;
  const std::optional<Template> wanted = template_of(patch);
  if (!wanted) return std::nullopt;
  const std::optional<Eigen::Vector2d> nearest = search(*wanted, image, expected, A, radius_px);
  if (!nearest) return std::nullopt;
  const Eigen::Matrix2f H = wanted->gradient.transpose() * wanted->gradient;
  if (H.determinant() < 1e-8F) return std::nullopt;
  const Eigen::Matrix2d H_inverse = H.cast<double>().inverse();
  PatchMatch match{*nearest, 0.0};
  Samples seen;
  for (int i = 0; i < config.iterations; ++i) {
    if (!sample(image, match.pixel, A, seen)) return std::nullopt;
    match.similarity = seen.dot(wanted->grey);  // before a step that is small in the end
    const Eigen::Vector2d wrong = (wanted->gradient.transpose() * (seen - wanted->grey)).cast<double>();
    const Eigen::Vector2d step = A * (H_inverse * wrong);
    match.pixel -= step;
    if ((match.pixel - *nearest).norm() > kFarthest_px) return std::nullopt;
    if (step.norm() < kConverged_px) break;
  }
  return match.similarity >= config.min_similarity ? std::optional(match) : std::nullopt;
}

}  // namespace edged
