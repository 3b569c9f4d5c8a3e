// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/trackers/descriptor_tracker.hpp"

#include <gtest/gtest.h>

#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"
#include "edged/frontend/test_scene.hpp"

namespace edged {
namespace {

Timestamp image_stamp(int image) { return timestamp_from_ns(40'000'000LL * image); }

SE3 flown(int image) { return {so3::exp({0.002 * image, -0.003 * image, 0.004 * image}), {0.01 * image, 0, 0}}; }

class DescriptorTracking : public testing::Test {
 protected:
  DescriptorTracking() : tracker_("left", scene_.camera(), {}) {
    tracker_.track(scene_.image(flown(0)), image_stamp(0), std::nullopt);
    tracker_.detect(scene_.image(flown(0)), next_id_);
    tracker_.mark_keyframe();
  }

  /// Distances of the live tracks from where the first image has them [px].
  std::vector<double> errors(int image) const {
    std::vector<double> all;
    for (const Track& track : tracker_.tracks())
      all.push_back((*scene_.moved(track.keyframe_pixel, flown(0), flown(image)) - track.pixel).norm());
    return all;
  }

  PlaneScene scene_{davis_like_pinhole(), 2.0};
  DescriptorTracker tracker_;
  FeatureId next_id_ = 1;
};

TEST_F(DescriptorTracking, FollowsCornersToAPixelWithoutDrift) {
  const std::size_t before = tracker_.tracks().size();
  EXPECT_GT(before, 70U);
  for (int image = 1; image <= 10; ++image) {
    const TrackPrediction prediction{flown(image).inverse() * flown(image - 1), 2.0, {}};
    const TrackSummary summary = tracker_.track(scene_.image(flown(image)), image_stamp(image), prediction);
    EXPECT_GT(summary.tracked, 0.9 * summary.before) << image;  // 0.99
    EXPECT_LT(summary.median_innovation_px.norm(), 0.5) << image;
    EXPECT_LT(median(errors(image)), 0.8) << image;  // 0.57: two roundings to whole pixels
  }
  EXPECT_GT(tracker_.tracks().size(), before / 2);
}

TEST_F(DescriptorTracking, SearchesFartherWithoutAPrediction) {
  const SE3 T_W_C(so3::exp({0.0, 0.07, 0.0}), Eigen::Vector3d::Zero());  // 14 px
  const TrackSummary summary = tracker_.track(scene_.image(T_W_C), image_stamp(1), std::nullopt);
  EXPECT_GT(summary.tracked, 0.5 * summary.before);
}

TEST_F(DescriptorTracking, FindsLittleInAnotherScene) {
  const TrackSummary summary = tracker_.track(random_texture(240, 180, 99), image_stamp(1), std::nullopt);
  EXPECT_LT(summary.tracked, 0.2 * summary.before);
}

TEST_F(DescriptorTracking, FollowsAFeatureOfAnotherCameraUnderItsId) {
  const FeatureId other = 100'000;
  const Eigen::Vector2d pixel = tracker_.tracks().front().pixel;  // its track ends
  tracker_.add(other, pixel);
  const TrackPrediction prediction{flown(1).inverse() * flown(0), 2.0, {}};
  tracker_.track(scene_.image(flown(1)), image_stamp(1), prediction);
  EXPECT_NE(tracker_.find(other), nullptr);
}

TEST_F(DescriptorTracking, AnEmptyImageEndsAllTracksAndTheNextOneStartsAnew) {
  tracker_.track(cv::Mat(), image_stamp(1), std::nullopt);
  EXPECT_TRUE(tracker_.tracks().empty());
  tracker_.track(scene_.image(flown(0)), image_stamp(2), std::nullopt);
  EXPECT_GT(tracker_.detect(scene_.image(flown(0)), next_id_), 70);
}

TEST(DescriptorTracker, FindsNothingInImagesThatAreTinyOrFlat) {
  for (const int side : {2, 9, 24}) {
    DescriptorTracker tracker("tiny", CameraModel(side, side, 20, 20, side / 2.0, side / 2.0), {});
    FeatureId next_id = 1;
    for (int image = 0; image < 3; ++image) {
      tracker.track(cv::Mat(side, side, CV_8UC1, cv::Scalar(90)), image_stamp(image), std::nullopt);
      EXPECT_EQ(tracker.detect(cv::Mat(side, side, CV_8UC1, cv::Scalar(90)), next_id), 0);
    }
  }
}

}  // namespace
}  // namespace edged
