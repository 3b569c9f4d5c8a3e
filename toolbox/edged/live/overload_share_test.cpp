// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/overload_share.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

/// A consumer of events that come at `load` times the rate that it can process; its delay, 20 ms being free.
struct Backlog {
  void run(double load, double duration_s) {
    constexpr double kBatch_s = 1e-3, kFree_s = 0.02;
    for (double t = 0.0; t < duration_s; t += kBatch_s) {
      share = overload.next(delay, kBatch_s);
      delay = std::max(0.0, delay + (share * load - 1.0) * kBatch_s / kFree_s);
      longest = std::max(longest, delay);
    }
  }

  OverloadShare overload;
  double delay = 0.0, share = 1.0, longest = 0.0;
};

TEST(OverloadShare, ADelayThatIsFreeCostsNoEvent) {
  OverloadShare overload;
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(overload.next(0.99, 1e-3), 1.0);
}

TEST(OverloadShare, TheDelayReturnsToTheFreeOneWhileOverloadLasts) {
  for (const double load : {1.5, 3.0, 6.0}) {
    Backlog backlog;
    backlog.run(load, 2.0);
    EXPECT_NEAR(backlog.delay, 1.0, 0.1) << load;
    EXPECT_NEAR(backlog.share, 1.0 / load, 0.1 / load) << load;
    EXPECT_LT(backlog.longest, load) << load;  // it was where the share followed the delay alone
  }
}

TEST(OverloadShare, AllEventsStaySoonAfterOverload) {
  Backlog backlog;
  backlog.run(4.0, 2.0);
  backlog.run(0.2, 0.5);
  EXPECT_EQ(backlog.share, 1.0);
}

}  // namespace
}  // namespace edged
