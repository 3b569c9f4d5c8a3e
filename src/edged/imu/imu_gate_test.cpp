// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Ten seconds of a body in a hand, damaged after five.
#include "edged/imu/imu_gate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>

namespace edged {
namespace {

constexpr double kDamage_s = 5.0;

Timestamp at(double s) { return timestamp_from_seconds(s); }

struct Sensor {
  double rate_hz = 200.0;
  double quantum = 0.0;                 ///< steps of the gyro [rad/s]; ten times those of the accelerometer
  double rest_s = 20.0, move_s = 20.0;  ///< at rest from then, until then
};

std::vector<ImuSample> in_hand(const Sensor& sensor) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 0.002);
  const auto read = [&](double value, double unit) {
    const double noisy = value + unit * noise(random), step = unit * sensor.quantum;
    return step > 0.0 ? step * std::round(noisy / step) : noisy;
  };
  std::vector<ImuSample> samples;
  for (int i = 0; i < static_cast<int>(10.0 * sensor.rate_hz); ++i) {
    const double s = i / sensor.rate_hz;
    const double calm = std::clamp(std::min(s - sensor.rest_s, sensor.move_s - s) / 0.3, 0.0, 1.0);
    const double motion = 1.0 - calm * calm * (3.0 - 2.0 * calm);
    ImuSample sample{at(s)};
    for (int axis = 0; axis < 3; ++axis) {
      sample.gyro_B[axis] = read(1.5 * motion * std::sin((3.0 + axis) * s), 1.0);
      sample.accel_B[axis] = read(4.0 * motion * std::sin((2.0 + axis) * s) + (axis == 2 ? 9.81 : 0.0), 10.0);
    }
    samples.push_back(sample);
  }
  return samples;
}

struct Gated {
  std::vector<ImuSample> passed;
  ImuFaultRecords faults;
};

Gated gated(const std::vector<ImuSample>& samples) {
  ImuGate gate;
  Gated result;
  for (const ImuSample& sample : samples)
    for (const ImuSample& one : gate.push(sample)) result.passed.push_back(one);
  for (const ImuSample& one : gate.finish()) result.passed.push_back(one);
  result.faults = gate.faults();
  return result;
}

/// The numbers of samples refused or spread for a reason, `fault`, and for all others.
std::pair<std::size_t, std::size_t> counts(const Gated& result, ImuFault fault) {
  std::size_t others = 0;
  for (const ImuFaultRecord& record : result.faults) others += record.count;
  return {result.faults[fault].count, others - result.faults[fault].count};
}

using Damage = std::function<void(std::vector<ImuSample>&, std::size_t first, std::size_t count)>;

struct Row {
  const char* what;
  Damage damage;
  double seconds;  ///< of damage; 0: one sample
  double rate_hz;
  ImuFault fault;
  std::size_t past;  ///< samples of the damage that pass before it is certain
};

void hold(std::vector<ImuSample>& samples, std::size_t first, std::size_t count, unsigned axes) {
  for (std::size_t i = first + 1; i < first + count; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      if (axes & (1U << axis)) samples[i].gyro_B[axis] = samples[first].gyro_B[axis];
      if (axes & (8U << axis)) samples[i].accel_B[axis] = samples[first].accel_B[axis];
    }
}

Damage holds(unsigned axes) {
  return [axes](auto& samples, std::size_t first, std::size_t count) { hold(samples, first, count, axes); };
}

void zero_gyro(std::vector<ImuSample>& samples, std::size_t first, std::size_t count) {
  for (std::size_t i = first; i < first + count; ++i) samples[i].gyro_B.setZero();
}

