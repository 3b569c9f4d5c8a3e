// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the tests of calibration formats share.
#pragma once

#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include "edged/io/calibration.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/test_support.hpp"

namespace edged {

/// The text with one passage replaced, which it must have.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), std::string::npos) << from;
  return text.replace(text.find(from), from.size(), to);
}

/// "NAME:events" or "NAME:frames" of each camera.
inline std::vector<std::string> names_and_kinds(const Calibration& c) {
  std::vector<std::string> out;
  for (const RigCamera& camera : c.rig.cameras) out.push_back(camera.name + ":" + kind_name(camera.modality));
  return out;
}

/// A camchain of Kalibr with a camera for each topic, 10 cm beside the previous one.
inline std::string kalibr_chain(const std::vector<std::string>& topics, int width, int height) {
  std::string text;
  for (std::size_t i = 0; i < topics.size(); ++i)
    text += fmt::format(
        "cam{}:\n  camera_model: pinhole\n  distortion_model: none\n  intrinsics: [226, 226, {}, {}]\n"
        "  resolution: [{}, {}]\n  rostopic: {}\n"
        "  T_cam_imu: [[1, 0, 0, {}], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n",
        i, width / 2, height / 2, width, height, topics[i], -0.1 * static_cast<double>(i));
  return text;
}

/// The camera is 10 cm in front of the IMU (along x of the body), with its axis along x.
inline void expect_forward_at_10_cm(const RigCamera& camera) {
  EXPECT_TRUE((camera.T_B_C * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d(1.1, 0, 0), 1e-12)) << camera.name;
  EXPECT_TRUE((camera.T_B_C * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(0.1, -1, 0), 1e-12)) << camera.name;
}

/// Loads calibrations from a folder without logging their warnings.
class CalibrationFiles : public ::testing::Test {
 protected:
  void SetUp() override { spdlog::set_level(spdlog::level::off); }
  void TearDown() override { spdlog::set_level(spdlog::level::info); }
  Calibration load(const std::string& text, const CalibrationOptions& options = {},
                   const std::string& name = "c.yaml") {
    return load_calibration(folder_.write(name, text), options);
  }
  std::string complaint(const std::string& text, const CalibrationOptions& options = {},
                        const std::string& name = "c.yaml") {
    return input_error([&] { load(text, options, name); });
  }
  /// Loads the text cut at every percent and with single bits flipped: it must be read or refused. Returns how often it
  /// was read.
  std::size_t load_damaged(const std::string& text, const CalibrationOptions& options = {}) {
    std::size_t read = 0;
    const auto try_it = [&](const std::string& bytes) {
      try {
        load(bytes, options, "damaged.yaml");
        ++read;
      } catch (const InputError&) {
      }
    };
    for (std::size_t percent = 0; percent <= 100; ++percent) try_it(text.substr(0, text.size() * percent / 100));
    for (std::size_t at = 0; at < text.size(); at += 13) {
      std::string flipped = text;
      flipped[at] = static_cast<char>(flipped[at] ^ (1 << (at % 8)));
      try_it(flipped);
    }
    return read;
  }

  TempFolder folder_;
};

}  // namespace edged
