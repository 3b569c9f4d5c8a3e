// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/depth/latest_window.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <semaphore>
#include <stdexcept>

namespace edged {
namespace {

std::vector<Event> window_at(int ms) { return {{Timestamp() + std::chrono::milliseconds(ms), 0, 0, true}}; }

DepthEstimate estimate_of(const std::vector<Event>& window) { return {window.back().t, 2.0, 0.1, 0.0}; }

/// Work that begins and ends on the command of the test.
struct Gate {
  std::counting_semaphore<> begun{0}, may_end{0};
  std::optional<DepthEstimate> operator()(const std::vector<Event>& window) {
    begun.release();
    may_end.acquire();
    return estimate_of(window);
  }
};

std::vector<int> stamps_ms(const std::vector<DepthEstimate>& estimates) {
  std::vector<int> stamps;
  for (const DepthEstimate& e : estimates) stamps.push_back(static_cast<int>(1e3 * to_seconds(e.t) + 0.5));
  return stamps;
}

TEST(LatestWindowThread, MeasuresEveryWindowWhenThereIsTime) {
  LatestWindowThread thread(estimate_of);
  for (const int ms : {50, 100, 150}) {
    thread.put(window_at(ms));
    thread.finish();
  }
  EXPECT_EQ(stamps_ms(thread.take()), (std::vector{50, 100, 150}));
  EXPECT_TRUE(thread.take().empty());
}

TEST(LatestWindowThread, LeavesOutWindowsThatAreNoLongerTheNewest) {
  Gate gate;
  LatestWindowThread thread([&gate](const std::vector<Event>& window) { return gate(window); });
  thread.put(window_at(50));
  gate.begun.acquire();
  for (const int ms : {100, 150, 200})
    thread.put(window_at(ms));  // while the first is being measured: put does not wait
  EXPECT_TRUE(thread.take().empty());
  gate.may_end.release(2);
  thread.finish();
  EXPECT_EQ(stamps_ms(thread.take()), (std::vector{50, 200}));
}

TEST(LatestWindowThread, EndsWithAWindowStillWaiting) {
  std::atomic<int> measured = 0;
  std::counting_semaphore<> begun{0};
  {
    LatestWindowThread thread([&](const std::vector<Event>& window) {
      begun.release();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      ++measured;
      return estimate_of(window);
    });
    thread.put(window_at(50));
    begun.acquire();
    thread.put(window_at(100));
  }
  EXPECT_EQ(measured, 1);
}

TEST(LatestWindowThread, GivesAWindowWithoutMeasurementNoEstimate) {
  LatestWindowThread thread([](const std::vector<Event>&) { return std::nullopt; });
  thread.put(window_at(50));
  thread.finish();
  EXPECT_TRUE(thread.take().empty());
}

TEST(LatestWindowThread, HandsOnWhatItsWorkThrows) {
  LatestWindowThread thread([](const std::vector<Event>& window) {
    if (window.back().t == window_at(50).back().t) throw std::runtime_error("broken");
    return std::optional(estimate_of(window));
  });
  thread.put(window_at(50));
  thread.finish();
  EXPECT_THROW(thread.take(), std::runtime_error);
  thread.put(window_at(100));
  thread.finish();
  EXPECT_EQ(stamps_ms(thread.take()), std::vector{100});
}

}  // namespace
}  // namespace edged
