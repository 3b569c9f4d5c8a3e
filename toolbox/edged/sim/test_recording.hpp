// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Small recordings for the tests of this folder.
#pragma once

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "edged/sim/simulator.hpp"

namespace edged {

/// The flights of the paper's Table III, in its order.
inline const std::vector<std::string> kPaperFlights{"circle",     "aggressive",  "aggressive-lowlit", "square",
                                                    "line",       "turned",      "low-lit",           "30-percent",
                                                    "60-percent", "dynamic-hdr", "constant-hdr"};

/// All measurements of a recording, by sensor.
struct Recorded {
  std::vector<Event> events;
  std::vector<Frame> frames;
  std::vector<ImuSample> imu;
};

/// A quarter of the pixels of a DAVIS240C, with a short rest at the start.
inline SimulatorConfig small(const std::string& preset, double duration_s) {
  SimulatorConfig config = simulator_preset(preset);
  config.duration_s = duration_s;
  config.motion.rest_s = 0.3;
  config.motion.blend_s = 0.2;
  config.camera.width = 120, config.camera.height = 90;
  config.camera.fx = config.camera.fy = 100.0;
  config.camera.cx = 59.5, config.camera.cy = 44.5;
  return config;
}

inline Recorded record(Dataset& dataset) {
  Recorded out;
  while (const auto measurement = dataset.next()) {
    if (const auto* batch = std::get_if<EventBatch>(&*measurement))
      out.events.insert(out.events.end(), batch->events.begin(), batch->events.end());
    if (const auto* frame = std::get_if<Frame>(&*measurement)) out.frames.push_back(*frame);
    if (const auto* sample = std::get_if<ImuSample>(&*measurement)) out.imu.push_back(*sample);
  }
  return out;
}

inline Recorded record(const SimulatorConfig& config) {
  Simulator simulator(config);
  return record(simulator);
}

inline bool same(const Recorded& a, const Recorded& b) {
  const auto same_event = [](const Event& p, const Event& q) {
    return p.t == q.t && p.x == q.x && p.y == q.y && p.positive == q.positive;
  };
  const auto same_frame = [](const Frame& p, const Frame& q) {
    return p.t == q.t && cv::norm(p.image, q.image, cv::NORM_INF) == 0.0;
  };
  const auto same_imu = [](const ImuSample& p, const ImuSample& q) {
    return p.t == q.t && p.gyro_B == q.gyro_B && p.accel_B == q.accel_B;
  };
  return std::equal(a.events.begin(), a.events.end(), b.events.begin(), b.events.end(), same_event) &&
         std::equal(a.frames.begin(), a.frames.end(), b.frames.begin(), b.frames.end(), same_frame) &&
         std::equal(a.imu.begin(), a.imu.end(), b.imu.begin(), b.imu.end(), same_imu);
}

/// Mean square of the second derivative.
inline double sharpness(const cv::Mat& image) {
  cv::Mat edges;
  cv::Laplacian(image, edges, CV_32F);
  return cv::norm(edges, cv::NORM_L2SQR) / static_cast<double>(image.total());
}

}  // namespace edged
