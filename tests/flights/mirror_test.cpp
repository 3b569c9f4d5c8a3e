// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The whole system on recordings from outside: the mirrors (generated data on real motion) and EuRoC (real data).
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "edged/io/open_recording.hpp"
#include "edged/io/test_support.hpp"
#include "end_to_end.hpp"

namespace edged {
namespace {

struct Result {
  FlightScore score;
  RunStatistics statistics;
};

Result run_recording(const std::filesystem::path& folder, const std::optional<Calibration>& rig, Mode mode) {
  const Recording recording = open_recording(folder, rig ? &rig->rig : nullptr);
  const Flight flight = read_flight(*recording.dataset, rig ? *rig : *recording.calibration);
  const FlightRun run = run_flight(flight.calibration, flight.measurements, mode);
  const Result result{score(flight, run), run.statistics};
  std::cout << folder.filename().string() << " " << mode_name(mode) << ": " << describe(result.score, result.statistics)
            << '\n';
  return result;
}

/// Unpacks a mirror and runs it, fused; nothing when it is not there.
std::optional<Result> run_mirror(const std::string& name, const TempFolder& temp) {
  const std::filesystem::path archive = data_folder() / "mirror" / (name + ".tar.xz");
  if (!std::filesystem::exists(archive)) return std::nullopt;
  const std::string command = "tar xf '" + archive.string() + "' -C '" + temp.path().string() + "' 2>&1";
  if (std::system(command.c_str()) != 0) return std::nullopt;  // no tar, no xz, no room
  return run_recording(temp.path() / name, load_rig("davis240c_ecd"), Mode::Fused);
}

void expect_mirror_within(const std::string& name, double ate_m) {
  const TempFolder temp;
  const std::optional<Result> result = run_mirror(name, temp);
  if (!result) GTEST_SKIP() << "no data: mirror/" << name << ".tar.xz, or no tar and xz to unpack it";
  EXPECT_LT(result->score.evaluation.ate_m.rmse, ate_m);
  EXPECT_NEAR(result->score.evaluation.scale, 1.0, 0.03);
  EXPECT_GT(result->statistics.coverage(), 0.9);
  EXPECT_EQ(result->statistics.times_lost(), 0U);
  EXPECT_EQ(result->statistics.last_status(), TrackingStatus::Good);
}

TEST(GeneratedMirror, PosterFusedKeepsWithin20Millimetres) { expect_mirror_within("mirror_poster", 0.020); }
TEST(GeneratedMirror, BoxesFusedKeepsWithin25Millimetres) { expect_mirror_within("mirror_boxes", 0.025); }
TEST(GeneratedMirror, DarkFusedKeepsWithin55Millimetres) { expect_mirror_within("mirror_dark", 0.055); }

TEST(RealEuroc, FramesKeepWithin20MillimetresFromAStartInMotion) {
  const std::filesystem::path folder = data_folder() / "euroc_mh01";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no data: euroc_mh01";
  const Result result = run_recording(folder, std::nullopt, Mode::Frames);
  EXPECT_LT(result.score.evaluation.ate_m.rmse, 0.020);
  EXPECT_NEAR(result.score.evaluation.scale, 1.0, 0.02);
  EXPECT_GE(result.statistics.coverage(), 0.8);
  EXPECT_EQ(result.statistics.times_lost(), 0U);
}

}  // namespace
}  // namespace edged
