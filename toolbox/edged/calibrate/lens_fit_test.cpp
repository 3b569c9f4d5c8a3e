// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/lens_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "edged/calibrate/reprojection.hpp"
#include "edged/calibrate/rig_fit.hpp"
#include "edged/calibrate/test_views.hpp"
#include "edged/camera/lens_table.hpp"
#include "edged/estimator/factors/blocks.hpp"
#include "edged/input_error.hpp"

namespace edged {
namespace {

TEST(LensFit, FindsEveryLensWithoutAStart) {
  const TargetLayout layout = layout_of(usual_target(TargetKind::AprilGrid));
  for (const FreeLens& truth : lenses_of_the_tests()) {
    const TargetViews camera = views_through(truth, layout, 40, 0.05, 3);
    const LensFit fit = fit_lens(camera, layout, truth.distortion);
    EXPECT_NEAR(fit.sigma_px, 0.05, 0.01);
    // The two polynomials of a rational lens trade against each other without a bound.
    for (int i = 0; i < truth.count() && truth.distortion != DistortionModel::Rational; ++i) {
      const auto k = static_cast<std::size_t>(i);
      EXPECT_LT(std::abs(fit.lens.values[k] - truth.values[k]), 4.5 * fit.sigmas[k])
          << to_string(truth.distortion) << " parameter " << i;
      EXPECT_GT(fit.sigmas[k], 0.0);
    }
    // Coefficients that trade against each other may be off together: what counts is where pixels go.
    EXPECT_LT(largest_difference_px(truth, fit.lens), 0.2) << to_string(truth.distortion);
  }
}

TEST(LensFit, BearsWithWrongCorners) {
  const TargetLayout layout = layout_of(usual_target(TargetKind::AprilGrid));
  const FreeLens truth = lenses_of_the_tests()[1];
  TargetViews camera = views_through(truth, layout, 40, 0.05, 5);
  for (TargetView& view : camera.views)
    for (std::size_t i = 0; i < view.corners.size(); i += 20) view.corners[i].pixel += Eigen::Vector2d(4.0, -7.0);
  EXPECT_LT(largest_difference_px(truth, fit_lens(camera, layout, truth.distortion).lens), 0.3);
}

/// A fisheye lens of which radtan's polynomial misses the corners near the border.
FreeLens wide_lens() { return lenses_of_the_tests()[2]; }

TEST(LensFit, TakesTheModelThatExplainsTheViews) {
  const TargetLayout layout = layout_of(usual_target(TargetKind::AprilGrid));
  const LensFit wide = fit_best_lens(views_through(wide_lens(), layout, 30, 0.05, 3), layout);
  EXPECT_EQ(wide.lens.distortion, DistortionModel::Equidistant);
  EXPECT_NEAR(wide.rms_px, 0.05 * std::sqrt(2.0), 0.01);
  const FreeLens usual = lenses_of_the_tests()[1];
  EXPECT_EQ(fit_best_lens(views_through(usual, layout, 30, 0.05, 3), layout).lens.distortion, DistortionModel::RadTan);
}

// The focal length scatters between sets of views by what its sigma says, although radtan is the wrong model: by the
// noise of the corners alone the variance would be a third of that, or less.
TEST(RigFit, SigmasContainWhatTheModelOfTheLensMisses) {
  TargetSpec few = usual_target(TargetKind::AprilGrid);
  few.rows = few.columns = 4;
  const TargetLayout layout = layout_of(few);
  std::vector<double> focal;
  double variance = 0.0, by_noise = 0.0;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const TargetViews views = views_through(wide_lens(), layout, 16, 0.02, seed);
    const LensFit lens = fit_lens(views, layout, DistortionModel::RadTan);
    const RigFit fit = fit_rig({{views, lens}}, layout, {}, {});
    focal.push_back(fit.cameras[0].lens.values[0]);
    variance += std::pow(fit.cameras[0].lens_sigmas[0], 2) / 6.0;
    by_noise += std::pow(lens.sigmas[0], 2) / 6.0;
  }
  double mean = 0.0, scatter = 0.0;
  for (const double f : focal) mean += f / 6.0;
  for (const double f : focal) scatter += (f - mean) * (f - mean) / 5.0;
  EXPECT_LT(scatter, 4.0 * variance);
  EXPECT_GT(scatter, 0.1 * variance);
  EXPECT_GT(variance, 3.0 * by_noise);
}

TEST(LensFit, SaysWhatToRecord) {
  const TargetLayout layout = layout_of(usual_target(TargetKind::AprilGrid));
  TargetViews camera = views_through(lenses_of_the_tests()[0], layout, 5, 0.05, 3);
  camera.name = "cam7", camera.pictures = 99;
  try {
    fit_lens(camera, layout, DistortionModel::RadTan);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("camera cam7: the target is in 5 of 99 pictures"), std::string::npos)
        << e.what();
  }
}

TEST(Reprojection, HasTheDerivativesOfItsResiduals) {
  const TargetLayout layout = layout_of(usual_target(TargetKind::AprilGrid));
  for (const FreeLens& lens : lenses_of_the_tests()) {
    std::vector<SE3> T_C_T;
    const TargetViews camera = views_through(lens, layout, 12, 1.0, 11, &T_C_T);
    ASSERT_FALSE(T_C_T.empty()) << to_string(lens.distortion);
    const MovingReprojection cost(pairs_of(camera.views.front(), layout), lens.distortion, 0.7,
                                  {0.01, {0.3, -0.8, 0.5}, Eigen::Quaterniond(0.9, 0.1, -0.2, 0.3).normalized()});
    // A camera near the one that saw the views.
    const SE3 T_B_C(so3::exp({0.2, -0.1, 0.4}), {0.05, 0.02, -0.03});
    const SE3 T_W_T(so3::exp({0.01, -0.02, 0.0}) * Eigen::Quaterniond(0.9, 0.1, -0.2, 0.3).normalized(),
                    Eigen::Vector3d::Zero());
    PoseBlock body = to_block(T_W_T * T_C_T.front().inverse() * T_B_C.inverse()), mount = to_block(T_B_C);
    MotionBlock motion{0.4, -0.3, 0.2, 0.01, 0.02, -0.01, 0.0, 0.0, 0.0};
    double clock = 0.004, tilt[] = {0.01, -0.02};
    LensParameters values = lens.values;
    std::vector<double*> blocks{body.data(), motion.data(), mount.data(), &clock, tilt, values.data()};
    check_cost(cost, blocks, {BlockKind::Pose, BlockKind::Motion, BlockKind::Pose, BlockKind::LogScale}, lens.count());
  }
}

}  // namespace
}  // namespace edged
