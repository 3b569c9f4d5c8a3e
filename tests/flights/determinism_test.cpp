// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The same recording gives the same bits: in every mode, wherever the memory lies, on one core or more, on any clock.
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <random>

#include "common/step_numbers.hpp"
#include "end_to_end.hpp"

namespace edged {
namespace {

/// A turning, moving flight with its start at rest.
const Flight& flight() { return shared_flight("room", 7, 5.0); }

/// Every number of a step but its stamp.
std::vector<double> all_numbers_of(const Step& o) {
  const auto& p = o.state.T_W_B.translation();
  const auto& q = o.state.T_W_B.rotation();
  const auto &v = o.state.v_W, &bg = o.state.bias_gyro, &ba = o.state.bias_accel;
  const ModalityNumbers events = modality_numbers(o, Modality::Events), frames = modality_numbers(o, Modality::Frames);
  return {p.x(),
          p.y(),
          p.z(),
          q.x(),
          q.y(),
          q.z(),
          q.w(),
          v.x(),
          v.y(),
          v.z(),
          bg.x(),
          bg.y(),
          bg.z(),
          ba.x(),
          ba.y(),
          ba.z(),
          events.event_rate_hz,
          o.scene_depth,
          static_cast<double>(o.keyframe),
          static_cast<double>(events.tracks),
          static_cast<double>(frames.tracks),
          static_cast<double>(o.landmarks.size()),
          static_cast<double>(o.status)};
}

/// `shift`: what the second run's stamps are ahead.
void expect_the_same_bits(const FlightRun& a, const FlightRun& b, Duration shift = Duration(0)) {
  ASSERT_EQ(a.steps.size(), b.steps.size());
  ASSERT_GT(a.steps.size(), 50U);
  EXPECT_EQ(a.steps.back().status, TrackingStatus::Good);
  for (std::size_t i = 0; i < a.steps.size(); ++i) {
    ASSERT_EQ(a.steps[i].state.t + shift, b.steps[i].state.t) << "packet " << i;
    ASSERT_EQ(a.event_frame_sums[i], b.event_frame_sums[i]) << "packet " << i;
    const std::vector<double> x = all_numbers_of(a.steps[i]), y = all_numbers_of(b.steps[i]);
    ASSERT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(double)), 0)
        << "packet " << i << " at " << to_seconds(a.steps[i].state.t) << " s: " << testing::PrintToString(x) << " and "
        << testing::PrintToString(y);
  }
}

FlightRun run(Mode mode) { return run_flight(flight().calibration, flight().measurements, mode); }

TEST(Determinism, TwoRunsGiveTheSameBitsInEveryModeWhereverTheirMemoryLies) {
  for (const Mode mode : kAllModes) {
    SCOPED_TRACE(mode_name(mode));
    const FlightRun first = run(mode);
    // Holes of all sizes: what the second run allocates comes to lie in another order.
    std::mt19937_64 random(1);
    std::vector<std::unique_ptr<char[]>> blocks;
    for (int i = 0; i < 20000; ++i) blocks.push_back(std::make_unique<char[]>(16 + random() % 2000));
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (random() % 2 == 0) blocks[i].reset();
    }
    expect_the_same_bits(first, run(mode));
  }
}

TEST(Determinism, TheNumberOfThreadsChangesNoBit) {
  const int threads = cv::getNumThreads();
  cv::setNumThreads(2);
  const FlightRun several = run(Mode::Fused);
  cv::setNumThreads(1);
  const FlightRun one = run(Mode::Fused);
  cv::setNumThreads(threads);
  expect_the_same_bits(several, one);
}

TEST(Determinism, UnixStampsGiveTheBitsOfStampsFromZero) {
  const Duration shift = duration_from_seconds(1.7e9);
  std::vector<Measurement> later = flight().measurements;
  for (Measurement& measurement : later) {
    if (auto* batch = std::get_if<EventBatch>(&measurement)) {
      for (Event& event : batch->events) event.t += shift;
    } else if (auto* frame = std::get_if<Frame>(&measurement)) {
      frame->t += shift;
    } else {
      std::get<ImuSample>(measurement).t += shift;
    }
  }
  for (const Mode mode : kAllModes) {
    SCOPED_TRACE(mode_name(mode));
    expect_the_same_bits(run(mode), run_flight(flight().calibration, later, mode), shift);
  }
}

TEST(Determinism, AReaderMayCutItsBatchesAsItLikes) {
  std::vector<Measurement> halved;
  for (const Measurement& measurement : flight().measurements) {
    const auto* batch = std::get_if<EventBatch>(&measurement);
    if (batch == nullptr) {
      halved.push_back(measurement);
      continue;
    }
    const auto middle = batch->events.begin() + static_cast<std::ptrdiff_t>(batch->events.size() / 2);
    halved.emplace_back(EventBatch{batch->camera, {batch->events.begin(), middle}});
    halved.emplace_back(EventBatch{batch->camera, {middle, batch->events.end()}});
  }
  expect_the_same_bits(run(Mode::Fused), run_flight(flight().calibration, halved, Mode::Fused));
}

TEST(Determinism, ARunLeavesTheRecordingAsItWas) {
  const Flight& used = flight();
  std::vector<cv::Mat> before;
  for (const Measurement& measurement : used.measurements) {
    if (const auto* frame = std::get_if<Frame>(&measurement)) before.push_back(frame->image.clone());
  }
  run(Mode::Fused);
  std::size_t i = 0;
  for (const Measurement& measurement : used.measurements) {
    if (const auto* frame = std::get_if<Frame>(&measurement)) {
      ASSERT_EQ(cv::norm(frame->image, before[i++], cv::NORM_INF), 0.0);
    }
  }
  EXPECT_GT(i, 100U);
}

}  // namespace
}  // namespace edged
