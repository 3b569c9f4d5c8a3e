// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The thread gives what the mapper alone gives, and leaves images out where it may not block.
#include "edged/dense/dense_worker.hpp"

#include <gtest/gtest.h>

#include "edged/dense/test_plane.hpp"

namespace edged {
namespace {

TEST(DenseWorker, GivesTheSamePointsAsTheMapperAlone) {
  const TestPlane plane;
  DenseMapper alone;
  std::vector<Timestamp> shown;
  DenseWorker worker({}, DenseOverload::Wait, [&shown](const DepthMap& map) { shown.push_back(map.t); });
  for (int i = 0; i < 90; ++i) {
    const DenseInstant instant = plane.instant(i, shifted(0.02 * i));
    alone.add(instant);
    worker.add(instant);
  }
  alone.finish();
  worker.finish();
  EXPECT_EQ(worker.dropped_keyframes(), 0U);
  EXPECT_GT(worker.timing().count(), 0U);
  ASSERT_EQ(worker.mapper().maps().size(), alone.maps().size());
  ASSERT_EQ(shown.size(), alone.maps().size()) << "each map when it has been measured";
  for (std::size_t i = 0; i < alone.maps().size(); ++i) {
    const std::vector<DensePoint>&a = worker.mapper().maps()[i].points, &b = alone.maps()[i].points;
    EXPECT_EQ(shown[i], alone.maps()[i].t);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t j = 0; j < a.size(); ++j) EXPECT_EQ(a[j].inverse_depth, b[j].inverse_depth);
  }
}

TEST(DenseWorker, CountsTheKeyframesThatItLeavesOut) {
  const TestPlane plane;
  const DenseInstant instant = plane.instant(0, {});
  DenseWorker worker({}, DenseOverload::Drop);
  const int added = 4 * static_cast<int>(DenseWorker::kCapacity);
  for (int i = 0; i < added; ++i) {
    DenseInstant moved = instant;
    moved.t += std::chrono::milliseconds(i);
    moved.T_O_B = shifted(0.3 * i);
    worker.add(std::move(moved));
  }
  worker.finish();
  const DenseCounters& counters = worker.mapper().counters();
  EXPECT_EQ(worker.dropped_keyframes() + counters.keyframes + counters.unmeasured, static_cast<std::size_t>(added));
}

TEST(DenseWorker, MayEndBeforeItsWorkIsDone) {
  const TestPlane plane;
  DenseWorker worker({}, DenseOverload::Wait);
  for (int i = 0; i < 30; ++i) worker.add(plane.instant(i, shifted(0.05 * i)));
}

}  // namespace
}  // namespace edged
