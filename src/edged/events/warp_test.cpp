// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The fast warp against the same motion computed event by event in double precision.
#include "edged/events/warp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "edged/core/check.hpp"
#include "edged/events/test_support.hpp"

namespace edged {
namespace {

constexpr double kPi = 3.14159265358979323846;
const CameraModel kPinhole(240, 180, 200.0, 198.0, 121.0, 88.5);
const CameraModel kDavis(240, 180, 199.4, 199.7, 133.8, 114.0, DistortionModel::RadTan,
                         {-0.3829, 0.18934, -0.001, -0.00056, 0.0});

Timestamp at_ms(double ms) { return timestamp_from_seconds(1e-3 * ms); }

std::vector<Event> random_events(std::size_t n, Timestamp first, Timestamp last, const CameraModel& camera) {
  std::mt19937_64 random(7);
  std::vector<Event> events(n);
  for (std::size_t i = 0; i < n; ++i) {
    events[i].t = first + (last - first) * static_cast<std::int64_t>(i) / static_cast<std::int64_t>(n - 1);
    events[i].x = static_cast<std::uint16_t>(uniform(random, 0, camera.width()));
    events[i].y = static_cast<std::uint16_t>(uniform(random, 0, camera.height()));
  }
  return events;
}

CameraMotion constant_twist(const Vector6d& per_s, Timestamp first, Timestamp last, int knots) {
  CameraMotion motion;
  for (int k = 0; k < knots; ++k) {
    const Timestamp t = first + (last - first) * k / (knots - 1);
    motion.knots.push_back({t, SE3::exp(to_seconds(t - last) * per_s)});
  }
  return motion;
}

std::vector<Eigen::Vector2d> warp_all(const std::vector<Event>& events, const UndistortTable& table,
                                      const CameraMotion& motion, const WarpSettings& settings) {
  const EventWarp warp(table.ideal(), motion, settings, events.front().t, events.back().t);
  std::vector<Eigen::Vector2d> warped;
  warp.for_each(events, table, [&](float x, float y, bool) { warped.emplace_back(x, y); });
  return warped;
}

/// Largest distance [px] between the fast warp and pi(K', T_ref_t * Z * K'^-1 x) in double precision.
double largest_error(const std::vector<Event>& events, const UndistortTable& table, const CameraMotion& motion,
                     const WarpSettings& settings) {
  const std::vector<Eigen::Vector2d> warped = warp_all(events, table, motion, settings);
  EXPECT_EQ(warped.size(), events.size());
  if (warped.size() != events.size()) return std::numeric_limits<double>::infinity();
  double error = 0.0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const Eigen::Vector2d pixel = table.at(events[i].x, events[i].y).cast<double>();
    const Eigen::Vector3d p_t = settings.depth * table.ideal().pixel_to_point(pixel).homogeneous();
    const auto exact = table.ideal().project(motion.at(events[i].t, settings.interpolation) * p_t);
    EXPECT_TRUE(exact.has_value());
    if (exact) error = std::max(error, (warped[i] - *exact).norm());
  }
  return error;
}

/// A shaken camera: 200 Hz knots over 60 ms, up to 15 rad/s and 300 rad/s^2, 3 m/s.
CameraMotion shaken(Timestamp reference) {
  const auto pose = [](double s) {
    const Eigen::Vector3d phi(0.5 * std::sin(20 * s), 0.6 * std::sin(22 * s + 1), 0.7 * std::sin(21 * s + 2));
    return SE3(so3::exp(phi),
               Eigen::Vector3d(0.15 * std::sin(18 * s), 0.1 * std::cos(20 * s), 0.12 * std::sin(15 * s)));
  };
  const SE3 T_ref_W = pose(to_seconds(reference)).inverse();
  CameraMotion motion;
  for (int k = 0; k <= 12; ++k) motion.knots.push_back({at_ms(5 * k), T_ref_W * pose(5e-3 * k)});
  return motion;
}

TEST(EventWarp, IsWithinTwoHundredthsOfAPixelOfTheExactWarp) {
  const UndistortTable table(kDavis, ideal_pinhole(kDavis));
  const CameraMotion motion = shaken(at_ms(60));
  const std::vector<Event> events = random_events(20000, at_ms(0), at_ms(60), kDavis);
  double largest = 0.0;
  for (const auto interpolation : {WarpInterpolation::Piecewise, WarpInterpolation::SingleTwist}) {
    for (const double depth : {0.7, 2.0, 20.0}) {
      const double error = largest_error(events, table, motion, {interpolation, depth});
      largest = std::max(largest, error);
      EXPECT_LT(error, 0.02) << "depth " << depth;
    }
  }
  RecordProperty("largest_error_px", std::to_string(largest));
}

TEST(EventWarp, HoldsForEachDirectionOfMotion) {
  const UndistortTable table(kPinhole, kPinhole);
  const std::vector<Event> events = random_events(3000, at_ms(0), at_ms(30), kPinhole);
  for (const Vector6d& per_s : {twist(2, 0, 0, 0, 0, 0), twist(0, 2, 0, 0, 0, 0), twist(0, 0, 3, 0, 0, 0),
                                twist(0, 0, 0, 10, 0, 0), twist(0, 0, 0, 0, 10, 0), twist(0, 0, 0, 0, 0, 20)}) {
    const CameraMotion motion = constant_twist(per_s, at_ms(0), at_ms(30), 31);
    EXPECT_LT(largest_error(events, table, motion, {WarpInterpolation::Piecewise, 1.5}), 0.02) << per_s.transpose();
  }
}

// In these the reference is 20 ms after the event; the camera moves by the twist over 20 ms.
Eigen::Vector2d warp_pixel(int x, int y, const Vector6d& per_s, double depth) {
  const UndistortTable table(kPinhole, kPinhole);
  std::vector<Event> event(1);
  event[0] = {at_ms(0), static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), true};
  const std::vector<Eigen::Vector2d> warped =
      warp_all(event, table, constant_twist(per_s, at_ms(0), at_ms(20), 2), {WarpInterpolation::Piecewise, depth});
  EXPECT_EQ(warped.size(), 1U);
  return warped.empty() ? Eigen::Vector2d::Constant(-1e9) : warped.front();
}

