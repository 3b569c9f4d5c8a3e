// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run_statistics.hpp"

#include <gtest/gtest.h>

#include "edged/core/angles.hpp"
#include "edged/se3.hpp"

namespace edged {
namespace {

Timestamp at(double s) { return timestamp_from_seconds(s); }

Step step_at(double t_s, TrackingStatus status, bool keyframe = false) {
  Step step;
  step.t = at(t_s);
  step.status = status;
  step.keyframe = keyframe;
  return step;
}

TEST(RunStatistics, CoverageIsTheShareOfTheVisualSpanWithAGoodPose) {
  RunStatistics statistics;
  statistics.add_visual(at(10.0), at(10.0));
  statistics.add_visual(at(20.0), at(20.0));
  statistics.add(step_at(12.0, TrackingStatus::Initializing));
  statistics.add(step_at(13.0, TrackingStatus::Good, true));
  statistics.add(step_at(17.0, TrackingStatus::Good));
  statistics.add(step_at(18.0, TrackingStatus::Degraded));
  statistics.add(step_at(19.0, TrackingStatus::Lost));
  EXPECT_DOUBLE_EQ(statistics.coverage(), 0.5);
  EXPECT_DOUBLE_EQ(statistics.visual_span_s(), 10.0);
  EXPECT_DOUBLE_EQ(statistics.time_in_s(TrackingStatus::Initializing), 2.0);
  EXPECT_DOUBLE_EQ(*statistics.first_good_s(), 3.0);
  EXPECT_DOUBLE_EQ(statistics.lost_share(), 1.0 / 7.0);
  EXPECT_EQ(statistics.packets(), 5u);
  EXPECT_EQ(statistics.keyframes(), 1u);
  EXPECT_EQ(statistics.times_lost(), 1u);
}

TEST(RunStatistics, OfNothingAreZero) {
  const RunStatistics statistics;
  EXPECT_EQ(statistics.coverage(), 0.0);
  EXPECT_EQ(statistics.visual_span_s(), 0.0);
  EXPECT_FALSE(statistics.first_good_s());
}

TEST(RunStatistics, TellTheLargerShareOfWhatWasDropped) {
  RunStatistics statistics;
  EXPECT_EQ(statistics.overload().share, 0.0);
  const EventBatch batch{"events", std::vector<Event>(70, Event{at(1.0), 0, 0, true})};
  statistics.add_visual(batch, {});
  statistics.add_visual(Frame{at(1.0), "frames", {}}, {});
  statistics.set_dropped({930, 0});
  EXPECT_EQ(statistics.overload().text, "93 % of the events dropped");
  statistics.set_dropped({930, 0, 900});
  EXPECT_EQ(statistics.overload().text, "93 % of the events dropped, as reading is too slow");
  statistics.set_dropped({930, 99});
  EXPECT_EQ(statistics.overload().text, "99 % of the frames dropped");
  EXPECT_EQ(statistics.overload().share, 0.99);
}

TEST(RunStatistics, CountLossesNotLostPackets) {
  RunStatistics statistics;
  for (int i = 0; i < 3; ++i) statistics.add(step_at(i, TrackingStatus::Lost));
  statistics.add(step_at(4, TrackingStatus::Good));
  statistics.add(step_at(5, TrackingStatus::Lost));
  EXPECT_EQ(statistics.times_lost(), 2u);
  EXPECT_EQ(statistics.times_contradicted(), 0u);
  statistics.add(step_at(6, TrackingStatus::Good));
  Step contradicted = step_at(7, TrackingStatus::Lost);
  contradicted.contradicted = true;
  for (int i = 0; i < 2; ++i) statistics.add(contradicted);
  EXPECT_EQ(statistics.times_contradicted(), 1u);
}

TEST(RunStatistics, KeepWhatWasLastWaitedFor) {
  RunStatistics statistics;
  Step step = step_at(0, TrackingStatus::Initializing);
  step.waiting_for = "parallax 0.3 of 1.5 deg";
  statistics.add(step);
  statistics.add(step_at(1, TrackingStatus::Good));
  step = step_at(2, TrackingStatus::Lost);
  step.lost_because = "no 8 landmarks for 2.5 s";
  statistics.add(step);
  statistics.add(step_at(3, TrackingStatus::Lost));
  EXPECT_EQ(statistics.waiting_for(), "parallax 0.3 of 1.5 deg");
  EXPECT_EQ(statistics.lost_because(), "no 8 landmarks for 2.5 s");
}

TEST(RunStatistics, KnowHowCertainTheWayIs) {
  RunStatistics statistics;
  Step step = step_at(0.0, TrackingStatus::Good);
  const Eigen::Matrix3d none = Eigen::Matrix3d::Zero();
  step.covariance = {none, none, Eigen::Vector3d(0.05 * 0.05, 0.0, 0.0).asDiagonal()};
  step.state.v_W = {0.2, 0.0, 0.0};
  for (int i = 0; i < 40; ++i) {
    step.t = at(0.1 * i);
    if (i == 8) {
      EXPECT_FALSE(statistics.scale_sigma()) << "0.14 m are too short";
    }
    statistics.add(step);
  }
  EXPECT_NEAR(statistics.scale_sigma().value(), 0.25, 1e-9);
}

TEST(RunStatistics, KnowTheTiltOfAnAttitudeWhateverItsHeading) {
  RunStatistics statistics;
  Step step = step_at(0, TrackingStatus::Initializing);
  const Eigen::Quaterniond R_W_B = so3::exp({0.0, 1.5, 0.0});  // z of the world is near x of the body
  const Eigen::Matrix3d R = R_W_B.toRotationMatrix();
  step.attitude = {R_W_B, R.transpose() * Eigen::Vector3d(1e-4, 4e-4, 9.0).asDiagonal() * R};
  statistics.add(step);
  EXPECT_NEAR(statistics.tilt_sigma_deg().value(), kDegreesPerRadian * 0.02, 1e-9);
  statistics.add(step_at(1, TrackingStatus::Good));
  EXPECT_FALSE(statistics.tilt_sigma_deg());
}

TEST(ResourceMeter, SeesProcessorTimeAndMemory) {
  const ResourceMeter meter;
  volatile double sum = 0.0;
  while (meter.wall_s() < 0.02) sum = sum + 1.0;
  EXPECT_GT(meter.cpu_s(), 0.0);
  EXPECT_GT(ResourceMeter::peak_rss_mb(), 1.0);
}

TEST(ResourceMeter, LeavesOutWhatItIsToldTo) {
  ResourceMeter meter;
  const ResourceMeter whole;
  const double waited = meter.without([&whole] {
    while (whole.wall_s() < 0.02) {
    }
    return whole.wall_s();
  });
  EXPECT_LT(meter.wall_s(), whole.wall_s());
  EXPECT_GE(waited, 0.02);
  EXPECT_LT(meter.cpu_s(), whole.cpu_s());
}

}  // namespace
}  // namespace edged
