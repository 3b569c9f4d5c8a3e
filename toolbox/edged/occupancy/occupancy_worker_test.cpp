// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/occupancy/occupancy_worker.hpp"

#include <gtest/gtest.h>

#include <future>
#include <utility>

#include "edged/occupancy/test_keyframe.hpp"

namespace edged {
namespace {

TEST(OccupancyWorker, ShowsTheMapOnceAPeriodAndAtTheEnd) {
  std::vector<double> shown_s;
  std::size_t voxels = 0;
  {
    OccupancyWorker worker(0.05, 2.0, [&](const OccupancyMap& map) {
      shown_s.push_back(to_seconds(map.t.time_since_epoch()));
      voxels = occupied_voxels(map.tree).size();
      EXPECT_EQ(map.path.low_m, 0.025);
    });
    for (int i = 0; i < 50; ++i) worker.add({keyframe_before(1.025 + 0.05 * i, 0.01, timestamp_from_seconds(0.1 * i))});
    worker.add({});
  }
  EXPECT_EQ(shown_s, (std::vector<double>{0.0, 2.0, 4.0, 4.9}));
  EXPECT_GT(voxels, 0U);
}

TEST(OccupancyWorker, ShowsNothingWithoutAnyVoxel) {
  OccupancyWorker worker(0.05, 2.0, [](const OccupancyMap&) { ADD_FAILURE(); });
  worker.add({KeyframeRecord{}});
}

TEST(OccupancyWorker, CountsTheKeyframesThatDidNotFitIntoTheQueue) {
  std::promise<void> full;
  std::size_t left_out = 0;
  {
    OccupancyWorker worker(0.05, 1e6, [&, first = true](const OccupancyMap& map) mutable {
      if (std::exchange(first, false)) full.get_future().wait();
      left_out = map.left_out;
    });
    const int added = static_cast<int>(OccupancyWorker::kCapacity) + 20;
    for (int i = 0; i < added; ++i) worker.add({keyframe_before(2.025, 0.01, timestamp_from_seconds(i))});
    full.set_value();
  }
  EXPECT_GE(left_out, 19U) << "one is in work";
  EXPECT_LE(left_out, 20U);
}

TEST(OccupancyWorker, GoesOnWhenTheClockJumpsBack) {
  std::vector<double> shown_s;
  {
    OccupancyWorker worker(0.05, 2.0,
                           [&](const OccupancyMap& map) { shown_s.push_back(to_seconds(map.t.time_since_epoch())); });
    for (const double s : {100.0, 100.5, 3.0, 3.5})
      worker.add({keyframe_before(2.025, 0.01, timestamp_from_seconds(s))});
  }
  EXPECT_EQ(shown_s, (std::vector<double>{100.0, 3.0, 3.5}));
}

}  // namespace
}  // namespace edged
