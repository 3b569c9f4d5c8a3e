// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Depth from the frames of slider_depth (Event-Camera Dataset), whose poses are known. The reference is the depth of
// corners that are followed along the rail: their baseline is several times that of the views the mapper compares.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <optional>

#include "edged/camera/undistort.hpp"
#include "edged/core/test_data.hpp"
#include "edged/dense/dense_mapper.hpp"

namespace edged {
namespace {

struct RailImage {
  Timestamp t;
  SE3 T_O_C;
  cv::Mat image;
};

struct Rail {
  CameraModel lens;
  std::vector<RailImage> images;
};

std::filesystem::path slider_folder() { return data_folder() / "ecd" / "slider_depth"; }

std::optional<SE3> pose_at(const Trajectory& poses, Timestamp t) {
  const auto next = std::ranges::lower_bound(poses, t, {}, &StampedPose::t);
  if (next == poses.begin() || next == poses.end()) return std::nullopt;
  const StampedPose& last = *std::prev(next);
  return interpolate(last.T, next->T, to_seconds(t - last.t) / to_seconds(next->t - last.t));
}

std::optional<Rail> read_rail() {
  const std::filesystem::path folder = slider_folder();
  if (!std::filesystem::exists(folder / "images.txt")) return std::nullopt;
  Rail rail;
  double fx = 0, fy = 0, cx = 0, cy = 0, t = 0;
  LensCoefficients k{};
  std::ifstream(folder / "calib.txt") >> fx >> fy >> cx >> cy >> k[0] >> k[1] >> k[2] >> k[3] >> k[4];
  rail.lens = CameraModel(240, 180, fx, fy, cx, cy, DistortionModel::RadTan, k);

  Trajectory poses;
  std::ifstream pose_stream(folder / "groundtruth.txt");
  Eigen::Vector3d p;
  Eigen::Quaterniond q;
  while (pose_stream >> t >> p.x() >> p.y() >> p.z() >> q.x() >> q.y() >> q.z() >> q.w())
    poses.push_back({timestamp_from_seconds(t), SE3(q, p)});

  std::ifstream image_stream(folder / "images.txt");
  std::string name;
  while (image_stream >> t >> name)
    if (const auto T_O_C = pose_at(poses, timestamp_from_seconds(t)))
      rail.images.push_back(
          {timestamp_from_seconds(t), *T_O_C, cv::imread((folder / name).string(), cv::IMREAD_GRAYSCALE)});
  return rail;
}

DenseMapper mapped(const Rail& rail) {
  DenseMapper mapper;
  for (const RailImage& at : rail.images) {
    DenseInstant instant{.t = at.t, .keyframe = true, .T_O_B = at.T_O_C};
    instant.scene_depth = 1.0;
    instant.images.push_back({"frames", Modality::Frames, rail.lens, {}, at.image});
    mapper.add(std::move(instant));
  }
  mapper.finish();
  return mapper;
}

struct Corner {
  cv::Point2f pixel;
  double inverse_depth;
};

/// Corners of image `first`, followed forwards and backwards as far as they are in view, by least squares over all
/// images. The camera does not turn.
class FollowedCorners {
 public:
  FollowedCorners(const Rail& rail, const std::vector<cv::Mat>& rectified, std::size_t first)
      : rail_(rail), rectified_(rectified), first_(first), focal_px_(ideal_pinhole(rail.lens).fx()) {
    cv::goodFeaturesToTrack(rectified[first], begin_, 150, 0.03, 7.0);
    sums_.resize(begin_.size());
    follow(1);
    follow(-1);
  }

  std::vector<Corner> triangulated() const {
    std::vector<Corner> corners;
    for (std::size_t c = 0; c < begin_.size(); ++c)
      if (sums_[c].longest_m > 0.15) corners.push_back({begin_[c], sums_[c].products / sums_[c].squares});
    return corners;
  }

 private:
  struct Sums {
    double products = 0.0, squares = 0.0;  // of disparity [1] and baseline [m], of baselines
    double longest_m = 0.0;
  };

  void follow(int step) {
    std::vector<cv::Point2f> at = begin_, next, again;
    std::vector<unsigned char> seen(begin_.size(), 1), found, found_again;
    std::vector<float> error;
    const int last = step > 0 ? static_cast<int>(rectified_.size()) - 1 : 0;
    for (int i = static_cast<int>(first_); i != last; i += step, at = next) {
      const auto from = static_cast<std::size_t>(i), to = static_cast<std::size_t>(i + step);
      cv::calcOpticalFlowPyrLK(rectified_[from], rectified_[to], at, next, found, error);
      cv::calcOpticalFlowPyrLK(rectified_[to], rectified_[from], next, again, found_again, error);
      const double baseline_m = (rail_.images[to].T_O_C.translation() - rail_.images[first_].T_O_C.translation()).x();
      for (std::size_t c = 0; c < begin_.size(); ++c) {
        const bool inside = next[c].x > 8.0F && next[c].x < static_cast<float>(rectified_[to].cols - 8);
        seen[c] &= found[c] & found_again[c] & (cv::norm(again[c] - at[c]) < 0.2) & inside;
        if (!seen[c]) continue;
        sums_[c].products += baseline_m * (begin_[c].x - next[c].x) / focal_px_;
        sums_[c].squares += baseline_m * baseline_m;
        sums_[c].longest_m = std::max(sums_[c].longest_m, std::abs(baseline_m));
      }
    }
  }

  const Rail& rail_;
  const std::vector<cv::Mat>& rectified_;
  std::size_t first_;
  double focal_px_;
  std::vector<cv::Point2f> begin_;
  std::vector<Sums> sums_;
};

TEST(RealImages, DepthAgreesWithCornersThatAreFollowedAlongTheRail) {
  const std::optional<Rail> rail = read_rail();
  if (!rail) GTEST_SKIP() << "no data";
  ASSERT_GT(rail->images.size(), 80U);
  const Rectifier rectify(rail->lens, ideal_pinhole(rail->lens));
  std::vector<cv::Mat> rectified;
  for (const RailImage& at : rail->images) rectified.push_back(rectify(at.image));

  const DenseMapper mapper = mapped(*rail);
  std::vector<double> errors;
  for (const DepthMap& map : mapper.maps()) {
    const auto image = std::ranges::find(rail->images, map.t, &RailImage::t);
    const FollowedCorners corners(*rail, rectified, static_cast<std::size_t>(image - rail->images.begin()));
    for (const Corner& corner : corners.triangulated())
      for (const DensePoint& point : map.points)
        if (std::hypot(point.x - corner.pixel.x, point.y - corner.pixel.y) < 1.5)
          errors.push_back(std::abs(corner.inverse_depth / point.inverse_depth - 1.0));
  }
  ASSERT_GT(errors.size(), 200U);
  std::ranges::sort(errors);
  const DenseCounters& counters = mapper.counters();
  std::cout << fmt::format(
      "{} points at corners: median error {:.2f} %, 90 % within {:.1f} %; {:.0f} % of {} edge pixels\n", errors.size(),
      100.0 * errors[errors.size() / 2], 100.0 * errors[9 * errors.size() / 10],
      100.0 * static_cast<double>(counters.with_depth) / static_cast<double>(counters.edges), counters.edges);
  EXPECT_LE(errors[errors.size() / 2], 0.03);
}

}  // namespace
}  // namespace edged
