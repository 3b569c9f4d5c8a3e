// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/lens_agreement.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace edged {
namespace {

using ::testing::HasSubstr;

const LensCoefficients kCoefficients{-0.1, 0.02, 0.0, 0.0};

CameraModel lens(double focal_px, DistortionModel distortion = DistortionModel::RadTan) {
  return {240, 180, focal_px, focal_px, 119.5, 89.5, distortion, kCoefficients};
}

/// What is said of 8 s of a shaken camera with this calibration, whose lens is lens(200).
std::optional<std::string> better(const CameraModel& calibrated) {
  const CameraModel seen = lens(200.0);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> noise_px(0.0, 0.1);
  GyroIntegral gyro;
  std::vector<Eigen::Quaterniond> q{Eigen::Quaterniond::Identity()};
  for (int i = 0; i < 4000; ++i) {
    const double t = i * 0.002;
    const Eigen::Vector3d rate(0.8 * std::sin(3 * t), 0.6 * std::sin(4.1 * t + 1), 0.5 * std::cos(2.3 * t));
    gyro.add({timestamp_from_seconds(t), rate, {0, 0, 9.81}});
    q.push_back(q.back() * so3::exp(0.002 * rate));
  }
  std::vector<Turn> turns;
  for (std::size_t i = 500; i < 3500; i += 20) {
    const auto at = [](std::size_t k) { return timestamp_from_seconds(0.002 * static_cast<double>(k)); };
    const SE3 T_begin_end(q[i].conjugate() * q[i + 40], Eigen::Vector3d(0.02, 0.01, 0.0));
    turns.push_back({at(i), at(i + 40)});
    std::vector<Eigen::Vector2d> begin, end;
    const auto point = [&](const Eigen::Vector3d& p) -> Eigen::Vector2d {
      Eigen::Vector2d pixel = seen.distort_to_pixel(p.hnormalized());
      for (double& value : pixel) value += noise_px(random);
      return calibrated.pixel_to_point(pixel);
    };
    for (int k = 0; k < 40; ++k) {
      const Eigen::Vector3d p(uniform(random), 0.7 * uniform(random), 2.5 + 0.5 * uniform(random));
      begin.push_back(point(p));
      end.push_back(point(T_begin_end.inverse() * p));
      turns.back().rays.emplace_back(begin.back().homogeneous().normalized(), end.back().homogeneous().normalized());
    }
    turns.back().phi_C = so3::log(Eigen::Quaterniond(*rotation_between(begin, end)));
  }
  const RigCamera camera{"cam", Modality::Frames, calibrated, SE3(), Duration(0)};
  const auto agreement = compare_with_gyro(turns, gyro, Duration(0));
  return better_lens(camera, turns, gyro, agreement.value().unexplained);
}

TEST(LensAgreement, NamesAFocalLengthThatIsHalvedOrDoubled) {
  for (const double focal_px : {100.0, 400.0})
    EXPECT_THAT(better(lens(focal_px)).value_or("nothing"), HasSubstr("a focal length near 200 px fits, not"));
}

TEST(LensAgreement, NamesCoefficientsOfAnotherDistortion) {
  EXPECT_THAT(better(lens(200.0, DistortionModel::Equidistant)).value_or("nothing"),
              HasSubstr("its coefficients fit as radtan"));
}

TEST(LensAgreement, SaysNothingOfARightCalibrationNorOfASmallError) {
  for (const double focal_px : {200.0, 206.0}) EXPECT_EQ(better(lens(focal_px)).value_or("nothing"), "nothing");
}

}  // namespace
}  // namespace edged
