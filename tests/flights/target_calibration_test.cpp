// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/rig_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "edged/calibrate/collector.hpp"
#include "edged/calibrate/test_views.hpp"
#include "edged/core/angles.hpp"
#include "edged/input_error.hpp"
#include "edged/sim/disturbance.hpp"
#include "edged/sim/motion/motion.hpp"
#include "edged/sim/simulator.hpp"

namespace edged {
namespace {

/// The corners as the simulated motion shows them, without pictures, and the samples of an ideal IMU with noise.
struct SimulatedViews {
  std::vector<TargetCamera> cameras;
  std::vector<ImuSample> imu;
  TargetLayout layout;
};

constexpr double kClock_s = 0.0137;

SE3 mount(std::size_t camera) {
  return SimulatorConfig::davis240c_extrinsics() *
         (camera == 0 ? SE3() : SE3(so3::exp({0.02, -0.05, 0.3}), {0.08, 0.01, -0.02}));
}

SimulatedViews simulated(std::size_t cameras, double length_s, double roll_deg = 50.0) {
  SimulatorConfig config = simulator_preset("calibration-target");
  config.motion.max_angle_deg = roll_deg;
  const ContinuousTrajectory motion = make_motion(config.motion, length_s + 0.5, config.T_B_C, 3);
  SimulatedViews out;
  out.layout = layout_of(usual_target(TargetKind::AprilGrid));
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    Eigen::Vector3d n;
    for (int i = 0; i < 3; ++i) n[i] = sigma * normal(generator);
    return n;
  };
  for (double t = 0.0; t < length_s; t += 0.004) {
    const Kinematics k = motion.at(t);
    const Eigen::Vector3d force = k.T_W_B.rotation().conjugate() * (k.a_W - kGravity_W);
    out.imu.push_back({timestamp_from_seconds(t + kClock_s),
                       k.omega_B + Eigen::Vector3d(0.01, -0.02, 0.005) + noise(1e-3),
                       force + Eigen::Vector3d(0.1, 0.05, -0.08) + noise(1e-2)});
  }
  // The board faces -x.
  Eigen::Matrix3d R_W_T;
  R_W_T << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  const SE3 T_W_T(R_W_T, Eigen::Vector3d(0.0, 0.0, 1.3) -
                             R_W_T * Eigen::Vector3d(0.5 * out.layout.width, 0.5 * out.layout.height, 0.0));
  for (std::size_t c = 0; c < cameras; ++c) {
    const FreeLens lens = lenses_of_the_tests()[c == 0 ? 1 : 6];
    TargetViews views{.name = "cam" + std::to_string(c), .width = kTestWidth, .height = kTestHeight, .views = {}};
    for (double t = 0.5; t < length_s - 0.1; t += 0.05) {
      const SE3 T_C_T = (motion.at(t).T_W_B * mount(c)).inverse() * T_W_T;
      TargetView view{timestamp_from_seconds(t), {}};
      for (std::size_t id = 0; id < out.layout.corners.size(); ++id) {
        const Eigen::Vector2d& p = out.layout.corners[id];
        const auto pixel = project_free(lens, T_C_T * Eigen::Vector3d(p.x(), p.y(), 0.0), nullptr, nullptr);
        const Eigen::Vector2d off = noise(0.05).head<2>();
        if (pixel && pixel->x() > 3 && pixel->y() > 3 && pixel->x() < kTestWidth - 4 && pixel->y() < kTestHeight - 4)
          view.corners.push_back({static_cast<int>(id), *pixel + off});
      }
      ++views.pictures;
      if (view.corners.size() >= 12) views.views.push_back(std::move(view));
    }
    LensFit fit = fit_lens(views, out.layout, lens.distortion, 60);
    out.cameras.push_back({std::move(views), std::move(fit)});
  }
  return out;
}

/// Rotation [deg] and distance [mm].
std::pair<double, double> apart(const SE3& a, const SE3& b) {
  return {so3::log(a.rotation().conjugate() * b.rotation()).norm() / kDegree,
          1e3 * (a.translation() - b.translation()).norm()};
}

TEST(RigFit, FindsPosesAndClocksOfTwoCamerasAgainstTheImu) {
  const SimulatedViews views = simulated(2, 14.0);
  ImuNoise noise;
  noise.gyro_noise = 1e-3 * std::sqrt(0.004), noise.accel_noise = 1e-2 * std::sqrt(0.004);
  noise.gyro_walk = 1e-6, noise.accel_walk = 1e-5;
  const RigFit fit = fit_rig(views.cameras, views.layout, views.imu, noise, {.most_states = 200});
  ASSERT_EQ(fit.cameras.size(), 2u);
  for (std::size_t c = 0; c < 2; ++c) {
    const auto [deg, mm] = apart(mount(c), fit.cameras[c].T_B_C);
    EXPECT_LT(deg, 0.05) << c;
    EXPECT_LT(mm, 2.0) << c;
    EXPECT_NEAR(fit.cameras[c].time_offset_s, kClock_s, 2e-4) << c;
    EXPECT_GT(fit.cameras[c].pose_sigmas.minCoeff(), 0.0);
    EXPECT_LT(mm, 4.5e3 * fit.cameras[c].pose_sigmas.head<3>().norm()) << c;
    EXPECT_LT(std::abs(fit.cameras[c].time_offset_s - kClock_s), 4.5 * fit.cameras[c].time_offset_sigma_s) << c;
  }
  EXPECT_TRUE(fit.bias_gyro.isApprox(Eigen::Vector3d(0.01, -0.02, 0.005), 0.05));
  EXPECT_GT(fit.imu_misfit, 0.1);
  EXPECT_LT(fit.imu_misfit, 1.0);
}

TEST(RigFit, FindsThePoseBetweenCamerasWithoutImu) {
  const SimulatedViews views = simulated(2, 8.0);
  const RigFit fit = fit_rig(views.cameras, views.layout, {}, {}, {.most_states = 120});
  const auto [deg, mm] = apart(mount(0).inverse() * mount(1), fit.cameras[1].T_B_C);
  EXPECT_FALSE(fit.has_imu);
  EXPECT_LT(deg, 0.02);
  EXPECT_LT(mm, 0.5);
}

TEST(RigFit, SaysAboutWhichAxisItHardlyTurned) {
  SimulatedViews views = simulated(1, 6.0, 0.5);
  for (std::size_t i = 0; i < views.cameras[0].views.views.size(); ++i) {
    // Turns of the camera about its optical axis alone are left.
    auto& T = views.cameras[0].lens.T_C_T[i];
    if (T) T = SE3(so3::exp({0.0, 0.0, 0.4 * std::sin(0.3 * static_cast<double>(i))}), T->translation());
  }
  try {
    fit_rig(views.cameras, views.layout, views.imu, {});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("camera cam0: it hardly rotated about its"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace edged