Damage sets(double gyro, double accel) {
  return [=](auto& samples, std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      if (gyro != 0.0) samples[i].gyro_B.y() += gyro;
      if (accel != 0.0) samples[i].accel_B.y() += accel;
    }
  };
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<Row> rows() {
  std::vector<Row> all{
      {"not a number", sets(kNan, 0), 0, 200, ImuFault::NotFinite, 0},
      {"1e300 rad/s", sets(1e300, 0), 0, 200, ImuFault::BeyondRange, 0},
      {"1e300 m/s^2", sets(0, 1e300), 0, 200, ImuFault::BeyondRange, 0},
      {"5000 rad/s", sets(5000, 0), 0, 1000, ImuFault::BeyondRange, 0},
      {"5000 rad/s for long", sets(5000, 0), 0.2, 1000, ImuFault::BeyondRange, 0},
      {"1e4 m/s^2", sets(0, 1e4), 0, 200, ImuFault::BeyondRange, 0},
      {"2 rad/s", sets(2, 0), 0, 200, ImuFault::Spike, 0},
      {"-8 rad/s", sets(-8, 0), 0, 1000, ImuFault::Spike, 0},
  };
  for (const double rate_hz : {200.0, 1000.0})
    for (const double seconds : {0.05, 0.2, 0.5, 0.9}) {
      all.push_back({"the whole IMU", holds(0b111111), seconds, rate_hz, ImuFault::Repeated, 1});
      all.push_back({"the gyro", holds(0b000111), seconds, rate_hz, ImuFault::Repeated, 1});
      all.push_back({"the accelerometer", holds(0b111000), seconds, rate_hz, ImuFault::Repeated, 1});
      all.push_back({"the gyro is zero", zero_gyro, seconds, rate_hz, ImuFault::Repeated, 1});
      all.push_back({"the gyro's y axis", holds(0b000010), seconds, rate_hz, ImuFault::Repeated, 2});
      all.push_back({"the accelerometer's z axis", holds(0b100000), seconds, rate_hz, ImuFault::Repeated, 2});
    }
  return all;
}

TEST(ImuGate, RefusesWhatNoSensorGivesAndNamesTheCauseAndTheTime) {
  for (const Row& row : rows()) {
    SCOPED_TRACE(std::string(row.what) + ", " + std::to_string(row.seconds) + " s at " + std::to_string(row.rate_hz) +
                 " Hz");
    std::vector<ImuSample> samples = in_hand({row.rate_hz});
    const auto count = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(row.seconds * row.rate_hz)));
    row.damage(samples, static_cast<std::size_t>(kDamage_s * row.rate_hz), count);
    const Gated result = gated(samples);
    EXPECT_EQ(counts(result, row.fault), std::pair(count - row.past, std::size_t{0}));
    EXPECT_EQ(result.passed.size(), samples.size() - (count - row.past));
    const ImuFaultRecord& fault = result.faults[row.fault];
    EXPECT_EQ(fault.from, at(kDamage_s));
    EXPECT_NEAR(to_seconds(fault.longest), row.fault == ImuFault::Repeated ? row.seconds : 0.0, 1.5 / row.rate_hz);
  }
}

TEST(ImuGate, PassesEverySampleAtOnceWhereNothingIsWrong) {
  ImuGate gate;
  for (const ImuSample& sample : in_hand({1000.0})) {
    const auto passed = gate.push(sample);
    ASSERT_EQ(passed.size(), 1U);
    EXPECT_EQ(passed.front().t, sample.t);
  }
  EXPECT_TRUE(gate.finish().empty());
}

TEST(ImuGate, TakesReadingsThatACoarseSensorRepeatsAtRestForNoFault) {
  for (const double quantum : {0.0005, 0.002, 0.004, 0.006, 0.008, 0.012, 0.04})  // the noise is 0.002
    for (const auto& [rest_s, move_s] : {std::pair(-1.0, 4.0), {2.0, 8.0}, {5.0, 20.0}}) {
      const std::vector<ImuSample> samples = in_hand({200.0, quantum, rest_s, move_s});
      EXPECT_EQ(gated(samples).passed.size(), samples.size()) << quantum << " from " << rest_s;
    }
}