TEST(EventWarp, ShiftsAllPixelsAlikeWhenTheCameraMovesSideways) {
  // The camera goes 1 m/s to its right for 20 ms: points at 2 m appear f * 0.02 / 2 further left.
  EXPECT_LT((warp_pixel(50, 60, twist(1, 0, 0, 0, 0, 0), 2.0) - Eigen::Vector2d(48, 60)).norm(), 1e-3);
  EXPECT_LT((warp_pixel(200, 100, twist(1, 0, 0, 0, 0, 0), 2.0) - Eigen::Vector2d(198, 100)).norm(), 1e-3);
}

TEST(EventWarp, SpreadsPixelsFromTheCentreWhenTheCameraMovesForward) {
  // 2.5 m/s for 20 ms towards a plane at 1 m: everything grows by 1 / 0.95 about the principal point.
  const Eigen::Vector2d centre(kPinhole.cx(), kPinhole.cy());
  const Eigen::Vector2d expected = centre + (Eigen::Vector2d(30, 20) - centre) / 0.95;
  EXPECT_LT((warp_pixel(30, 20, twist(0, 0, 2.5, 0, 0, 0), 1.0) - expected).norm(), 1e-3);
}

TEST(EventWarp, YawMovesPixelsByTheTangentWhateverTheDepth) {
  const double angle = 0.02 * 8.0;  // about y: the optical axis turns to the right, points go left
  const double azimuth = std::atan2(180 - kPinhole.cx(), kPinhole.fx());
  const double expected_x = kPinhole.cx() + kPinhole.fx() * std::tan(azimuth - angle);
  for (const double depth : {0.5, 50.0}) {
    EXPECT_NEAR(warp_pixel(180, 90, twist(0, 0, 0, 0, 8, 0), depth).x(), expected_x, 1e-3);
  }
}

TEST(EventWarp, RollTurnsPixelsAboutThePrincipalPoint) {
  const CameraModel square(240, 180, 200.0, 200.0, 120.0, 90.0);
  const UndistortTable table(square, square);
  std::vector<Event> event(1);
  event[0] = {at_ms(0), 170, 90, true};
  const double quarter_turn_per_s = 0.5 * kPi / 0.02;
  const CameraMotion motion = constant_twist(twist(0, 0, 0, 0, 0, quarter_turn_per_s), at_ms(0), at_ms(20), 2);
  const auto warped = warp_all(event, table, motion, {});
  ASSERT_EQ(warped.size(), 1U);
  EXPECT_LT((warped[0] - Eigen::Vector2d(120, 40)).norm(), 1e-3);  // the scene turns against the camera
}

