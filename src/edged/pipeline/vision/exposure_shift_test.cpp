// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/vision/exposure_shift.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace edged {
namespace {

constexpr Duration kImagePeriod = std::chrono::milliseconds(40);
constexpr double kImagePeriod_s = 0.04;
constexpr double kFeatureDepth_m = 2.0, kFeatureSpeed = 0.3;  // of the features on the unit plane [1/s]

/// Twenty features that move along x, in images whose instants are late by a sine of the phase.
struct ShiftedImages {
  double cosine_s, sine_s;
  std::vector<Track> tracks = std::vector<Track>(20);
  TrackPrediction prediction = {};
  double before_s = 0.0;

  double true_shift_s(double phase) const { return cosine_s * std::cos(phase) + sine_s * std::sin(phase); }

  void show(int image, double phase) {
    const double now_s = image * kImagePeriod_s + true_shift_s(phase);
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      Track& track = tracks[i];
      track.id = i;
      track.age = image;
      const double y = 0.03 * static_cast<double>(i);
      track.previous_point = {kFeatureSpeed * before_s, y}, track.point = {kFeatureSpeed * now_s, y};
    }
    prediction.T_cur_prev = SE3(Eigen::Quaterniond::Identity(),
                                Eigen::Vector3d(kFeatureSpeed * kFeatureDepth_m * kImagePeriod_s, 0.0, 0.0));
    prediction.scene_depth = kFeatureDepth_m;
    prediction.depth = [](FeatureId) { return std::optional(kFeatureDepth_m); };
    before_s = now_s;
  }
};

TEST(ExposureShift, IsFoundFromTheFeaturesAndTakenOutOfTheirObservations) {
  ShiftedImages images{3e-4, -2e-4};
  ExposureShift shift;
  CameraObservations observations;
  for (int image = 0; image < 50; ++image) {
    const double phase = 1.1 * image;
    images.show(image, phase);
    shift.update(phase, kImagePeriod, images.tracks, images.prediction);
    if (image < 20) continue;
    EXPECT_NEAR(shift.seconds(), images.true_shift_s(phase), 3e-5);
    observations.features.clear();
    for (const Track& track : images.tracks) observations.features.push_back({track.id, track.point, 1e-3});
    shift.correct(observations, images.tracks);
    EXPECT_NEAR(observations.features.front().point.x(), kFeatureSpeed * image * kImagePeriod_s, 1e-5);
  }
}

TEST(ExposureShift, IsNoneWhereThePhaseIsTheSameInAllImages) {
  ShiftedImages images{3e-4, -2e-4};
  ExposureShift shift;
  for (int image = 0; image < 50; ++image) {
    images.show(image, 0.7);
    shift.update(0.7, kImagePeriod, images.tracks, images.prediction);
  }
  EXPECT_NEAR(shift.seconds(), 0.0, 1e-9) << "the time offset of the camera contains it";
}

TEST(ExposureShift, EndsWithTheFlicker) {
  ShiftedImages images{3e-4, -2e-4};
  ExposureShift shift;
  for (int image = 0; image < 50; ++image) {
    images.show(image, 1.1 * image);
    shift.update(1.1 * image, kImagePeriod, images.tracks, images.prediction);
  }
  EXPECT_NE(shift.seconds(), 0.0);
  shift.reset();
  EXPECT_EQ(shift.seconds(), 0.0);
}

}  // namespace
}  // namespace edged
