// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/rig.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <string>
#include <vector>

#include "edged/camera/lens_table.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::HasSubstr;

struct NamedCamera {
  std::string name;
  CameraModel model;
};

std::vector<NamedCamera> all_cameras() {
  return {
      {"pinhole", CameraModel(320, 240, 250, 260, 158.5, 121.25)},
      {"davis240c", CameraModel(240, 180, 199.3714, 199.7079, 133.7544, 113.9922, DistortionModel::RadTan,
                                {-0.382899, 0.189336, -0.0010025, -0.00056378, 0.0})},
      {"euroc_cam0", CameraModel(752, 480, 458.654, 457.296, 367.215, 248.375, DistortionModel::RadTan,
                                 {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0})},
      {"k3_and_pincushion",
       CameraModel(640, 480, 500, 505, 310, 250, DistortionModel::RadTan, {0.12, 0.05, 0.004, -0.006, 0.03})},
      {"mvsec_left", CameraModel(346, 260, 226.38018, 226.15003, 173.64708, 133.73271, DistortionModel::Equidistant,
                                 {-0.048031, 0.011331, -0.055378, 0.021501, 0.0})},
      {"rational", CameraModel(640, 480, 380, 381, 318, 243, DistortionModel::Rational,
                               {0.2, 0.01, 2e-4, -3e-4, 0.001, 0.5, 0.05, 0.002})},
      {"fov", CameraModel(752, 480, 400, 401, 370, 245, DistortionModel::FieldOfView, {0.92})},
      {"omni_of_vins", CameraModel(752, 480, 1877.3, 1871.4, 361.5, 248.3, DistortionModel::Omni,
                                   {3.06, 0.673, 7.05, -7.2e-4, 3.8e-4})},
      {"omni_without_distortion", CameraModel(346, 260, 300, 301, 170, 131, DistortionModel::Omni, {0.8})},
      {"ds", CameraModel(640, 480, 310, 311, 322, 239, DistortionModel::DoubleSphere, {-0.18, 0.59})},
      {"eucm", CameraModel(640, 480, 330, 331, 322, 239, DistortionModel::ExtendedUnified, {0.61, 1.08})},
      {"omni_equidistant",
       CameraModel(640, 480, 600, 601, 322, 239, DistortionModel::OmniEquidistant, {1.1, 0.05, -0.02, 0.01, -0.002})},
      {"fisheye_150_degrees",
       CameraModel(640, 480, 300, 301, 322, 239, DistortionModel::Equidistant, {0.01, -0.004, 0.002, -0.0003, 0.0})},
  };
}

