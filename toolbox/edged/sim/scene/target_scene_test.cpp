// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "edged/camera/lens_table.hpp"
#include "edged/sim/disturbance.hpp"
#include "edged/sim/motion/trajectory.hpp"
#include "edged/sim/simulator.hpp"
#include "edged/sim/test_recording.hpp"
#include "edged/target/detect.hpp"

namespace edged {
namespace {

/// Where a corner of the target is in the world: the board is centred at (0, 0, 1.3) and faces -x.
Eigen::Vector3d corner_W(const TargetLayout& layout, int id) {
  const Eigen::Vector2d p =
      layout.corners.at(static_cast<std::size_t>(id)) - 0.5 * Eigen::Vector2d(layout.width, layout.height);
  return {0.0, -p.x(), 1.3 + p.y()};
}

TEST(TargetScene, FramesShowTheCornersWhereTheyAre) {
  for (const TargetKind kind : {TargetKind::AprilGrid, TargetKind::Checkerboard, TargetKind::Charuco}) {
    SimulatorConfig config = simulator_preset("calibration-target");
    config.duration_s = 5.0;
    if (kind == TargetKind::Checkerboard) config.motion.aim_deg = 5.0;
    config.frames.rate_hz = 8.0;
    config.frames.read_noise_electrons = 10.0;
    if (kind == TargetKind::Checkerboard) config.scene.target = {.kind = kind, .rows = 5, .columns = 6, .size_m = 0.05};
    if (kind == TargetKind::Charuco)
      config.scene.target = {.kind = kind, .rows = 5, .columns = 6, .size_m = 0.06, .ratio = 0.75};
    Simulator simulator(config);
    simulator.leave_out(Modality::Events);
    const Calibration calibration = simulator.calibration();
    const RigCamera& camera = calibration.rig.camera("frames");
    const TargetDetector detector(config.scene.target);
    std::vector<double> off;
    std::size_t seen = 0, pictures = 0;
    for (const Frame& frame : record(simulator).frames) {
      const SE3 T_C_W = (simulator.trajectory().at(to_seconds(frame.t)).T_W_B * camera.T_B_C).inverse();
      const auto corners = detector.detect(frame.image);
      ++pictures;
      seen += corners.empty() ? 0 : 1;
      for (const TargetCorner& corner : corners) {
        const auto pixel = camera.model.project(T_C_W * corner_W(detector.layout(), corner.id));
        ASSERT_TRUE(pixel.has_value());
        off.push_back((*pixel - corner.pixel).norm());
      }
    }
    EXPECT_GE(seen * 2, pictures) << to_string(kind);
    ASSERT_GE(off.size(), 200u) << to_string(kind);
    std::ranges::sort(off);
    EXPECT_LT(off[off.size() / 2], 0.1) << to_string(kind);
    EXPECT_LT(off[off.size() * 95 / 100], 0.3) << to_string(kind);
  }
}

}  // namespace
}  // namespace edged
