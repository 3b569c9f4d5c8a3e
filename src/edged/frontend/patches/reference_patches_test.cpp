// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/patches/reference_patches.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "edged/frontend/test_scene.hpp"

namespace edged {
namespace {

class ReferencePatchesTest : public testing::Test {
 protected:
  /// A feature of the scene as seen from identity, and its reference patch.
  Track feature(const Eigen::Vector2d& pixel) {
    Track track;
    track.id = 7;
    track.pixel = pixel;
    track.point = scene_.camera().pixel_to_point(pixel);
    return track;
  }

  Eigen::Vector3d in_camera(const Track& track, const SE3& T_W_C) const {
    return T_W_C.inverse() * (scene_.depth() * track.point.homogeneous());
  }

  void take(const cv::Mat& image, const Track& track) { reference_patches_.extract({image, {}}, std::span(&track, 1)); }

  /// pixel: the feature is expected there.
  std::optional<Eigen::Vector2d> align(const Track& track, const cv::Mat& image, const Eigen::Vector2d& pixel,
                                       const SE3& T_W_C) const {
    return reference_patches_.align(track.id, {image, {}}, {pixel, pixel - track.pixel, in_camera(track, T_W_C)});
  }

  PlaneScene scene_{davis_like_pinhole(), 2.0};
  ReferencePatches reference_patches_{scene_.camera(), {.min_similarity = 0.7}};
};

TEST_F(ReferencePatchesTest, AreFoundWhereTheyAreAfterTurnsAndLightChanges) {
  const Track track = feature({130.4, 88.7});
  take(scene_.image(SE3()), track);
  const SE3 T_W_C(so3::exp(Eigen::Vector3d(0.02, -0.03, 0.5)), Eigen::Vector3d(0.1, 0.05, 0.3));
  reference_patches_.move(T_W_C.inverse());
  cv::Mat image;
  scene_.image(T_W_C).convertTo(image, CV_8U, 0.6, 40.0);
  const Eigen::Vector2d truth = *scene_.moved(track.pixel, SE3(), T_W_C);
  const Eigen::Vector2d flow = truth + Eigen::Vector2d(0.7, -0.5);
  const auto found = align(track, image, flow, T_W_C);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - truth).norm(), 0.1);
}

TEST_F(ReferencePatchesTest, StayUntilTheyNoLongerFit) {
  Track track = feature({130.4, 88.7});
  take(scene_.image(SE3()), track);
  // A patch that matches is kept, however wrong the track has become.
  const cv::Mat image = scene_.image(SE3());
  ASSERT_TRUE(align(track, image, track.pixel, SE3()));
  track.pixel += Eigen::Vector2d(0.8, 0.0);
  track.point = scene_.camera().pixel_to_point(track.pixel);
  take(image, track);
  EXPECT_LT((*align(track, image, track.pixel, SE3()) - Eigen::Vector2d(130.4, 88.7)).norm(), 0.1);
  // One that does not match is replaced.
  const cv::Mat other = random_texture(240, 180, 9);
  EXPECT_FALSE(align(track, other, track.pixel, SE3()));
  reference_patches_.set_fits(track.id, false);
  take(other, track);
  const auto again = align(track, other, track.pixel, SE3());
  ASSERT_TRUE(again);
  EXPECT_LT((*again - track.pixel).norm(), 0.1);
}

TEST_F(ReferencePatchesTest, AreForgottenWithTheirTracksAndNeverGuessed) {
  const Track track = feature({130.4, 88.7});
  const cv::Mat image = scene_.image(SE3());
  EXPECT_FALSE(align(track, image, track.pixel, SE3()));
  take(image, track);
  EXPECT_FALSE(reference_patches_.align(track.id, {image, {}}, {track.pixel, {0.0, 0.0}, {0.0, 0.0, -1.0}}));
  EXPECT_FALSE(align(track, image, {1.0, 1.0}, SE3()));
  take(image, {});
  EXPECT_FALSE(align(track, image, track.pixel, SE3()));
  // Near the border there is no room for a patch.
  const Track rim = feature({3.0, 3.0});
  take(image, rim);
  EXPECT_FALSE(align(rim, image, rim.pixel, SE3()));
}

TEST_F(ReferencePatchesTest, OnEventFramesAreWhatTheMotionShows) {
  const Eigen::Vector2d moved(2.0, 0.5);
  // The increments of the scene that moves; the event frame itself shows nothing.
  const auto view = [&](const SE3& T_W_C) {
    const cv::Mat image = scene_.image(T_W_C);
    cv::Mat right, down, increments;
    cv::Sobel(image, right, CV_32F, 1, 0, 3, 0.125);
    cv::Sobel(image, down, CV_32F, 0, 1, 3, 0.125);
    cv::Mat(-moved.x() * right - moved.y() * down).convertTo(increments, CV_8U, 2.0, 128.0);
    return PatchView{cv::Mat(image.size(), CV_8UC1, cv::Scalar(90)), {increments, 1.0}};
  };
  const Track track = feature({130.4, 88.7});
  reference_patches_.extract(view(SE3()), std::span(&track, 1));
  const FeatureMotion there{track.pixel, moved, in_camera(track, SE3())};
  EXPECT_FALSE(reference_patches_.align(track.id, view(SE3()), there));
  reference_patches_.update_gradient(track.id, view(SE3()), there, true);
  const SE3 T_W_C(so3::exp(Eigen::Vector3d(0.004, -0.01, 0.1)), Eigen::Vector3d(0.02, 0.0, 0.05));
  reference_patches_.move(T_W_C.inverse());
  const Eigen::Vector2d truth = *scene_.moved(track.pixel, SE3(), T_W_C);
  const auto found = reference_patches_.align(track.id, view(T_W_C),
                                              {truth + Eigen::Vector2d(0.4, -0.3), moved, in_camera(track, T_W_C)});
  ASSERT_TRUE(found);
  EXPECT_LT((*found - truth).norm(), 0.15);
}

TEST_F(ReferencePatchesTest, OfMuchOtherSizeAreNotComparedWith) {
  const Track track = feature({130.4, 88.7});
  take(scene_.image(SE3()), track);
  const SE3 near(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, 1.0));  // half the distance, twice the size
  reference_patches_.move(near.inverse());
  const Eigen::Vector2d truth = *scene_.moved(track.pixel, SE3(), near);
  EXPECT_FALSE(align(track, scene_.image(near), truth, near));
}

}  // namespace
}  // namespace edged
