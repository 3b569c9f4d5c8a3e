// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Sharpness of warped against unwarped packets of real event cameras: DVS128 streams, whose image motion is found by
// contrast maximisation, and slider_depth of the Event-Camera Dataset, whose motion is known.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <span>

#include "edged/core/test_data.hpp"
#include "edged/events/accumulate.hpp"

namespace edged {
namespace {

EventFrameConfig sharp_config(WarpInterpolation interpolation) {
  EventFrameConfig config;
  config.interpolation = interpolation;
  return config;
}

/// Variance after a blur that makes it independent of whether events lie on pixel centres (raw) or between them
/// (warped).
double blurred_variance(const cv::Mat& sum) {
  cv::Mat blurred;
  cv::GaussianBlur(sum, blurred, cv::Size(), 1.0);
  return image_variance(blurred);
}

std::uint32_t read_u32(const std::vector<unsigned char>& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// A MATLAB v5 file with one compressed int32 matrix `events` whose columns are x, y, polarity, t [us].
/// Layout: 128 bytes of header, one zlib element (tag 15), inside it the matrix (tag 14) with four sub-elements, each
/// padded to 8 bytes: flags, dimensions, name, values.
std::vector<Event> read_dvs128(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::vector<unsigned char> bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  EXPECT_GT(bytes.size(), 136U);
  EXPECT_EQ(read_u32(bytes, 128), 15U);
  std::vector<unsigned char> matrix(16U << 20);
  uLongf size = matrix.size();
  EXPECT_EQ(uncompress(matrix.data(), &size, bytes.data() + 136, read_u32(bytes, 132)), Z_OK);

  const std::size_t rows = read_u32(matrix, 8 + 16 + 8);
  EXPECT_EQ(read_u32(matrix, 8 + 16 + 12), 4U);
  const std::size_t values = 8 + 16 + 16 + 16 + 8;
  EXPECT_EQ(read_u32(matrix, values - 4), rows * 16U);
  const auto column = [&](std::size_t c, std::size_t row) { return read_u32(matrix, values + 4 * (c * rows + row)); };
  std::vector<Event> events(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    events[i] = {Timestamp(std::chrono::microseconds(column(3, i))), static_cast<std::uint16_t>(column(0, i)),
                 static_cast<std::uint16_t>(column(1, i)), column(2, i) == 1};
  }
  return events;
}

/// Finds the image motion (flow [px/s] and turn [rad/s]) that makes a packet sharpest.
class ContrastSearch {
 public:
  explicit ContrastSearch(std::span<const Event> events)
      : events_(events),
        camera_(128, 128, 128.0, 128.0, 63.5, 63.5),
        renderer_(UndistortTable(camera_, camera_), sharp_config(WarpInterpolation::SingleTwist)) {}

  double variance(const Eigen::Vector3d& motion) {
    const auto pose = [&](Timestamp t) {
      const double dt = to_seconds(t - events_.back().t);
      return SE3(so3::exp({0, 0, motion.z() * dt}), Eigen::Vector3d(motion.x(), motion.y(), 0) * dt / camera_.fx());
    };
    const CameraMotion camera_motion{
        {{events_.front().t, pose(events_.front().t)}, {events_.back().t, pose(events_.back().t)}}};
    return blurred_variance(renderer_.accumulate(events_, camera_motion, 1.0));
  }

  double best_variance() {
    const double span_s = to_seconds(events_.back().t - events_.front().t);
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    double best_value = variance(best);
    Eigen::Vector3d step = Eigen::Vector3d(5.0, 5.0, 0.08) / span_s;
    for (int level = 0; level < 4; ++level, step *= 0.4) {
      const Eigen::Vector3d centre = best;
      for (int i = -4; i <= 4; ++i) {
        for (int j = -4; j <= 4; ++j) {
          for (int k = -2; k <= 2; ++k) {
            const Eigen::Vector3d motion = centre + step.cwiseProduct(Eigen::Vector3d(i, j, k));
            const double value = variance(motion);
            if (value > best_value) best_value = value, best = motion;
          }
        }
      }
    }
    return best_value;
  }

 private:
  std::span<const Event> events_;
  CameraModel camera_;
  EventFrameRenderer renderer_;
};

class Dvs128 : public testing::TestWithParam<const char*> {};

TEST_P(Dvs128, PacketsAreSharperAlongTheirMotion) {
  const auto file = data_folder() / "dvs128" / (std::string(GetParam()) + ".mat");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no data";
  const std::vector<Event> events = read_dvs128(file);
  ASSERT_GT(events.size(), 100000U);
  constexpr std::size_t kPacket = 15000;
  double log_ratio_sum = 0.0;
  int packets = 0;
  for (std::size_t begin = kPacket; begin + kPacket <= events.size(); begin += events.size() / 6) {
    ContrastSearch search(std::span<const Event>(events).subspan(begin, kPacket));
    const double ratio = search.best_variance() / search.variance(Eigen::Vector3d::Zero());
    EXPECT_GE(ratio, 1.0);
    log_ratio_sum += std::log(ratio);
    ++packets;
  }
  const double mean_ratio = std::exp(log_ratio_sum / packets);
  RecordProperty("mean_variance_ratio", std::to_string(mean_ratio));
  EXPECT_GT(mean_ratio, 1.5);
}

INSTANTIATE_TEST_SUITE_P(RealStreams, Dvs128, testing::Values("building", "flip", "garfield", "stripes"),
                         [](const auto& stream) { return std::string(stream.param); });

struct Slider {
  CameraModel camera;
  std::vector<Event> events;
  Trajectory poses;  ///< T_W_C
};

std::optional<Slider> read_slider() {
  const auto folder = data_folder() / "ecd" / "slider_depth";
  if (!std::filesystem::exists(folder / "events.txt")) return std::nullopt;
  Slider slider;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  LensCoefficients k{};
  std::ifstream(folder / "calib.txt") >> fx >> fy >> cx >> cy >> k[0] >> k[1] >> k[2] >> k[3] >> k[4];
  slider.camera = CameraModel(240, 180, fx, fy, cx, cy, DistortionModel::RadTan, k);

  std::ifstream event_stream(folder / "events.txt");
  double t = 0;
  int x = 0, y = 0, polarity = 0;
  while (event_stream >> t >> x >> y >> polarity) {
    slider.events.push_back(
        {timestamp_from_seconds(t), static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), polarity == 1});
  }

  std::ifstream pose_stream(folder / "groundtruth.txt");
  Eigen::Vector3d p;
  Eigen::Quaterniond q;
  while (pose_stream >> t >> p.x() >> p.y() >> p.z() >> q.x() >> q.y() >> q.z() >> q.w()) {
    slider.poses.push_back({timestamp_from_seconds(t), SE3(q, p)});
    if (t > 0.18) break;
  }
  return slider;
}

TEST(RealStreams, SliderIsSharpestNearTheDepthOfItsScene) {
  const std::optional<Slider> slider = read_slider();
  if (!slider) GTEST_SKIP() << "no data";
  ASSERT_EQ(slider->events.size(), 50000U);
  ASSERT_GT(slider->poses.size(), 10U);
  const CameraMotion motion = camera_motion(slider->poses, slider->poses.back().T, SE3());
  const UndistortTable table(slider->camera, ideal_pinhole(slider->camera));

  EventFrameRenderer still(table, sharp_config(WarpInterpolation::None));
  const double unwarped = blurred_variance(still.accumulate(slider->events, motion, 1.0));
  EventFrameRenderer moving(table, sharp_config(WarpInterpolation::Piecewise));
  double best = 0.0, best_depth = 0.0;
  for (double depth = 0.15; depth < 6.0; depth *= 1.03) {
    const double variance = blurred_variance(moving.accumulate(slider->events, motion, depth));
    if (variance > best) best = variance, best_depth = depth;
  }
  RecordProperty("variance_ratio", std::to_string(best / unwarped));
  RecordProperty("best_depth_m", std::to_string(best_depth));
  EXPECT_GT(best, 1.3 * unwarped);
  EXPECT_GT(best_depth, 0.4);  // the sequence shows objects about half a metre to two metres away
  EXPECT_LT(best_depth, 2.0);
}

}  // namespace
}  // namespace edged