/// The message of the InputError that making the camera throws, "" when it does not.
template <typename Make>
std::string refusal(Make make) {
  try {
    make();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

class EveryCamera : public testing::TestWithParam<NamedCamera> {};

TEST_P(EveryCamera, TakesEveryPixelToABearingAndBack) {
  const CameraModel& camera = GetParam().model;
  double worst = 0.0;
  for (int y = 0; y < camera.height(); ++y) {
    for (int x = 0; x < camera.width(); ++x) {
      const Vector2d pixel(x, y);
      const Vector2d point = camera.pixel_to_point(pixel);
      worst = std::max(worst, (camera.distort_to_pixel(point) - pixel).norm());
      const auto projected = camera.project(3.7 * point.homogeneous());
      ASSERT_TRUE(projected) << pixel.transpose();
      worst = std::max(worst, (*projected - pixel).norm());
    }
  }
  EXPECT_LT(worst, 1e-8);
}

TEST_P(EveryCamera, TakesEveryBearingToAPixelAndBack) {
  const CameraModel& camera = GetParam().model;
  const double reach = 0.9 * camera.pixel_to_point({0.0, 0.5 * camera.height()}).norm();
  for (double angle = 0.0; angle < 6.28; angle += 0.1) {
    for (double r = 0.0; r <= reach; r += 0.05 * reach) {
      const Vector2d point(r * std::cos(angle), r * std::sin(angle));
      EXPECT_LT((camera.pixel_to_point(camera.distort_to_pixel(point)) - point).norm(), 1e-10 * (1.0 + r * r));
    }
  }
}

TEST_P(EveryCamera, AgreesWithOpenCvOnProjection) {
  const CameraModel& camera = GetParam().model;
  if (camera.distortion() > DistortionModel::Rational) return;  // no model of OpenCV: lens_models_test.cpp
  const auto& k = camera.coefficients();
  const cv::Matx33d K(camera.fx(), 0, camera.cx(), 0, camera.fy(), camera.cy(), 0, 0, 1);
  std::vector<cv::Point3d> points;
  for (int y = 0; y < camera.height(); y += 20) {
    for (int x = 0; x < camera.width(); x += 20) {
      const Vector2d point = camera.pixel_to_point(Vector2d(x, y));
      points.emplace_back(point.x(), point.y(), 1.0);
    }
  }
  std::vector<cv::Point2d> pixels;
  const cv::Vec3d zero(0, 0, 0);
  if (camera.distortion() == DistortionModel::Equidistant) {
    cv::fisheye::projectPoints(points, pixels, zero, zero, K, cv::Vec4d(k[0], k[1], k[2], k[3]));
  } else {
    cv::projectPoints(points, zero, zero, K, std::vector<double>(k.begin(), k.end()), pixels);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto ours = camera.project({points[i].x, points[i].y, points[i].z});
    ASSERT_TRUE(ours);
    EXPECT_NEAR(ours->x(), pixels[i].x, 1e-9);
    EXPECT_NEAR(ours->y(), pixels[i].y, 1e-9);
  }
}

/// By the coefficients one by one, and by the axes of the plane.
TEST_P(EveryCamera, HasALensWithDerivativesOfItsFunctions) {
  const CameraModel& camera = GetParam().model;
  const LensModel& lens = lens_model(camera.distortion());
  const LensCoefficients& k = camera.coefficients();
  constexpr double kStep = 1e-6;
  for (const auto function : {lens.radius_of_angle, lens.radius_of_radius})
    for (double x = 0.05; function && x < 0.6; x += 0.05)
      EXPECT_NEAR(function(k, x).slope, (function(k, x + kStep).value - function(k, x - kStep).value) / (2 * kStep),
                  1e-8);
  for (const Vector2d& p : {Vector2d(0.3, -0.2), Vector2d(0.0, 0.0), Vector2d(-0.7, 0.5)}) {
    for (int axis = 0; axis < 2; ++axis) {
      const Vector2d step = kStep * Vector2d::Unit(axis);
      const Vector2d numeric = (distorted(lens, k, p + step).point - distorted(lens, k, p - step).point) / (2 * kStep);
      EXPECT_LT((distorted(lens, k, p).d_point.col(axis) - numeric).norm(), 1e-8);
    }
    for (std::size_t i = 0; i < lens.max_coefficients; ++i) {
      LensCoefficients more = k, less = k;
      more[i] += kStep, less[i] -= kStep;
      const Vector2d numeric = (distorted(lens, more, p).point - distorted(lens, less, p).point) / (2 * kStep);
      EXPECT_LT((lens.by_coefficients(k, p).col(static_cast<int>(i)) - numeric).norm(), 1e-8) << i;
    }
  }
}

TEST_P(EveryCamera, HasAMeanFocalLengthThatTurnsAnglesNearItsAxisIntoPixels) {
  const CameraModel& camera = GetParam().model;
  constexpr double kStep = 1e-5;
  const double x = (camera.distort_to_pixel({kStep, 0.0}) - camera.distort_to_pixel({-kStep, 0.0})).norm();
  const double y = (camera.distort_to_pixel({0.0, kStep}) - camera.distort_to_pixel({0.0, -kStep})).norm();
  EXPECT_NEAR(camera.mean_focal(), (x + y) / (4.0 * kStep), 1e-4);
}

TEST(LensTable, HasOneRowAModelThatEachOfItsNamesFinds) {
  for (const LensModel& lens : lens_models()) {
    EXPECT_EQ(&lens_model(lens.model), &lens);
    EXPECT_EQ(find_lens_model(lens.name), &lens);
    for (const std::string_view name : lens.aliases)
      EXPECT_TRUE(name.empty() || find_lens_model(name) == &lens) << name;
    EXPECT_TRUE(
        std::ranges::any_of(all_cameras(), [&](const NamedCamera& c) { return c.model.distortion() == lens.model; }))
        << lens.name << " has no camera in these tests";
  }
  EXPECT_EQ(find_lens_model(""), nullptr);
  EXPECT_EQ(lens_model_names(), "none, radtan, equidistant, rational, fov, omni, ds, eucm, omni-equidistant");
}

INSTANTIATE_TEST_SUITE_P(Models, EveryCamera, testing::ValuesIn(all_cameras()),
                         [](const auto& parameter) { return parameter.param.name; });

TEST(CameraModel, ProjectsNothingBehindOrInTheCamera) {
  const CameraModel camera(320, 240, 250, 260, 160, 120);
  EXPECT_FALSE(camera.project({0.1, 0.1, -1.0}));
  EXPECT_FALSE(camera.project({0.1, 0.1, 0.0}));
  EXPECT_FALSE(camera.project({0.1, 0.1, std::numeric_limits<double>::quiet_NaN()}));
  EXPECT_TRUE(camera.project({0.1, 0.1, 0.01}));
}

TEST(CameraModel, DoesNotFoldFarPointsBackIntoTheImage) {
  // The polynomial turns back at r^2 = 1 / 0.9: a point far to the side would land near the centre.
  const CameraModel camera(240, 180, 300, 300, 120, 90, DistortionModel::RadTan, {-0.3, 0.0, 0.0, 0.0, 0.0});
  const Vector2d far_point(1.75, 0.0);
  EXPECT_TRUE(camera.contains(camera.distort_to_pixel(far_point)));
  EXPECT_FALSE(camera.project(far_point.homogeneous()));
  EXPECT_TRUE(camera.project({1.0, 0.0, 1.0}));
}

TEST(CameraModel, UndistortsToTheBearingThisSideOfTheFold) {
  // The corners have a second solution, beyond the radius at which the polynomial turns back.
  const CameraModel camera(346, 260, 180, 180, 160, 140, DistortionModel::RadTan, {0.8, -0.5, 0.0, 0.0, 0.0});
  for (int y = 0; y < camera.height(); ++y) {
    EXPECT_LT(camera.pixel_to_point(Vector2d(0, y)).norm(), 1.0) << y;
    EXPECT_TRUE(camera.project(camera.pixel_to_point(Vector2d(0, y)).homogeneous())) << y;
  }
}

TEST(CameraModel, ContainsCountsTheBorder) {
  const CameraModel camera(320, 240, 250, 260, 160, 120);
  EXPECT_TRUE(camera.contains({0.0, 239.0}));
  EXPECT_FALSE(camera.contains({-0.001, 100.0}));
  EXPECT_FALSE(camera.contains({319.001, 100.0}));
  EXPECT_FALSE(camera.contains({4.9, 100.0}, 5.0));
}

/// TUM-VI's: 153 degrees across, 229 from corner to corner.
CameraModel tum_vi() {
  return {512,
          512,
          190.97847715128717,
          190.9733070521226,
          254.93170605935475,
          256.8974428996504,
          DistortionModel::Equidistant,
          {0.0034823894022493434, 0.0007150348452162257, -0.0020532361418706202, 0.00020293673591811182}};
}

TEST(CameraModel, ALensThatSeesBehindItselfIsUsedUpTo70Degrees) {
  const CameraModel camera = tum_vi();
  ASSERT_TRUE(camera.view_limit());
  const auto pixel_at = [&camera](double degrees, double turn) {
    const double theta = degrees * kDegree;
    return camera.distort_to_pixel(std::tan(theta) * Vector2d(std::cos(turn), std::sin(turn)));
  };
  for (double turn = 0.0; turn < 6.28; turn += 0.1) {
    const Vector2d inside = pixel_at(69.9, turn), outside = pixel_at(70.1, turn);
    EXPECT_TRUE(camera.contains(inside)) << turn;
    EXPECT_FALSE(camera.contains(inside, 2.0)) << turn;
    EXPECT_FALSE(camera.contains(outside)) << turn;
    EXPECT_LT((camera.distort_to_pixel(camera.pixel_to_point(inside)) - inside).norm(), 1e-9);
  }
  EXPECT_FALSE(camera.project({3.0, 0.0, 1.0}));
  EXPECT_EQ(CameraModel(640, 480, 300, 301, 322, 239, DistortionModel::Equidistant).view_limit(), std::nullopt);
}

TEST(CameraModel, ItsRaysReachBehindItAndAgreeWithTheUnitPlaneInFront) {
  const CameraModel camera = tum_vi();
  const Vector3d corner = camera.pixel_to_ray({0.0, 0.0});
  EXPECT_LT(corner.z(), 0.0);
  EXPECT_NEAR(std::acos(corner.z()) / kDegree, 114.9, 0.1);
  for (const Vector2d& pixel : {Vector2d(254, 257), Vector2d(300, 120), Vector2d(100, 300)}) {
    const Vector3d ray = camera.pixel_to_ray(pixel);
    EXPECT_NEAR(ray.norm(), 1.0, 1e-12);
    EXPECT_LT((ray.head<2>() / ray.z() - camera.pixel_to_point(pixel)).norm(), 1e-9);
  }
}

TEST(CameraModel, APixelStretchesOnTheUnitPlaneAsTheGeometricMeanOfItsSides) {
  const CameraModel camera(256, 256, 95.5, 95.5, 127, 128, DistortionModel::Equidistant);
  EXPECT_NEAR(camera.stretch(Vector2d::Zero()), 1.0, 1e-6);
  const double theta = 60 * kDegree;  // r = tan(theta): dr / dtheta = 4, r / theta = 1.65
  EXPECT_NEAR(camera.stretch({std::tan(theta), 0.0}), std::sqrt(4.0 * std::tan(theta) / theta), 1e-4);
  EXPECT_EQ(all_cameras().back().model.stretch({1.0, 1.0}), 1.0) << "an ordinary lens";
}

TEST(CameraModel, AnyLensCanBeUsedLessFar) {
  const CameraModel whole(320, 240, 250, 260, 160, 120), part = whole.within(20 * kDegree);
  EXPECT_TRUE(part.contains({160 + 90, 120}));
  EXPECT_FALSE(part.contains({160 + 92, 120}));
  EXPECT_TRUE(whole.contains({160 + 92, 120}));
  EXPECT_THAT(refusal([&] { whole.within(90 * kDegree); }), HasSubstr("below 86 degrees"));
}

TEST(CameraModel, RefusesWhatIsNoLensAndSaysWhy) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  using enum DistortionModel;
  struct Case {
    cv::Size size;
    double fx, fy, cx, cy;
    DistortionModel distortion;
    LensCoefficients k;
    std::vector<std::string> says;
  };
  const Case cases[] = {
      {{240, 180}, -199.5, 200, 120, 90, None, {}, {"-199.5"}},
      {{240, 180}, 200, 0, 120, 90, None, {}, {"fy 0"}},
      {{240, 180}, 200, kNaN, 120, 90, None, {}, {"nan"}},
      {{240, 0}, 200, 200, 120, 90, None, {}, {"240 x 0"}},
      // Strong coefficients such as these broke the new camera matrix of the reference implementation.
      {{346, 260}, 150, 150, 173, 130, RadTan, {-0.45}, {"-0.45", "not monotone"}},
      {{346, 260}, 226, 226, 173, 133, Equidistant, {-0.5}, {"not monotone"}},
      {{346, 260}, 150, 150, 173, 130, RadTan, {0, 0, 0.5}, {"no inverse", "0.5"}},  // tangential
      {{240, 180}, 200, 200, 120, 90, None, {-0.3}, {"-0.3"}},
      {{240, 180}, 200, 200, 120, 90, Equidistant, {0, 0, 0, 0, 0.7}, {"only k1 k2 k3 k4"}},
      {{240, 180}, 200, 200, 120, 90, RadTan, {0, kNaN}, {"coefficient 2 is nan"}},
  };
  for (const Case& c : cases) {
    const std::string message =
        refusal([&] { CameraModel(c.size.width, c.size.height, c.fx, c.fy, c.cx, c.cy, c.distortion, c.k); });
    for (const std::string& said : c.says) EXPECT_THAT(message, HasSubstr(said));
  }
}

TEST(Rig, FindsCamerasByNameAndListsThemOtherwise) {
  Rig rig;
  rig.name = "davis";
  rig.cameras.resize(2);
  rig.cameras[0].name = "events";
  rig.cameras[0].modality = Modality::Events;
  rig.cameras[1].name = "frames";
  EXPECT_EQ(&rig.camera("frames"), &rig.cameras[1]);
  EXPECT_EQ(rig.find(Modality::Events), &rig.cameras[0]);
  EXPECT_THAT(refusal([&] { static_cast<void>(rig.camera("dvs")); }),
              testing::AllOf(HasSubstr("dvs"), HasSubstr("events, frames")));
  rig.cameras.pop_back();
  EXPECT_EQ(rig.find(Modality::Frames), nullptr);
}

TEST(CameraModel, MaskedOneUsesOnlyWhatItsMaskLeaves) {
  const CameraModel whole(40, 30, 30, 30, 20, 15);
  std::vector<std::uint8_t> used(40 * 30, 255);
  for (int y = 20; y < 30; ++y) std::fill_n(used.begin() + y * 40, 40, std::uint8_t{0});
  const CameraModel masked = whole.masked(used);
  EXPECT_FALSE(whole.is_masked());
  EXPECT_TRUE(masked.is_masked());
  EXPECT_TRUE(masked.uses(39, 19) && !masked.uses(0, 20));
  EXPECT_TRUE(masked.contains({10, 19}));
  EXPECT_FALSE(masked.contains({10, 21}));
  EXPECT_TRUE(masked.contains({10, 15}, 4.0));
  EXPECT_FALSE(masked.contains({10, 17}, 4.0)) << "the border goes along the mask, too";
  EXPECT_TRUE(masked == whole.masked(used));
  EXPECT_FALSE(masked == whole);
}

TEST(CameraModel, RefusesAMaskOfAnotherSizeOrThatLeavesNothing) {
  const CameraModel whole(40, 30, 30, 30, 20, 15);
  EXPECT_THROW(whole.masked(std::vector<std::uint8_t>(40 * 29, 255)), InputError);
  EXPECT_THROW(whole.masked(std::vector<std::uint8_t>(40 * 30, 0)), InputError);
}

}  // namespace
}  // namespace edged
