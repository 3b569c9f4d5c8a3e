// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/trackers/klt_tracker.hpp"

#include <gtest/gtest.h>

#include <map>
#include <opencv2/core.hpp>

#include "edged/core/check.hpp"
#include "edged/frontend/test_scene.hpp"

namespace edged {
namespace {

Timestamp at(int image) { return timestamp_from_ns(40'000'000LL * image); }

SE3 pose(const Eigen::Vector3d& rotation, const Eigen::Vector3d& position) { return {so3::exp(rotation), position}; }

cv::Mat noisy(const cv::Mat& image, double sigma, cv::RNG& random) {
  cv::Mat noise(image.size(), CV_16S), sum;
  random.fill(noise, cv::RNG::NORMAL, 0, sigma);
  cv::add(image, noise, sum, cv::noArray(), CV_8U);
  return sum;
}

class Tracking : public testing::Test {
 protected:
  KltTracker start(const SE3& T_W_C, const TrackerConfig& config = {}) {
    KltTracker tracker("left", scene_.camera(), config);
    const cv::Mat image = scene_.image(T_W_C);
    tracker.track(image, at(0), std::nullopt);
    tracker.detect(image, next_id_);
    tracker.mark_keyframe();
    return tracker;
  }

  // Mean error of the live tracks, of where they were at the start [px].
  double mean_error(const FeatureTracker& tracker, const SE3& T_W_C0, const SE3& T_W_C) const {
    double sum = 0;
    for (const Track& track : tracker.tracks()) {
      sum += (*scene_.moved(track.keyframe_pixel, T_W_C0, T_W_C) - track.pixel).norm();
    }
    return sum / static_cast<double>(tracker.tracks().size());
  }