TEST(ImuGate, TakesASensorThatIsReadTwiceAsOftenAsItMeasuresForWhatItIs) {
  std::vector<ImuSample> samples = in_hand({1000.0});
  for (std::size_t i = 1; i < samples.size(); i += 2)
    samples[i] = {samples[i].t, samples[i - 1].gyro_B, samples[i - 1].accel_B};
  EXPECT_EQ(gated(samples).passed.size(), samples.size());
}

TEST(ImuGate, MarksAnAxisThatStaysAtTheLargestReadingAsClipped) {
  std::vector<ImuSample> samples = in_hand({1000.0});
  for (ImuSample& sample : samples) sample.gyro_B = sample.gyro_B.cwiseMax(-1.2).cwiseMin(1.2);
  const Gated result = gated(samples);
  const auto [clipped, others] = counts(result, ImuFault::Clipped);
  EXPECT_GT(clipped, 1000U);
  EXPECT_EQ(others, 0U);
  EXPECT_EQ(result.passed.size(), samples.size());
  EXPECT_EQ(std::ranges::count(result.passed, true, &ImuSample::gyro_clipped), std::ptrdiff_t(clipped));
  EXPECT_EQ(std::ranges::count(result.passed, true, &ImuSample::accel_clipped), 0);
}

TEST(ImuGate, ASoundKnockIsNoSpike) {
  std::vector<ImuSample> samples = in_hand({200.0});
  const double ring[] = {1.87, -1.43, -1.69, -0.47, 0.68, 0.85};
  for (std::size_t i = 0; i < std::size(ring); ++i) samples[1000 + i].gyro_B.y() += ring[i];
  EXPECT_EQ(gated(samples).passed.size(), samples.size());
}

TEST(ImuGate, SpreadsSamplesOfOneStampEvenlyAndLosesThoseOfTheFirst) {
  for (const std::size_t burst : {3U, 5U, 20U}) {
    SCOPED_TRACE(burst);
    const std::vector<ImuSample> right = in_hand({1000.0});
    std::vector<ImuSample> samples = right;
    samples.resize(samples.size() / burst * burst);
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i].t = right[i / burst * burst + burst - 1].t;
    const Gated result = gated(samples);
    EXPECT_EQ(result.faults[ImuFault::SharedStamp].count, burst - 1);
    EXPECT_EQ(counts(result, ImuFault::Spread), std::pair(samples.size() - burst, burst - 1));
    ASSERT_EQ(result.passed.size(), samples.size() - (burst - 1));
    for (std::size_t i = 1; i < result.passed.size(); ++i)
      EXPECT_NEAR(to_seconds(result.passed[i].t - right[i + burst - 1].t), 0.0, 1e-6);
  }
}

TEST(ImuGate, KeepsTheSpacingOfABurstAfterAGap) {
  ImuGate gate;
  std::vector<ImuSample> passed;
  for (const int end_ms : {10, 20, 30, 500, 510})
    for (int i = 0; i < 5; ++i)
      for (const ImuSample& one : gate.push({at(1e-3 * end_ms), {0.01 * i, 0, 0}, {0, 0, 9.81}})) passed.push_back(one);
  ASSERT_EQ(passed.size(), 16U);
  EXPECT_EQ(passed[11].t, at(0.488));
  EXPECT_EQ(passed[15].t, at(0.5));
}

TEST(ImuGate, CountsSamplesThatAreTwiceOrLate) {
  std::vector<ImuSample> samples = in_hand({200.0});
  samples.insert(samples.begin() + 500, samples[499]);
  samples.insert(samples.begin() + 800, samples[700]);
  EXPECT_EQ(counts(gated(samples), ImuFault::Late), std::pair(std::size_t{2}, std::size_t{0}));
  std::ranges::reverse(samples);
  EXPECT_EQ(gated(samples).passed.size(), 1U);
}

}  // namespace
}  // namespace edged
