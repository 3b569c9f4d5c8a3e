// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The tracker on real images: EuRoC MH_01, left camera.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "edged/core/test_data.hpp"
#include "edged/frontend/trackers/klt_tracker.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> euroc_images(std::size_t count) {
  const fs::path folder = data_folder() / "euroc_mh01/mav0/cam0/data";
  std::vector<fs::path> images;
  if (!fs::is_directory(folder)) return images;
  for (const auto& entry : fs::directory_iterator(folder)) images.push_back(entry.path());
  std::sort(images.begin(), images.end());
  images.resize(std::min(images.size(), count));
  return images;
}

TEST(EurocTracks, MostCornersSurviveFromImageToImage) {
  const std::vector<fs::path> images = euroc_images(60);
  if (images.empty()) GTEST_SKIP() << "no data";
  const CameraModel camera(752, 480, 458.654, 457.296, 367.215, 248.375, DistortionModel::RadTan,
                           {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0});
  KltTracker tracker("cam0", camera, {});
  FeatureId next_id = 1;
  int before = 0, after = 0;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const cv::Mat image = cv::imread(images[i].string(), cv::IMREAD_GRAYSCALE);
    const TrackSummary summary =
        tracker.track(image, timestamp_from_seconds(0.05 * static_cast<double>(i)), std::nullopt);
    tracker.reject_outliers(FeatureTracker::Reference::Previous, std::nullopt);
    before += summary.before;
    after += static_cast<int>(tracker.tracks().size());
    if (i == 0) before = after = 0;
    tracker.detect(image, next_id);
    EXPECT_GT(tracker.tracks().size(), 40U) << images[i];
  }
  EXPECT_GT(after, 0.7 * before);
}

}  // namespace
}  // namespace edged
