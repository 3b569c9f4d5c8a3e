// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "pose_from_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr int kIterations = 10;
constexpr double kStep_px = 0.5;                                        // of the search for a peak
constexpr double kPriorAngle = M_PI / 180.0, kPriorDistance_m = 0.025;  // sigma

}  // namespace

float at(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::floor(pixel.x())), y = static_cast<int>(std::floor(pixel.y()));
  if (x < 0 || y < 0 || x + 1 >= image.cols || y + 1 >= image.rows) return 0.0F;
  const float fx = static_cast<float>(pixel.x() - x), fy = static_cast<float>(pixel.y() - y);
  const float *a = image.ptr<float>(y) + x, *b = image.ptr<float>(y + 1) + x;
  return (1.0F - fy) * ((1.0F - fx) * a[0] + fx * a[1]) + fy * ((1.0F - fx) * b[0] + fx * b[1]);
}

cv::Mat blurred(const cv::Mat& image, double sigma_px) {
  cv::Mat out;
  cv::GaussianBlur(image, out, {}, sigma_px);
  return out;
}

std::array<cv::Mat, 2> gradient(const cv::Mat& image) {
  cv::Mat dx, dy;
  cv::Sobel(image, dx, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(image, dy, CV_32F, 0, 1, 3, 0.125);
  return {dx, dy};
}

SE3 align(const CameraModel& camera, const SE3& start, bool held, const Rows& rows_at) {
  Vector6d prior = Vector6d::Constant(1.0 / square(kPriorAngle));
  prior.head<3>().setConstant(1.0 / square(kPriorDistance_m));
  SE3 T = start;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const std::vector<Row> rows = rows_at(T);
    std::vector<double> sizes;
    for (const Row& row : rows) sizes.push_back(std::abs(row.r));
    const double sigma = std::max(1e-3, 1.4826 * median(sizes));
    const SE3 off = start * T.inverse();
    Vector6d b;
    b << off.translation(), so3::log(off.rotation());
    b = prior.cwiseProduct(b);
    Matrix6d H = prior.asDiagonal();
    for (const Row& row : rows) {
      const double w = 1.0 / row.p.z(), fx = camera.fx() * w, fy = camera.fy() * w;
      const Eigen::Vector3d by_point(row.g.x() * fx, row.g.y() * fy,
                                     -w * (row.g.x() * fx * row.p.x() + row.g.y() * fy * row.p.y()));
      Vector6d J;
      J << by_point, row.p.cross(by_point);
      const double weight = row.weight / (square(sigma) + square(0.5 * row.r));
      H += weight * J * J.transpose();
      b += weight * row.r * J;
    }
    if (held) b.tail<3>().setZero(), H.topRightCorner<3, 3>().setZero(), H.bottomLeftCorner<3, 3>().setZero();
    const Vector6d step = H.ldlt().solve(b);
    T = SE3(so3::exp(step.tail<3>()), step.head<3>()) * T;
    if (iteration > 3 && step.tail<3>().norm() < 2e-6 && step.head<3>().norm() < 5e-6) break;
  }
  return T;
}

std::vector<Ridge> ridges(const cv::Mat& picture, double least, int border_px) {
  const auto [dx, dy] = gradient(picture);
  const cv::Mat xx = blurred(dx.mul(dx), 1.5), xy = blurred(dx.mul(dy), 1.5), yy = blurred(dy.mul(dy), 1.5);
  std::vector<Ridge> found;
  for (int y = border_px; y < picture.rows - border_px; ++y) {
    for (int x = border_px; x < picture.cols - border_px; ++x) {
      const double a = xx.at<float>(y, x), b = 2.0 * xy.at<float>(y, x), c = yy.at<float>(y, x);
      if (std::hypot(a - c, b) < 0.3 * (a + c)) continue;  // no line
      const double angle = 0.5 * std::atan2(b, a - c);
      const Eigen::Vector2d pixel(x, y), normal(std::cos(angle), std::sin(angle));
      const double here = picture.at<float>(y, x), before = at(picture, pixel - normal),
                   after = at(picture, pixel + normal);
      if (here < least || here < before || here <= after) continue;
      found.push_back({pixel + 0.5 * (before - after) / (before - 2.0 * here + after) * normal, normal, here});
    }
  }
  return found;
}

std::optional<Peak> find_peak(const cv::Mat& picture, const Eigen::Vector2d& pixel, const Eigen::Vector2d& direction,
                              double reach_px, double sign, double least) {
  const int steps = static_cast<int>(reach_px / kStep_px);
  std::optional<Peak> peak;
  double before_last = 0.0, last = 0.0;
  for (int k = -steps - 1; k <= steps + 1; ++k) {
    const double value = sign * at(picture, pixel + k * kStep_px * direction);
    if (k > -steps && last > (peak ? peak->height : least) && last >= before_last && last > value)
      peak = {(k - 1 + 0.5 * (before_last - value) / (before_last - 2.0 * last + value)) * kStep_px, last};
    before_last = last, last = value;
  }
  return peak;
}

}  // namespace edged
