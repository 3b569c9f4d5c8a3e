// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A part of the vehicle in view: it never moves in the image, whatever the camera does.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <opencv2/core.hpp>

#include "end_to_end.hpp"

namespace edged {
namespace {

constexpr int kFrom = 110;  // this row and all below are the vehicle's

/// Squares that stay where they are, in every frame; of the events of that part, those of a lamp on it.
Flight with_vehicle_in_view(Flight flight) {
  for (Measurement& measurement : flight.measurements) {
    if (auto* frame = std::get_if<Frame>(&measurement)) {
      frame->image = frame->image.clone();
      for (int y = kFrom; y < frame->image.rows; ++y)
        for (int x = 0; x < frame->image.cols; ++x)
          frame->image.at<std::uint8_t>(y, x) = (x / 12 + y / 12) % 2 == 0 ? 220 : 30;
    }
    if (auto* batch = std::get_if<EventBatch>(&measurement)) {
      for (Event& event : batch->events)
        if (event.y >= kFrom) event.x = static_cast<std::uint16_t>(event.x / 24 * 24 + 3);
    }
  }
  return flight;
}

Calibration masked(Calibration calibration) {
  for (RigCamera& camera : calibration.rig.cameras) {
    const int width = camera.model.width(), height = camera.model.height();
    std::vector<std::uint8_t> used(static_cast<std::size_t>(width * height), 255);
    std::fill(used.begin() + static_cast<std::ptrdiff_t>(width * kFrom), used.end(), std::uint8_t{0});
    camera.model = camera.model.masked(used);
  }
  return calibration;
}

class VehicleInView : public testing::TestWithParam<Mode> {};

TEST_P(VehicleInView, IsNotSeenUnderTheMask) {
  const Flight& without = shared_flight("room", 5, 8.0);
  const Flight flight = with_vehicle_in_view(without);
  const Calibration calibration = masked(flight.calibration);
  const FlightRun run = run_flight(calibration, flight.measurements, GetParam());
  const FlightScore result = score(flight, run);
  std::cout << mode_name(GetParam()) << ": " << describe(result, run.statistics) << '\n';
  EXPECT_LT(result.evaluation.ate_m.rmse, GetParam() == Mode::Events ? 0.06 : 0.02);
  std::size_t tracks = 0;
  for (const Step& step : run.steps)
    for (const CameraStep& camera : step.cameras)
      for (const Track& track : camera.tracks) {
        if (camera.modality != Modality::Frames) continue;
        EXPECT_LT(track.pixel.y(), kFrom);
        ++tracks;
      }
  EXPECT_EQ(tracks > 0, GetParam() != Mode::Events);
  if (GetParam() != Mode::Events) return;
  // Of events nothing is left, so that the flight is the same to the bit as if the vehicle were not there.
  const FlightRun same = run_flight(calibration, without.measurements, GetParam());
  ASSERT_EQ(run.steps.size(), same.steps.size());
  for (std::size_t i = 0; i < run.steps.size(); ++i)
    EXPECT_EQ(run.steps[i].state.T_W_B.translation(), same.steps[i].state.T_W_B.translation());
}

INSTANTIATE_TEST_SUITE_P(AllModes, VehicleInView, testing::ValuesIn(kAllModes),
                         [](const auto& test) { return mode_name(test.param); });

}  // namespace
}  // namespace edged
