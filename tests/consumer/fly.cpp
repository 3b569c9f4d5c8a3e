// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The odometry over a simulated flight: prints the last status and how far the body has come.
#include <cstdio>

#include "edged/io/calibration.hpp"
#include "edged/odometry.hpp"
#include "edged/sim/simulator.hpp"

int main() {
  edged::SimulatorConfig flight = edged::simulator_preset("room");
  flight.duration_s = 3.0;
  edged::Simulator simulator(flight);
  const edged::Calibration calibration = simulator.calibration();
  edged::Odometry odometry(calibration.rig, calibration.imu, edged::Mode::Fused, {}, {edged::kInOrder});

  edged::Step last;
  edged::drive(
      odometry, [&] { return simulator.next(); },
      [&](edged::Step step) {
        last = std::move(step);
        return true;
      });
  std::printf("%s, %.2f m from the start, %zu landmarks, %zu rigs known\n", edged::to_string(last.status).c_str(),
              last.state.T_W_B.translation().norm(), last.landmarks.size(), edged::known_rigs().size());
  return last.status == edged::TrackingStatus::Good ? 0 : 1;
}
