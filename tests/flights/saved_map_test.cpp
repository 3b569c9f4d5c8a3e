// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A map that outlives its run: the next one, that begins at another place of the same room in other light, comes into
// its frame; one in another room does not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>

#include "edged/core/check.hpp"
#include "edged/core/measurements/recording_piece.hpp"
#include "end_to_end.hpp"

namespace edged {
namespace {

struct MappedRun {
  Trajectory poses;  ///< of the body; once a map has been found again, in its frame
  std::optional<Timestamp> found;
  std::optional<std::string> map;  ///< as it is in the end
};

OdometryConfig only_localizing() {
  OdometryConfig config;
  config.map.localize_only = true;
  return config;
}

MappedRun run_with(const Flight& flight, Mode mode, const std::string& map, const OdometryConfig& config = {}) {
  Odometry odometry(flight.calibration.rig, flight.calibration.imu, mode, config, {kInOrder});
  if (!map.empty()) odometry.load_map(map);
  MappedRun run;
  drive(odometry, source_of(flight.measurements), [&](const Step& step) {
    if (step.relocalized && !run.found) {
      EXPECT_TRUE(run.poses.empty() || !config.map.localize_only);
      run.found = step.t;
      run.poses.clear();
    }
    if (is_tracking(step.status)) run.poses.push_back({step.t, step.state.T_W_B});
    return true;
  });
  run.map = odometry.save_map();
  return run;
}

Flight flight_of(const std::string& preset, double begin_s, double end_s, const Disturbance& disturbance = {}) {
  SimulatorConfig config = simulator_preset(preset);
  config.seed = 5;
  config.duration_s = end_s;
  config.disturbance = disturbance;
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
    other_place = new Flight(flight_of("poster", 0.0, 8.0));
  }
  static void TearDownTestSuite() { delete first, delete dark, delete other_place; }
  inline static const Flight *first = nullptr, *dark = nullptr, *other_place = nullptr;

  /// The run that makes the map, once a mode.
  static const MappedRun& before(Mode mode) {
    static std::map<Mode, MappedRun> runs;
    const auto [run, is_new] = runs.try_emplace(mode);
    if (is_new) run->second = run_with(*first, mode, "");
    return run->second;
  }
};

TEST_F(SavedMaps, AreFoundAgainByTheNextRun) {
  for (const Mode mode : kAllModes) {
    ASSERT_TRUE(before(mode).map);
    const MappedRun now = run_with(*dark, mode, *before(mode).map);
    ASSERT_TRUE(now.found) << mode_name(mode);
    const double error = error_in_frame_of(associate(first->truth->trajectory, before(mode).poses).pairs,
                                           associate(dark->truth->trajectory, now.poses).pairs);
    std::cout << mode_name(mode) << ": found at " << to_seconds(*now.found - Timestamp()) << " s, then " << 1e3 * error
              << " mm off in the map's frame; " << before(mode).map->size() / 1024 << " kB\n";
    EXPECT_LT(error, mode == Mode::Events ? 0.15 : 0.05);
    EXPECT_TRUE(now.map);
  }
}

TEST_F(SavedMaps, AreNotFoundWhereTheyAreNot) {
  for (const Mode mode : kAllModes) {
    const MappedRun now = run_with(*other_place, mode, *before(mode).map);
    EXPECT_FALSE(now.found) << mode_name(mode);
    EXPECT_FALSE(now.map) << "two places in one frame";
    // Nor do they bend it.
    const MappedRun alone = run_with(*other_place, mode, "");
    ASSERT_EQ(now.poses.size(), alone.poses.size());
    EXPECT_EQ(now.poses.back().T.matrix(), alone.poses.back().T.matrix());
  }
}

TEST_F(SavedMaps, AreOnlyLocalizedIn) {
  for (const Mode mode : kAllModes) {
    const MappedRun now = run_with(*dark, mode, *before(mode).map, only_localizing());
    ASSERT_TRUE(now.found) << mode_name(mode);
    EXPECT_EQ(now.poses.front().t, *now.found);
    EXPECT_EQ(now.map, before(mode).map) << "not a bit of it has changed";
    const double error = error_in_frame_of(associate(first->truth->trajectory, before(mode).poses).pairs,
                                           associate(dark->truth->trajectory, now.poses).pairs);
    std::cout << mode_name(mode) << ": localized at " << to_seconds(*now.found - Timestamp()) << " s, then "
              << 1e3 * error << " mm off in the map's frame\n";
    EXPECT_LT(error, mode == Mode::Events ? 0.15 : 0.05);

    const MappedRun other = run_with(*other_place, mode, *before(mode).map, only_localizing());
    EXPECT_TRUE(other.poses.empty()) << mode_name(mode) << " in another room";
    EXPECT_EQ(other.map, before(mode).map);
  }
}

TEST_F(SavedMaps, AreOnlyLocalizedInWithOpenEyes) {
  constexpr double kCovered_s = 1.5, kSilent_s = 0.5, kAgain_s = 2.0;
  const Disturbance cover{DisturbanceKind::LensCovered, 9.5, kCovered_s};
  const Flight covered = flight_of("room", 5.0, 14.0, cover);
  for (const Mode mode : kAllModes) {
    const MappedRun now = run_with(covered, mode, *before(mode).map, only_localizing());
    std::optional<double> last_s, again_s;
    for (const StampedPose& pose : now.poses) {
      const double t_s = to_seconds(pose.t - Timestamp());
      if (t_s < cover.at_s + kSilent_s) last_s = t_s;
      if (t_s >= cover.at_s + kSilent_s && !again_s) again_s = t_s;
    }
    ASSERT_TRUE(last_s && again_s) << mode_name(mode);
    std::cout << mode_name(mode) << ": silent " << *last_s - cover.at_s << " s after the cover, again "
              << *again_s - cover.end_s() << " s after it\n";
    EXPECT_GT(*again_s, cover.end_s()) << mode_name(mode) << ": not silent under the cover";
    EXPECT_LT(*again_s, cover.end_s() + kAgain_s) << mode_name(mode);
  }
}

TEST_F(SavedMaps, OfOtherLensesAreRefused) {
  const std::string& map = *before(Mode::Frames).map;
  Odometry events(first->calibration.rig, first->calibration.imu, Mode::Events);
  EXPECT_THROW(events.load_map(map), InputError);
  EXPECT_THROW(events.load_map(map.substr(0, 1000)), InputError);
}

}  // namespace
}  // namespace edged