TEST(EventWarp, PiecewiseEqualsOneTwistWhenTheTwistIsConstant) {
  const UndistortTable table(kPinhole, kPinhole);
  const std::vector<Event> events = random_events(2000, at_ms(-10), at_ms(25), kPinhole);
  const CameraMotion motion = constant_twist(twist(0.5, -0.3, 1, 2, -3, 5), at_ms(0), at_ms(20), 21);
  const auto single = warp_all(events, table, motion, {WarpInterpolation::SingleTwist, 1.2});
  const auto piecewise = warp_all(events, table, motion, {WarpInterpolation::Piecewise, 1.2});
  ASSERT_EQ(single.size(), piecewise.size());
  for (std::size_t i = 0; i < single.size(); ++i) EXPECT_LT((single[i] - piecewise[i]).norm(), 5e-3);
}

TEST(EventWarp, GoesOnWithTheNearestTwistOutsideTheKnots) {
  const Vector6d per_s = twist(0.4, 0.2, -0.6, 1, -2, 3);
  const CameraMotion inner = constant_twist(per_s, at_ms(10), at_ms(20), 11);
  for (const double ms : {0.0, 5.0, 25.0, 40.0}) {
    const SE3 expected = SE3::exp((ms - 20) * 1e-3 * per_s);
    EXPECT_LT((inner.at(at_ms(ms), WarpInterpolation::Piecewise).inverse() * expected).log().norm(), 1e-9);
    EXPECT_LT((inner.at(at_ms(ms), WarpInterpolation::SingleTwist).inverse() * expected).log().norm(), 1e-9);
  }
}

TEST(EventWarp, PassesExactlyThroughItsKnots) {
  const CameraMotion motion = shaken(at_ms(60));
  for (const MotionKnot& knot : motion.knots) {
    EXPECT_LT((motion.at(knot.t, WarpInterpolation::Piecewise).inverse() * knot.T_ref_t).log().norm(), 1e-12);
  }
}

TEST(EventWarp, MovesEveryEventAtItsOwnDepth) {
  const Timestamp first = at_ms(100), last = at_ms(130);
  const std::vector<Event> events = random_events(2000, first, last, kDavis);
  const UndistortTable table(kDavis, ideal_pinhole(kDavis));
  const CameraMotion motion = constant_twist(twist(0.8, -0.5, 0.6, 1.0, -2.0, 1.5), first, last, 31);
  const std::vector<DepthSample> samples = {{{30, 40}, 0.8}, {{200, 60}, 3.0}, {{120, 150}, 1.5}};
  const DepthGrid depths(240, 180, {8, 1000.0}, samples, 2.0);
  const EventWarp warp(table.ideal(), motion, {WarpInterpolation::Piecewise, 2.0}, first, last);
  std::vector<Eigen::Vector2d> warped;
  warp.for_each(events, table, depths, [&](float x, float y, bool) { warped.emplace_back(x, y); });
  ASSERT_EQ(warped.size(), events.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    const Eigen::Vector2f p = table.at(events[i].x, events[i].y);
    const double depth = 1.0 / depths.inverse_depth(p.x(), p.y());
    const Eigen::Vector3d p_t = depth * table.ideal().pixel_to_point(p.cast<double>()).homogeneous();
    const auto exact = table.ideal().project(motion.at(events[i].t, WarpInterpolation::Piecewise) * p_t);
    ASSERT_TRUE(exact.has_value());
    EXPECT_LT((warped[i] - *exact).norm(), 0.02);
  }
}

TEST(EventWarp, LeavesAnEventAtTheReferenceTimeWhereItIs) {
  const UndistortTable table(kDavis, ideal_pinhole(kDavis));
  const std::vector<Event> event{{at_ms(60), 33, 44, false}};
  const auto warped = warp_all(event, table, shaken(at_ms(60)), {});
  ASSERT_EQ(warped.size(), 1U);
  EXPECT_LT((warped[0] - table.at(33, 44).cast<double>()).norm(), 1e-4);
}

