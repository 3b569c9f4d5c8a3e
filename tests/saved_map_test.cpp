// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A map that outlives its run: the next one, that begins elsewhere in the same room in other light, comes into its
// frame; one in another room does not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "edged/core/check.hpp"
#include "edged/core/recording_piece.hpp"
#include "end_to_end.hpp"

namespace edged {
namespace {

struct MappedRun {
  Trajectory poses;  ///< of the body; once a map has been found again, in its frame
  std::optional<Timestamp> found;
  std::optional<std::string> map;  ///< as it is in the end
};

MappedRun run_with(const Flight& flight, Mode mode, const std::string& map) {
  Odometry odometry(flight.calibration.rig, flight.calibration.imu, mode, {}, {kInOrder});
  if (!map.empty()) odometry.load_map(map);
  MappedRun run;
  auto next = flight.measurements.begin();
  drive(
      odometry, [&] { return next == flight.measurements.end() ? std::nullopt : std::optional<Measurement>(*next++); },
      [&](const Step& step) {
        if (step.relocalized && !run.found) {
          run.found = step.t;
          run.poses.clear();
        }
        if (is_tracking(step.status)) run.poses.push_back({step.t, step.state.T_W_B});
        return true;
      });
  run.map = odometry.save_map();
  return run;
}

Flight flight_of(const std::string& preset, double begin_s, double end_s) {
  SimulatorConfig config = simulator_preset(preset);
  config.seed = 5;
  config.duration_s = end_s;
  auto simulator = std::make_unique<Simulator>(config);
  const Calibration calibration = simulator->calibration();
  RecordingPiece piece(std::move(simulator), {begin_s, std::nullopt});
  return read_flight(piece, calibration);
}

/// RMS distance between the truth and poses that are laid onto it as others were.
double error_in_frame_of(const std::vector<PosePair>& others, const std::vector<PosePair>& pairs) {
  const Similarity onto = align_rigidly(others);
  double sum = 0.0;
  for (const PosePair& pair : pairs)
    sum += (onto * pair.estimate.translation() - pair.truth.translation()).squaredNorm();
  return std::sqrt(sum / static_cast<double>(pairs.size()));
}

class SavedMaps : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    first = new Flight(flight_of("room", 0.0, 14.0));
    dark = new Flight(flight_of("dark", 5.0, 14.0));
    elsewhere = new Flight(flight_of("poster", 0.0, 8.0));
  }
  static void TearDownTestSuite() { delete first, delete dark, delete elsewhere; }
  inline static const Flight *first = nullptr, *dark = nullptr, *elsewhere = nullptr;
};

TEST_F(SavedMaps, AreFoundAgainByTheNextRun) {
  for (const Mode mode : kAllModes) {
    const MappedRun before = run_with(*first, mode, "");
    ASSERT_TRUE(before.map);
    const MappedRun now = run_with(*dark, mode, *before.map);
    ASSERT_TRUE(now.found) << mode_name(mode);
    const double error = error_in_frame_of(associate(first->truth->trajectory, before.poses).pairs,
                                           associate(dark->truth->trajectory, now.poses).pairs);
    std::cout << mode_name(mode) << ": found at " << to_seconds(*now.found - Timestamp()) << " s, then " << 1e3 * error
              << " mm off in the map's frame; " << before.map->size() / 1024 << " kB\n";
    EXPECT_LT(error, mode == Mode::Events ? 0.15 : 0.05);
    EXPECT_TRUE(now.map);
  }
}

TEST_F(SavedMaps, AreNotFoundWhereTheyAreNot) {
  for (const Mode mode : kAllModes) {
    const MappedRun before = run_with(*first, mode, ""), now = run_with(*elsewhere, mode, *before.map);
    EXPECT_FALSE(now.found) << mode_name(mode);
    EXPECT_FALSE(now.map) << "two places in one frame";
    // Nor do they bend it.
    const MappedRun alone = run_with(*elsewhere, mode, "");
    ASSERT_EQ(now.poses.size(), alone.poses.size());
    EXPECT_EQ(now.poses.back().T.matrix(), alone.poses.back().T.matrix());
  }
}

TEST_F(SavedMaps, OfOtherLensesAreRefused) {
  const MappedRun before = run_with(*first, Mode::Frames, "");
  Odometry events(first->calibration.rig, first->calibration.imu, Mode::Events);
  EXPECT_THROW(events.load_map(*before.map), InputError);
  EXPECT_THROW(events.load_map(before.map->substr(0, 1000)), InputError);
}

}  // namespace
}  // namespace edged
