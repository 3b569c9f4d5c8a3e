// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The estimator and the map on a recorded list of observations: no images.
#include "edged/pipeline/packet_step.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "edged/estimator/test_world.hpp"
#include "edged/pipeline/vision/test_recorded_vision.hpp"

namespace edged {
namespace {

constexpr int kPackets = 120;
constexpr FeatureId kWrong = 20;  // features up to this id slip off their points

struct Recording {
  std::vector<Packet> packets;
  std::deque<VisionOutput> seen;
};

/// slip_px: how far the wrong features move a second.
Recording record(TestWorld& world, double slip_px) {
  Recording recording;
  for (int i = 1; i <= kPackets; ++i) {
    const double t = kPacket_s * i;
    EstimatorInput input = world.packet(t, kPacket_s, i % 4 == 0);
    VisionOutput& seen = recording.seen.emplace_back();
    seen.observations = std::move(input.observations);
    for (FeatureObservation& feature : seen.observations.front().features)
      if (feature.id <= kWrong) feature.point.x() += slip_px / 200.0 * t;
    seen.images.push_back({.camera = "frames", .model = world.rig().cameras.front().model});
    seen.keyframe = input.keyframe;
    Packet& packet = recording.packets.emplace_back();
    packet.t = input.t;
    packet.imu = input.motion.samples();
  }
  return recording;
}

/// Error of the motion in the last two seconds [m].
double error_of(const Recording& recording, RecordedVision& vision, const TestWorld& world) {
  StageTimings timings;
  Localization localization(world.rig(), world.noise(), {}, timings);
  std::vector<SE3> T_W_B;
  TrackingStatus status{};
  for (const Packet& packet : recording.packets) {
    const Step step = process_packet(packet, localization, vision);
    T_W_B.push_back(step.state.T_W_B);
    status = step.status;
  }
  EXPECT_EQ(status, TrackingStatus::Good);
  const auto moved = [](const SE3& from, const SE3& to) { return (from.inverse() * to).translation().eval(); };
  constexpr int kThen = kPackets - 40;
  return (moved(T_W_B[kThen - 1], T_W_B[kPackets - 1]) -
          moved(world.T_W_B(kPacket_s * kThen), world.T_W_B(kPacket_s * kPackets)))
      .norm();
}

TEST(PacketStep, EstimatesTheMotionFromAListOfObservations) {
  TestWorld world{TestWorldOptions{}};
  const Recording recording = record(world, 0.0);
  RecordedVision vision(recording.seen);
  EXPECT_LT(error_of(recording, vision, world), 0.02);
}

TEST(PacketStep, EndsFeaturesThatContradictTheOthers) {
  TestWorld world{TestWorldOptions{}};
  const Recording recording = record(world, 10.0);
  RecordedVision vision(recording.seen);
  EXPECT_LT(error_of(recording, vision, world), 0.02);
  std::size_t wrong = 0;
  for (const FeatureId id : vision.ended()) wrong += id <= kWrong ? 1 : 0;
  EXPECT_GT(wrong, 0U);
  EXPECT_LT(vision.ended().size() - wrong, wrong) << "the others stay";
}

}  // namespace
}  // namespace edged