TEST(EventWarp, OnlyUndistortsWithoutMotion) {
  const UndistortTable table(kDavis, ideal_pinhole(kDavis));
  const std::vector<Event> events = random_events(500, at_ms(0), at_ms(30), kDavis);
  for (const CameraMotion& motion : {CameraMotion(), shaken(at_ms(60))}) {
    const auto warped = warp_all(events, table, motion, {WarpInterpolation::None, 1.0});
    ASSERT_EQ(warped.size(), events.size());
    for (std::size_t i = 0; i < events.size(); ++i) {
      EXPECT_LT((warped[i] - table.at(events[i].x, events[i].y).cast<double>()).norm(), 1e-4);
    }
  }
}

TEST(EventWarp, LeavesOutPointsBehindTheCameraAndPixelsOutsideTheSensor) {
  const UndistortTable table(kPinhole, kPinhole);
  const CameraMotion passing = constant_twist(twist(0, 0, 100, 0, 0, 0), at_ms(0), at_ms(20), 2);
  const std::vector<Event> events{{at_ms(0), 10, 10, true}, {at_ms(19.9), 10, 10, true}};
  EXPECT_EQ(warp_all(events, table, passing, {WarpInterpolation::Piecewise, 1.0}).size(), 1U);
  const std::vector<Event> outside{{at_ms(0), 240, 10, true}, {at_ms(1), 10, 60000, true}};
  EXPECT_TRUE(warp_all(outside, table, CameraMotion(), {}).empty());
}

TEST(EventWarp, RefusesKnotsOutOfOrderAndADepthOfZero) {
  CameraMotion motion = shaken(at_ms(60));
  std::swap(motion.knots[3], motion.knots[4]);
  EXPECT_THROW(motion.at(at_ms(1), WarpInterpolation::Piecewise), CheckError);
  EXPECT_THROW(EventWarp(kPinhole, {}, {WarpInterpolation::None, 0.0}, at_ms(0), at_ms(1)), CheckError);
}

TEST(CameraMotionTest, SeesBodyPosesThroughTheExtrinsics) {
  const SE3 T_B_C(so3::exp({0.1, -0.2, 1.5}), {0.05, -0.02, 0.1});
  const SE3 T_W_B0(so3::exp({0.4, 0.1, 0.2}), {1, 2, 3});
  const SE3 T_W_B1(so3::exp({0.5, 0.1, 0.1}), {1.1, 2, 3.1});
  const std::vector<StampedPose> poses{{at_ms(0), T_W_B0}, {at_ms(10), T_W_B1}};
  const CameraMotion motion = camera_motion(poses, T_W_B1, T_B_C);
  ASSERT_EQ(motion.knots.size(), 2U);
  const Eigen::Vector3d p_C0(0.3, -0.1, 2.0);
  const Eigen::Vector3d p_W = T_W_B0 * (T_B_C * p_C0);
  const Eigen::Vector3d p_C1 = T_B_C.inverse() * (T_W_B1.inverse() * p_W);
  EXPECT_LT((motion.knots[0].T_ref_t * p_C0 - p_C1).norm(), 1e-12);
  EXPECT_LT(motion.knots[1].T_ref_t.log().norm(), 1e-12);
}

TEST(CameraMotionTest, ReadsPosesOnTheClockOfTheEvents) {
  const SE3 T_W_B0(so3::exp({0.4, 0.1, 0.2}), {1, 2, 3});
  const SE3 T_W_B1(so3::exp({0.5, 0.1, 0.1}), {1.1, 2, 3.1});
  const std::vector<StampedPose> poses{{at_ms(10), T_W_B0}, {at_ms(20), T_W_B1}};
  const Duration offset = std::chrono::milliseconds(4);
  const CameraMotion motion = camera_motion(poses, T_W_B1, SE3(), offset);
  const SE3 T_ref_t = T_W_B1.inverse() * T_W_B0;
  EXPECT_LT((motion.at(at_ms(6), WarpInterpolation::Piecewise).inverse() * T_ref_t).log().norm(), 1e-12);
  EXPECT_LT(motion.at(at_ms(16), WarpInterpolation::Piecewise).log().norm(), 1e-12);
}

}  // namespace
}  // namespace edged
