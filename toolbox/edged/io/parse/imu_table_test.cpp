// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/imu_table.hpp"

#include <gmock/gmock.h>

#include <numbers>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/test_support.hpp"
#include "edged/io/text/sample_files.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

/// Samples at 200 Hz from 0.9 s on. Stamps in seconds times `ticks`, angular rate `turn`, upward specific force `pull`.
std::string imu_lines(const std::string& heading, double ticks, double turn, double pull, bool accel_first = false) {
  std::string text = heading.empty() ? "" : heading + "\n";
  for (int i = 0; i < 60; ++i) {
    const std::string gyro = fmt::format("{},{},{}", turn * (i % 2), 0.0, turn), accel = fmt::format("0,0,{}", pull);
    text +=
        fmt::format("{},{},{}\n", ticks * (0.9 + 0.005 * i), accel_first ? accel : gyro, accel_first ? gyro : accel);
  }
  return text;
}

TextTable form_of(const TempFolder& folder, const std::string& text) {
  return find_imu_table(folder.write("imu.csv", text));
}

std::string refusal_of(const TempFolder& folder, const std::string& text) {
  try {
    form_of(folder, text);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(ImuText, ColumnsAndUnitsAreThoseThatTheHeadingNames) {
  const TempFolder folder;
  const TextTable euroc = form_of(
      folder, imu_lines("#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m "
                        "s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]",
                        1e9, 0.1, 9.8));
  EXPECT_EQ(euroc.unit, TimeUnit::Nanoseconds);
  EXPECT_EQ(euroc.at, gyro_first(TimeUnit::Seconds).at);
  EXPECT_EQ(euroc.scales[3], 1.0);
  EXPECT_TRUE(euroc.named);
  EXPECT_FALSE(euroc.guessed);

  const TextTable other = form_of(
      folder, imu_lines("t_us,AccelX(g),AccelY(g),AccelZ(g),GyroX(deg/s),GyroY(deg/s),GyroZ(deg/s)", 1e6, 5, 1, true));
  EXPECT_EQ(other.unit, TimeUnit::Microseconds);
  EXPECT_EQ(other.at, accel_first(TimeUnit::Seconds).at);
  EXPECT_NEAR(other.scales[0], kDegree, 1e-12);
  EXPECT_NEAR(other.scales[3], 9.80665, 1e-12);

  const TextTable words = form_of(folder, imu_lines("time,angular_velocity.x,angular_velocity.y,angular_velocity.z,"
                                                    "linear_acceleration.x,linear_acceleration.y,linear_acceleration.z",
                                                    1, 0.2, 9.7));
  EXPECT_EQ(words.at, gyro_first(TimeUnit::Seconds).at);
  EXPECT_TRUE(words.named);
  EXPECT_TRUE(words.guessed);
  EXPECT_THAT(words.said, HasSubstr("t 1 [s] (guessed)"));
}

TEST(ImuText, WhatNoNameTellsIsFoundFromTheContentAndSaidToBeAGuess) {
  const TempFolder folder;
  const TextTable form = form_of(folder, imu_lines("", 1e6, 90, 1, true));
  EXPECT_EQ(form.unit, TimeUnit::Microseconds);
  EXPECT_EQ(form.at, accel_first(TimeUnit::Seconds).at);
  EXPECT_NEAR(form.scales[0], kDegree, 1e-12);
  EXPECT_FALSE(form.named);
  EXPECT_TRUE(form.guessed);
  EXPECT_THAT(form.said, HasSubstr("[deg/s] (guessed)"));
  EXPECT_THAT(form.said, HasSubstr("[g] (guessed)"));
}

TEST(ImuText, DecimalCommasBetweenSemicolonsAreRead) {
  const TempFolder folder;
  std::string text = imu_lines("t[s],gx[rad/s],gy[rad/s],gz[rad/s],ax[m/s^2],ay[m/s^2],az[m/s^2]", 1.0, 0.1, 9.8);
  for (char& c : text) c = c == ',' ? ';' : c == '.' ? ',' : c;
  const auto file = folder.write("imu.csv", text);
  Repairs repairs;
  StampedLines<ImuSample> lines(imu_lines(file, find_imu_table(file)), repairs);
  EXPECT_EQ(lines.peek()->t, timestamp_from_seconds(0.9));
  EXPECT_DOUBLE_EQ(lines.peek()->accel_B.z(), 9.8);
  EXPECT_EQ(imu_lines(file, find_imu_table(file)).last_stamp(), timestamp_from_seconds(0.9 + 0.005 * 59));
}

TEST(ImuText, StampsOfACounterOf32BitsGoOnBehindItsEnd) {
  const TempFolder folder;
  std::string text = "t[us],gx[rad/s],gy[rad/s],gz[rad/s],ax[m/s^2],ay[m/s^2],az[m/s^2]\n";
  for (std::uint32_t i = 0; i < 40; ++i) text += fmt::format("{},0,0,0,0,0,9.8\n", 4'294'900'000U + 5000U * i);
  const auto file = folder.write("imu.csv", text);
  Repairs repairs;
  StampedLines<ImuSample> lines(imu_lines(file, find_imu_table(file)), repairs);
  std::vector<Timestamp> stamps;
  while (lines.peek()) stamps.push_back(lines.pop().t);
  ASSERT_EQ(stamps.size(), 40u);
  EXPECT_EQ(stamps.back() - stamps.front(), std::chrono::milliseconds(195));
  EXPECT_TRUE(repairs.counts().empty());
}

TEST(ImuText, WhatIsNotCertainIsRefusedWithALineToWrite) {
  const TempFolder folder;
  EXPECT_THAT(refusal_of(folder, imu_lines("", 1, 0.8, 1)), HasSubstr("gravity does not identify"));
  EXPECT_THAT(refusal_of(folder, imu_lines("t,gx,gy,gz,ax,ay,az", 1, 1, 42)),
              HasSubstr("accelerometer is not certain"));
  EXPECT_THAT(refusal_of(folder, imu_lines("t,gx,gy,gz,ax,ay,temperature", 1, 1, 9.8)),
              HasSubstr("no column is called az; not known: `temperature`"));
  EXPECT_THAT(refusal_of(folder, "hello\n"), HasSubstr("t[s],gx[rad/s]"));
}

class WithImuFile : public ::testing::Test {
 protected:
  std::unique_ptr<Dataset> open(const std::string& imu) {
    std::string events;
    for (int i = 0; i < 2000; ++i) events += fmt::format("{:.6f} {} {} 1\n", 1.0 + 1e-4 * i, i % 240, i % 180);
    folder.write("rec/events.txt", events);
    return with_imu_file(open_recording(folder.path() / "rec").dataset, folder.write("imu.csv", imu));
  }

  const TempFolder folder;
};

TEST_F(WithImuFile, SamplesAndEventsComeInOneOrderAndNoneIsLost) {
  const auto recording = open(imu_lines("t[s],gx[deg/s],gy[deg/s],gz[deg/s],ax[g],ay[g],az[g]", 1, 90, 1));
  EXPECT_TRUE(recording->info().has_imu);
  Timestamp newest = Timestamp::min();
  std::size_t events = 0, samples = 0;
  while (const auto measurement = recording->next()) {
    EXPECT_GE(*first_stamp(*measurement), newest);
    newest = *last_stamp(*measurement);
    if (const auto* batch = std::get_if<EventBatch>(&*measurement)) events += batch->events.size();
    if (const auto* sample = std::get_if<ImuSample>(&*measurement)) {
      ++samples;
      EXPECT_NEAR(sample->accel_B.z(), 9.80665, 1e-9);
      EXPECT_NEAR(sample->gyro_B.z(), 90 * kDegree, 1e-9);
    }
  }
  EXPECT_EQ(events, 2000u);
  EXPECT_EQ(samples, 60u);
}

TEST_F(WithImuFile, AnotherClockIsRefusedWithBothSpans) {
  try {
    open(imu_lines("t[s],gx,gy,gz,ax,ay,az", 1000, 0.1, 9.8));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("another clock"));
    EXPECT_THAT(e.what(), HasSubstr("1.000000000"));
  }
}

}  // namespace
}  // namespace edged
