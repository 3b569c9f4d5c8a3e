// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/core/measurements/recording_piece.hpp"

#include <gtest/gtest.h>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

constexpr Timestamp kEpoch = timestamp_from_ns(1'468'939'993'000'000'000);

Timestamp at_ms(int ms) { return kEpoch + std::chrono::milliseconds(ms); }

/// A second: every 10 ms an IMU sample and a batch of events 1 ms apart, every 100 ms a frame and a true pose.
class ASecond : public Dataset {
 public:
  explicit ASecond(bool known_bounds) {
    info_.name = "second";
    info_.has_events = info_.has_frames = info_.has_imu = true;
    if (known_bounds) info_.begin = kEpoch, info_.end = at_ms(1000);
  }
  const DatasetInfo& info() const override { return info_; }

  void leave_out(Modality unwanted) override { events_ &= unwanted != Modality::Events; }

  std::optional<Measurement> next() override {
    const int ms = 10 * (step_ / 3);
    if (ms > 1000) return std::nullopt;
    ++read;
    switch (step_++ % 3) {
      case 0:
        return ImuSample{at_ms(ms), {0, 0, 0}, {0, 0, 9.81}};
      case 1: {
        if (!events_) return next();
        EventBatch batch{"events", {}};
        for (int i = 0; i < 10; ++i) batch.events.push_back({at_ms(ms + i), 1, 2, true});
        return batch;
      }
      default:
        return ms % 100 == 0 ? Measurement(Frame{at_ms(ms), "frames", cv::Mat()}) : *next();
    }
  }

  std::optional<GroundTruth> ground_truth() const override {
    GroundTruth truth;
    for (int ms = 0; ms <= 1000; ms += 100) truth.trajectory.push_back({at_ms(ms), SE3()});
    return truth;
  }
  std::map<std::string, std::size_t> repairs() const override { return {{"frame missing", 3}}; }

  static inline int read = 0;

 private:
  DatasetInfo info_;
  int step_ = 0;
  bool events_ = true;
};

RecordingPiece piece(double from_s, std::optional<double> to_s, bool known_bounds = true) {
  ASecond::read = 0;
  return {std::make_unique<ASecond>(known_bounds), {from_s, to_s}};
}

struct Counts {
  int events = 0, frames = 0, imu = 0;
  Timestamp first = Timestamp::max(), last = Timestamp::min();
};

Counts count(Dataset& dataset) {
  Counts counts;
  while (const auto measurement = dataset.next()) {
    if (const auto* batch = std::get_if<EventBatch>(&*measurement))
      counts.events += static_cast<int>(batch->events.size());
    else
      ++(std::holds_alternative<Frame>(*measurement) ? counts.frames : counts.imu);
    counts.first = std::min(counts.first, *first_stamp(*measurement));
    counts.last = std::max(counts.last, *last_stamp(*measurement));
  }
  return counts;
}

TEST(RecordingPiece, KeepsWhatWasMeasuredFromItsBeginToBeforeItsEnd) {
  for (const bool known : {true, false}) {
    RecordingPiece some = piece(0.2, 0.5, known);
    EXPECT_EQ(some.info().begin, at_ms(200));
    EXPECT_EQ(some.info().end, known ? std::optional(at_ms(500)) : std::nullopt);
    const Counts counts = count(some);
    EXPECT_EQ(counts.events, 300);
    EXPECT_EQ(counts.frames, 3);
    EXPECT_EQ(counts.imu, 30);
    EXPECT_EQ(counts.first, at_ms(200));
    EXPECT_EQ(counts.last, at_ms(499));
    EXPECT_EQ(some.repairs().at("frame missing"), 3U);
  }
}

TEST(RecordingPiece, CutsTheBatchOfEventsAtEitherBorder) {
  RecordingPiece some = piece(0.2035, 0.2555);
  const Counts counts = count(some);
  EXPECT_EQ(counts.events, 52);
  EXPECT_EQ(counts.first, at_ms(204));
  EXPECT_EQ(counts.last, at_ms(255));
}

TEST(RecordingPiece, WithoutAnEndGoesToThatOfTheRecordingAndNoFarther) {
  RecordingPiece rest = piece(0.9, std::nullopt);
  EXPECT_EQ(rest.info().end, at_ms(1000));
  EXPECT_EQ(count(rest).imu, 11);
  RecordingPiece longer = piece(0.9, 60.0);
  EXPECT_EQ(longer.info().end, at_ms(1000));
  EXPECT_EQ(count(longer).imu, 11);
}

TEST(RecordingPiece, ReadsNoFartherThanEverySensorsEnd) {
  RecordingPiece begin = piece(0.0, 0.1);
  count(begin);
  EXPECT_LT(ASecond::read, 40);
}

TEST(RecordingPiece, DoesNotReadOnForTheEndOfWhatIsLeftOut) {
  RecordingPiece begin = piece(0.0, 0.1);
  begin.leave_out(Modality::Events);
  const Counts counts = count(begin);
  EXPECT_EQ(counts.events, 0);
  EXPECT_EQ(counts.imu, 10);
  EXPECT_LT(ASecond::read, 40);
}

TEST(RecordingPiece, KeepsTheTrueMotionWithAPoseOnEitherSide) {
  const Trajectory poses = piece(0.25, 0.55).ground_truth()->trajectory;
  ASSERT_EQ(poses.size(), 5U);
  EXPECT_EQ(poses.front().t, at_ms(200));
  EXPECT_EQ(poses.back().t, at_ms(600));
}

TEST(RecordingPiece, RefusesBoundsThatHoldNothing) {
  EXPECT_THROW(piece(0.5, 0.5), InputError);
  EXPECT_THROW(piece(0.5, 0.2), InputError);
  EXPECT_THROW(piece(1.5, std::nullopt), InputError);
  // Without known bounds the error comes at the end.
  RecordingPiece unknown = piece(1.5, std::nullopt, false);
  try {
    unknown.next();
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("--from 1.5 is beyond its end: it is 1.009 s long"), std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace edged
