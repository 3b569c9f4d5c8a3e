// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Measurements from the user's own drivers, each in a thread of its own: here an IMU at rest and an event camera that
// sees little.
#include <atomic>
#include <cstdio>
#include <thread>

#include "edged/odometry.hpp"

int main() {
  const edged::CameraModel lens(240, 180, 200, 200, 120, 90, edged::DistortionModel::None);
  const edged::Rig rig{"mine", {{"dvs", edged::Modality::Events, lens, edged::SE3(), edged::Duration(0)}}};
  edged::Odometry odometry(rig, edged::ImuNoise{}, edged::Mode::Events);

  std::jthread imu([&] {
    for (edged::Timestamp t; t < edged::timestamp_from_seconds(0.5); t += std::chrono::milliseconds(5)) {
      odometry.add(edged::ImuSample{t, {0, 0, 0}, {0, 0, 9.81}});
    }
  });
  std::jthread camera([&] {
    for (edged::Timestamp t; t < edged::timestamp_from_seconds(0.5); t += std::chrono::milliseconds(5)) {
      odometry.add(edged::EventBatch{"dvs", {{t, 100, 80, true}}});
    }
  });
  imu.join(), camera.join();  // drivers do not end: then no finish(), and next() is asked again and again
  odometry.finish();
  int steps = 0;
  while (const std::optional<edged::Step> step = odometry.next()) {
    if (++steps == 1) std::printf("waiting for: %s\n", step->waiting_for.c_str());
  }
  std::printf("%d steps\n", steps);
  return steps > 5 ? 0 : 1;
}
