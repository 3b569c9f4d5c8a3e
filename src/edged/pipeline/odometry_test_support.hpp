// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A body at rest in front of an image of blocks, and its steps as numbers, for tests of the whole odometry.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/odometry.hpp"

namespace edged {

inline constexpr int kWidth = 120, kHeight = 90;

inline Timestamp stamp(int ms) { return Timestamp(std::chrono::milliseconds(ms)); }

inline ImuSample resting(Timestamp t) { return {t, {0, 0, 0}, {0, 0, 9.81}}; }

inline Rig small_rig() {
  const CameraModel lens(kWidth, kHeight, 100, 100, 60, 45, DistortionModel::None);
  return {"small",
          {{"dvs", Modality::Events, lens, SE3(), Duration(0)}, {"cam", Modality::Frames, lens, SE3(), Duration(0)}}};
}

inline cv::Mat blocks() {
  cv::Mat image(kHeight, kWidth, CV_8UC1);
  std::mt19937 random(1);
  std::vector<int> grey(12 * 9);
  for (int& g : grey) g = 30 + static_cast<int>(random() % 200);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x)
      image.at<unsigned char>(y, x) = static_cast<unsigned char>(grey[y / 10 * 12 + x / 10]);
  }
  return image;
}

/// In the order of a Dataset: ties IMU, events, frame.
inline std::vector<Measurement> measurements(int length_ms) {
  std::vector<Measurement> all;
  const cv::Mat image = blocks();
  std::mt19937 random(2);
  for (int ms = 0; ms < length_ms; ++ms) {
    if (ms % 5 == 0) all.emplace_back(resting(stamp(ms)));
    EventBatch batch{"dvs", {}};
    for (int i = 0; i < 20; ++i) {
      batch.events.push_back({stamp(ms) + std::chrono::microseconds(40 * i),
                              static_cast<std::uint16_t>(random() % kWidth),
                              static_cast<std::uint16_t>(random() % kHeight), true});
    }
    all.emplace_back(std::move(batch));
    if (ms % 50 == 1) all.emplace_back(Frame{stamp(ms) - std::chrono::microseconds(1), "cam", image});
  }
  std::ranges::stable_sort(all, {}, [](const Measurement& m) { return *first_stamp(m); });
  return all;
}

inline std::vector<double> numbers_of(const Step& step) {
  const NavState& s = step.state;
  const Eigen::Quaterniond& q = s.T_W_B.rotation();
  std::vector<double> numbers{to_seconds(step.t), static_cast<double>(step.status), q.w(), q.x(), q.y(), q.z(),
                              step.scene_depth};
  for (const Eigen::Vector3d& v : {s.T_W_B.translation(), s.v_W, s.bias_gyro, s.bias_accel}) {
    numbers.insert(numbers.end(), v.data(), v.data() + 3);
  }
  for (const CameraStep& camera : step.cameras) {
    numbers.push_back(camera.event_rate_hz);
    for (const Track& track : camera.tracks) numbers.insert(numbers.end(), {track.pixel.x(), track.pixel.y()});
  }
  return numbers;
}

using Numbers = std::vector<std::vector<double>>;

inline void expect_same_bits(const Numbers& a, const Numbers& b) {
  ASSERT_GT(a.size(), 20U);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].size(), b[i].size()) << "step " << i;
    ASSERT_EQ(std::memcmp(a[i].data(), b[i].data(), a[i].size() * sizeof(double)), 0) << "step " << i;
  }
}

inline Numbers rest_of(Odometry& odometry) {
  Numbers steps;
  while (const auto step = odometry.next()) steps.push_back(numbers_of(*step));
  return steps;
}

inline Numbers fed_in_order(const std::vector<Measurement>& all, Mode mode) {
  Odometry odometry(small_rig(), {}, mode, {}, {kInOrder});
  Numbers steps;
  drive(
      odometry, [&, next = all.begin()]() mutable { return next == all.end() ? std::nullopt : std::optional(*next++); },
      [&](const Step& step) {
        steps.push_back(numbers_of(step));
        return true;
      });
  return steps;
}

}  // namespace edged