  PlaneScene scene_{davis_like_pinhole(), 2.0};
  FeatureId next_id_ = 1;
};

TEST(Tracker, FindsAndFollowsNothingOutsideOfWhatIsUsedOfTheLens) {
  const CameraModel camera = davis_like_pinhole().within(0.25);
  const PlaneScene scene(camera, 2.0);
  KltTracker tracker("left", camera, {});
  FeatureId next_id = 1;
  const SE3 moved = pose({0.0, 0.03, 0.0}, Eigen::Vector3d::Zero());
  for (int i = 0; i < 2; ++i) {
    const cv::Mat image = scene.image(i == 0 ? SE3() : moved);
    const TrackSummary summary = tracker.track(image, at(i), std::nullopt);
    EXPECT_EQ(summary.tracked < summary.before, i == 1) << "some have left it";
    tracker.detect(image, next_id);
    EXPECT_GT(tracker.tracks().size(), 10U);
    for (const Track& track : tracker.tracks()) EXPECT_TRUE(camera.contains(track.pixel, 2.0)) << track.pixel;
  }
}

TEST_F(Tracking, FollowsCornersToATenthOfAPixel) {
  const SE3 T_W_C1 = pose({0.01, -0.01, 0.02}, {0.03, 0.02, 0.02});
  KltTracker tracker = start(SE3());
  const auto before = tracker.tracks().size();
  EXPECT_GT(before, 70U);
  const TrackSummary summary = tracker.track(scene_.image(T_W_C1), at(1), std::nullopt);
  EXPECT_EQ(summary.before, static_cast<int>(before));
  EXPECT_EQ(summary.tracked, static_cast<int>(tracker.tracks().size()));
  EXPECT_GT(summary.tracked, 0.9 * summary.before);
  EXPECT_LT(mean_error(tracker, SE3(), T_W_C1), 0.1);
}

TEST_F(Tracking, DriftsLessThanHalfAPixelOverTwentyImages) {
  KltTracker tracker = start(SE3());
  SE3 T_W_C;
  for (int i = 1; i <= 20; ++i) {
    T_W_C = pose({0.002 * i, -0.003 * i, 0.004 * i}, {0.01 * i, 0.005 * i, 0.01 * i});
    tracker.track(scene_.image(T_W_C), at(i), std::nullopt);
  }
  EXPECT_GT(tracker.tracks().size(), 40U);
  EXPECT_EQ(tracker.tracks().front().age, 20);
  EXPECT_LT(mean_error(tracker, SE3(), T_W_C), 0.5);
}

TEST_F(Tracking, AlignedToTheirFirstLooksCornersDriftLessInNoise) {
  cv::RNG random(5);
  TrackerConfig config;
  double error[2];
  for (const bool enabled : {false, true}) {
    config.reference_patches.enabled = enabled;
    KltTracker tracker = start(SE3(), config);
    SE3 T_W_C;
    for (int i = 1; i <= 30; ++i) {
      const SE3 T_W_Cprev = T_W_C;
      T_W_C = pose({0, 0, 0.001 * i}, {0.008 * i, 0.004 * i, 0});
      const TrackPrediction prediction{T_W_C.inverse() * T_W_Cprev, 2.0, {}};
      tracker.track(noisy(scene_.image(T_W_C), 8.0, random), at(i), prediction);
    }
    EXPECT_GT(tracker.tracks().size(), 40U);
    error[enabled] = mean_error(tracker, SE3(), T_W_C);
  }
  EXPECT_LT(error[1], 0.6 * error[0]);
}

TEST_F(Tracking, PredictedSeedsFollowFortyPixelsWhereTheOldPositionsFail) {
  const SE3 T_W_C1 = pose({0.0, 0.2, 0.0}, {0.0, 0.0, 0.0});  // 40 px
  const cv::Mat image = scene_.image(T_W_C1);

  KltTracker unseeded = start(SE3());
  const double before = static_cast<double>(unseeded.tracks().size());
  unseeded.track(image, at(1), std::nullopt);
  EXPECT_LT(static_cast<double>(unseeded.tracks().size()), 0.4 * before);

  KltTracker seeded = start(SE3());
  const SE3 predicted = T_W_C1.inverse() * pose({0.005, 0.005, 0}, {0, 0, 0});  // 1.4 px off
  const TrackSummary summary = seeded.track(image, at(1), TrackPrediction{predicted, 2.0, {}});
  EXPECT_FALSE(summary.prediction_failed);
  EXPECT_GT(summary.tracked, 0.7 * before);  // the rest has left the image
  EXPECT_LT(mean_error(seeded, SE3(), T_W_C1), 0.2);
}

TEST_F(Tracking, UsesTheDepthOfEachCornerAndReportsTheInnovation) {
  const SE3 T_W_C1 = pose({0, 0, 0}, {0.2, 0, 0});  // 20 px at the true depth of 2 m, 10 px at 4 m
  const cv::Mat image = scene_.image(T_W_C1);
  KltTracker own = start(SE3());
  const auto depth = [](FeatureId) { return std::optional<double>(2.0); };
  EXPECT_LT(own.track(image, at(1), TrackPrediction{T_W_C1.inverse(), 4.0, depth}).median_innovation_px.norm(), 0.1);
  KltTracker common = start(SE3());
  const TrackSummary summary = common.track(image, at(1), TrackPrediction{T_W_C1.inverse(), 4.0, {}});
  EXPECT_NEAR(summary.median_innovation_px.x(), -10.0, 0.3);
  EXPECT_NEAR(summary.median_innovation_px.y(), 0.0, 0.1);
  KltTracker corrected = start(SE3());
  const TrackPrediction prediction{T_W_C1.inverse(), 4.0, {}, {-10.0, 0.0}};
  EXPECT_LT(corrected.track(image, at(1), prediction).median_innovation_px.norm(), 0.3);
}

TEST_F(Tracking, FallsBackToTheOldPositionsWhenThePredictionIsWrong) {
  const SE3 T_W_C1 = pose({0, 0, 0}, {0.01, 0, 0});
  for (const SE3& wrong : {pose({0.0, 0.35, 0.3}, {0, 0, 0}), pose({0, 3.1, 0}, {0, 0, 0})}) {
    KltTracker tracker = start(SE3());
    const TrackSummary summary = tracker.track(scene_.image(T_W_C1), at(1), TrackPrediction{wrong, 2.0, {}});
    EXPECT_TRUE(summary.prediction_failed);
    EXPECT_GT(summary.tracked, 0.9 * summary.before);
    EXPECT_LT(mean_error(tracker, SE3(), T_W_C1), 0.1);
  }
}

TEST_F(Tracking, SurvivesAGainChangeAndNoise) {
  const SE3 T_W_C1 = pose({0, 0, 0.01}, {0.02, 0, 0});
  cv::Mat image;
  cv::RNG random(5);
  scene_.image(T_W_C1).convertTo(image, CV_8U, 0.95, 3);
  KltTracker tracker = start(SE3());
  const TrackSummary summary = tracker.track(noisy(image, 4.0, random), at(1), std::nullopt);
  EXPECT_GT(summary.tracked, 0.85 * summary.before);
  EXPECT_LT(mean_error(tracker, SE3(), T_W_C1), 0.25);
}

TEST_F(Tracking, LosesEverythingInAnUnrelatedOrFlatImage) {
  TrackerConfig strict;  // the default leaves it to outlier rejection
  strict.min_correlation = 0.7;
  KltTracker tracker = start(SE3(), strict);
  const TrackSummary summary = tracker.track(random_texture(240, 180, 99), at(1), std::nullopt);
  EXPECT_LT(summary.tracked, 0.1 * summary.before);
  KltTracker flat = start(SE3());
  EXPECT_EQ(flat.track(cv::Mat(180, 240, CV_8UC1, cv::Scalar(90)), at(1), std::nullopt).tracked, 0);
  EXPECT_TRUE(flat.needs_detection());
  EXPECT_EQ(flat.track(scene_.image(SE3()), at(2), std::nullopt).tracked, 0);
}

TEST_F(Tracking, AnEmptyImageEndsAllTracksAndTheNextOneStartsAnew) {
  KltTracker tracker = start(SE3());
  EXPECT_EQ(tracker.track(cv::Mat(), at(1), std::nullopt).tracked, 0);
  EXPECT_TRUE(tracker.tracks().empty());
  EXPECT_EQ(tracker.detect(cv::Mat(), next_id_), 0);
  tracker.track(scene_.image(SE3()), at(2), std::nullopt);
  EXPECT_GT(tracker.detect(scene_.image(SE3()), next_id_), 70);
}

TEST_F(Tracking, RefusesAnImageThatDoesNotFitTheCamera) {
  KltTracker tracker = start(SE3());
  EXPECT_THROW(tracker.track(random_texture(346, 260), at(1), std::nullopt), InputError);
  EXPECT_THROW(tracker.track(cv::Mat(180, 240, CV_8UC3, cv::Scalar()), at(1), std::nullopt), InputError);
}

TEST_F(Tracking, WorksOnTinyImages) {
  for (const int side : {2, 9, 24}) {
    KltTracker tracker("tiny", CameraModel(side, side, 20, 20, side / 2.0, side / 2.0), {});
    for (int i = 0; i < 3; ++i) {
      tracker.track(random_texture(side, side), at(i), std::nullopt);
      tracker.detect(random_texture(side, side), next_id_);
    }
  }
}

TEST_F(Tracking, RefillsOnlyFreeCellsWithFreshIds) {
  KltTracker tracker = start(SE3());
  const FeatureId first_new = next_id_;
  const SE3 T_W_C1 = pose({0, 0.2, 0}, {0, 0, 0});
  const cv::Mat image = scene_.image(T_W_C1);
  tracker.track(image, at(1), TrackPrediction{T_W_C1.inverse(), 2.0, {}});
  const std::vector<Track> old = tracker.tracks();
  EXPECT_GT(tracker.detect(image, next_id_), 10);
  EXPECT_EQ(tracker.detect(image, next_id_), 0);
  for (const Track& track : tracker.tracks()) {
    if (track.id < first_new) continue;
    EXPECT_EQ(track.first_seen, at(1));
    EXPECT_FALSE(track.in_keyframe);
    for (const Track& o : old) {
      EXPECT_GT((o.pixel - track.pixel).norm(), 7.0);
      const bool same_cell = static_cast<int>((o.pixel.x() + 0.5) / 20) == static_cast<int>(track.pixel.x() / 20) &&
                             static_cast<int>((o.pixel.y() + 0.5) / 20) == static_cast<int>(track.pixel.y() / 20);
      EXPECT_FALSE(same_cell);
    }
  }
}

TEST_F(Tracking, ObservationsLieOnTheUnitPlaneOfTheDistortedCamera) {
  const CameraModel camera(240, 180, 200, 200, 119.5, 89.5, DistortionModel::RadTan, {-0.35, 0.12, 0, 0, 0});
  TrackerConfig config;
  config.sigma_px = 1.5;
  KltTracker tracker("left", camera, config);
  const cv::Mat image = random_texture(240, 180);
  tracker.track(image, at(0), std::nullopt);
  tracker.detect(image, next_id_);
  const CameraObservations seen = tracker.observations();
  EXPECT_EQ(seen.camera, "left");
  ASSERT_EQ(seen.features.size(), tracker.tracks().size());
  for (std::size_t i = 0; i < seen.features.size(); ++i) {
    EXPECT_EQ(seen.features[i].id, tracker.tracks()[i].id);
    EXPECT_NEAR((camera.distort_to_pixel(seen.features[i].point) - tracker.tracks()[i].pixel).norm(), 0.0, 1e-6);
    EXPECT_DOUBLE_EQ(seen.features[i].sigma, 1.5 / 200.0);
  }
}

TEST_F(Tracking, RejectsTracksThatMoveOnTheirOwnAndKeepsTheOthers) {
  // A patch of the picture slides against the rest.
  const SE3 T_W_C1 = pose({0, 0, 0.02}, {0.1, 0, 0.0});
  cv::Mat image = scene_.image(T_W_C1);
  const cv::Mat slid = scene_.image(pose({0, 0, 0.02}, {0.1, 0.06, 0}));  // 6 px across the epipolar lines
  const cv::Rect thing(150, 40, 70, 70);
  slid(thing).copyTo(image(thing));
  KltTracker tracker = start(SE3());
  tracker.track(image, at(1), std::nullopt);
  std::map<FeatureId, bool> right;
  for (const Track& track : tracker.tracks()) {
    right[track.id] = (*scene_.moved(track.keyframe_pixel, SE3(), T_W_C1) - track.pixel).norm() < 1.0;
  }
  const OutlierResult result = tracker.reject_outliers(FeatureTracker::Reference::Keyframe, T_W_C1.R());
  EXPECT_EQ(static_cast<std::size_t>(result.inliers), tracker.tracks().size());
  int kept_right = 0, kept_wrong = 0, all_right = 0, all_wrong = 0;
  for (const auto& [id, is_right] : right) (is_right ? all_right : all_wrong) += 1;
  for (const Track& track : tracker.tracks()) (right[track.id] ? kept_right : kept_wrong) += 1;
  EXPECT_GT(all_wrong, 5);
  EXPECT_GT(kept_right, 0.95 * all_right);
  EXPECT_LE(kept_wrong, 0.1 * all_wrong);
}

TEST_F(Tracking, PureRotationKillsNoTracksAndHasNoParallax) {
  KltTracker tracker = start(SE3());
  SE3 T_W_C;
  for (int i = 1; i <= 5; ++i) {
    T_W_C = pose({0.01 * i, 0.02 * i, 0.01 * i}, {0, 0, 0});
    tracker.track(scene_.image(T_W_C), at(i), std::nullopt);
  }
  const auto alive = tracker.tracks().size();
  const KeyframeTracks since = tracker.since_keyframe(T_W_C.R());
  EXPECT_EQ(static_cast<std::size_t>(since.alive()), alive);
  EXPECT_GT(since.at_keyframe, since.alive());
  const OutlierResult result = tracker.reject_outliers(FeatureTracker::Reference::Keyframe, T_W_C.R());
  EXPECT_EQ(result.model, OutlierModel::RotationOnly);
  EXPECT_EQ(tracker.tracks().size(), alive);
  tracker.reject_outliers(FeatureTracker::Reference::Previous, std::nullopt);
  EXPECT_EQ(tracker.tracks().size(), alive);
}

TEST_F(Tracking, RemovesTracksOnRequestAndMergesTheYoungerOfTwoThatMeet) {
  KltTracker tracker = start(SE3());
  const std::vector<FeatureId> ids{tracker.tracks()[3].id, 123456};
  const auto before = tracker.tracks().size();
  tracker.remove(ids);
  EXPECT_EQ(tracker.tracks().size(), before - 1);

  TrackerConfig config;
  config.merge_px = 30.0;  // wider than the grid: neighbours count as the same feature
  KltTracker wide = start(SE3(), config);
  const FeatureId oldest = wide.tracks().front().id;
  const TrackSummary summary = wide.track(scene_.image(SE3()), at(1), std::nullopt);
  EXPECT_GT(summary.before - summary.tracked, 20);
  EXPECT_EQ(wide.tracks().front().id, oldest);
}

TEST_F(Tracking, GivesTheSameBitsTwice) {
  const auto run = [&] {
    next_id_ = 1;
    KltTracker tracker = start(SE3());
    std::vector<double> all;
    for (int i = 1; i <= 10; ++i) {
      const SE3 T_W_C = pose({0.01 * i, 0.02 * i, 0}, {0.03 * i, 0, 0.02 * i});
      const cv::Mat image = scene_.image(T_W_C);
      tracker.track(image, at(i), std::nullopt);
      tracker.reject_outliers(FeatureTracker::Reference::Keyframe, T_W_C.R());
      if (i % 3 == 0) tracker.detect(image, next_id_), tracker.mark_keyframe();
      for (const FeatureObservation& o : tracker.observations().features) {
        all.insert(all.end(), {static_cast<double>(o.id), o.point.x(), o.point.y()});
      }
    }
    return all;
  };
  EXPECT_EQ(run(), run());
}

TEST(TrackerConfig, RefusesAnEvenWindow) {
  TrackerConfig config;
  config.klt.window_px = 20;
  EXPECT_THROW(KltTracker("left", davis_like_pinhole(), config), InputError);
}

TEST(Tracker, FindsAndFollowsNothingUnderTheMask) {
  const CameraModel whole = davis_like_pinhole();
  std::vector<std::uint8_t> used(static_cast<std::size_t>(whole.width() * whole.height()), 255);
  std::fill(used.begin(), used.begin() + static_cast<std::ptrdiff_t>(used.size() / 2), std::uint8_t{0});
  const CameraModel camera = whole.masked(used);
  const PlaneScene scene(camera, 2.0);
  KltTracker tracker("left", camera, {});
  FeatureId next_id = 1;
  for (int i = 0; i < 2; ++i) {
    const TrackSummary summary =
        tracker.track(scene.image(pose({0.0, 0.06 * i, 0.0}, Eigen::Vector3d::Zero())), at(i), std::nullopt);
    EXPECT_EQ(summary.tracked < summary.before, i == 1) << "some have gone under it";
    tracker.detect(scene.image(pose({0.0, 0.06 * i, 0.0}, Eigen::Vector3d::Zero())), next_id);
    EXPECT_GT(tracker.tracks().size(), 10U);
    for (const Track& track : tracker.tracks()) EXPECT_GT(track.pixel.y(), whole.height() / 2.0) << track.pixel;
  }
}

TEST_F(Tracking, FollowsAFeatureOfAnotherCameraUnderItsId) {
  KltTracker tracker = start(SE3());
  const std::size_t before = tracker.tracks().size();
  const Track own = tracker.tracks()[before / 2];
  const FeatureId other = 100'000;
  tracker.add(other, own.pixel + Eigen::Vector2d(0.4, 0.0));
  ASSERT_EQ(tracker.tracks().size(), before) << "it takes the place of the track there";
  EXPECT_EQ(tracker.find(own.id), nullptr);
  tracker.add(own.id, Eigen::Vector2d(5.0, 5.0));
  EXPECT_TRUE(std::ranges::is_sorted(tracker.tracks(), {}, &Track::id));
  EXPECT_THROW(tracker.add(other, {50.0, 50.0}), CheckError);
  tracker.mark_keyframe();
  const SE3 moved = pose({0.01, -0.01, 0.02}, {0.03, 0.02, 0.02});
  tracker.track(scene_.image(moved), at(1), std::nullopt);
  ASSERT_NE(tracker.find(other), nullptr);
  EXPECT_LT((tracker.find(other)->pixel - *scene_.moved(own.pixel + Eigen::Vector2d(0.4, 0.0), SE3(), moved)).norm(),
            0.2);
}

}  // namespace
}  // namespace edged
