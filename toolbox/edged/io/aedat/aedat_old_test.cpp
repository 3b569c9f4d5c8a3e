// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// AEDAT 2.0 and 3.1: generated files, a real one, and damage.
#include "edged/io/aedat/aedat_old.hpp"

#include <gmock/gmock.h>

#include <bit>

#include "edged/io/damage_test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

constexpr int kDavisWidth = 240, kDavisHeight = 180;

void put_big(std::string& out, std::uint32_t word) {
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(word >> static_cast<unsigned>(shift) & 0xFFU);
}

std::uint32_t address(int x, int y) {
  return static_cast<std::uint32_t>(kDavisHeight - 1 - y) << 22U | static_cast<std::uint32_t>(kDavisWidth - 1 - x)
                                                                       << 12U;
}

/// 100 events, 10 IMU samples and a frame in which pixel (x, y) has the grey level x.
std::string made_aedat2() {
  std::string out =
      "#!AER-DAT2.0\r\n# AEChip: eu.seebetter.ini.chips.davis.DAVIS240C\r\n"
      "# <entry key=\"ImuGyroScale\" value=\"GyroFullScaleDegPerSec500\"/>\r\n";
  const auto record = [&out](std::uint32_t word, std::uint32_t t) {
    put_big(out, word);
    put_big(out, t);
  };
  for (std::uint32_t i = 0; i < 100; ++i) {
    const std::uint32_t t = 5000 + 100 * i;
    record(address(static_cast<int>(i), 5) | (i % 2) << 11U, t);
    if (i % 10 == 0)
      for (std::uint32_t word = 0; word < 7; ++word)
        record(0x80000C00U | word << 28U | (word == 2 ? 4096U : word == 6 ? 131U : 0U) << 12U, t);
  }
  for (std::uint32_t signal = 0; signal < 2; ++signal)
    for (int x = 0; x < kDavisWidth; ++x)
      for (int y = 0; y < kDavisHeight; ++y)
        record(0x80000000U | address(x, y) | signal << 10U |
                   (signal == 0 ? 1000U : static_cast<std::uint32_t>(1000 - 4 * x)),
               16'000 + 4000 * signal);
  return out;
}

template <typename T>
void put(std::string& out, T value) {
  append_number(out, value);
}

std::string aedat3_packet(std::int16_t kind, std::int32_t item_bytes, std::int32_t count, const std::string& body) {
  std::string out;
  put(out, kind), put(out, std::int16_t{0}), put(out, item_bytes), put(out, std::int32_t{4}), put(out, std::int32_t{1});
  put(out, count), put(out, count), put(out, count);
  return out + body;
}

/// This recording in AEDAT 3.1, with stamps after one overflow of 31 bits, and an invalid event.
std::string made_aedat3() {
  std::string events, imu, frame;
  for (std::uint32_t i = 0; i < 101; ++i) {
    put(events, i << 17U | 5U << 2U | (i % 2) << 1U | (i < 100 ? 1U : 0U));
    put(events, static_cast<std::int32_t>(5000 + 100 * i));
  }
  for (std::int32_t i = 0; i < 10; ++i) {
    put(imu, 1U), put(imu, 5000 + 1000 * i);
    for (const float v : {0.F, 0.F, 1.F, 0.F, 0.F, 2.F, 20.F}) put(imu, v);
  }
  put(frame, 1U | 1U << 1U);
  for (const std::int32_t v : {15'000, 21'000, 16'000, 20'000, kDavisWidth, kDavisHeight, 0, 0}) put(frame, v);
  for (int y = 0; y < kDavisHeight; ++y)
    for (int x = 0; x < kDavisWidth; ++x) put(frame, static_cast<std::uint16_t>(x << 8));
  return "#!AER-DAT3.1\r\n#Format: RAW\r\n#Source 0: DAVIS240C\r\n#!END-HEADER\r\n" + aedat3_packet(1, 8, 101, events) +
         aedat3_packet(3, 36, 10, imu) + aedat3_packet(0, 8, 1, std::string(8, '\1')) +
         aedat3_packet(2, static_cast<std::int32_t>(frame.size()), 1, frame);
}

void expect_made(const Recording& recording, std::int64_t begin_us) {
  const Contents c = read_all(*recording.dataset);
  EXPECT_EQ(recording.dataset->info().event_sensor, cv::Size(kDavisWidth, kDavisHeight));
  ASSERT_EQ(c.events.size(), 100u);
  EXPECT_EQ(c.events[7].x, 7);
  EXPECT_EQ(c.events[7].y, 5);
  EXPECT_TRUE(c.events[7].positive);
  EXPECT_EQ(to_ns(c.events[7].t), 1000 * (begin_us + 5700));
  ASSERT_EQ(c.imu.size(), 10u);
  EXPECT_NEAR(c.imu[3].accel_B.z(), 9.80665, 1e-9);
  EXPECT_NEAR(c.imu[3].gyro_B.z(), 2.0 * 3.14159265 / 180.0, 1e-6);
  ASSERT_EQ(c.frames.size(), 1u);
  EXPECT_EQ(to_ns(c.frames[0].t), 1000 * (begin_us + 18'000));
  EXPECT_EQ(c.frames[0].image.at<std::uint8_t>(3, 200), 200);
  EXPECT_TRUE(recording.dataset->repairs().empty());
}

TEST(OldAedat, EventsFramesAndImuOfVersion2AreRead) {
  const TempFolder folder;
  expect_made(open_recording(folder.write("a.aedat", made_aedat2())), 0);
}

TEST(OldAedat, EventsFramesAndImuOfVersion31AreRead) {
  const TempFolder folder;
  expect_made(open_recording(folder.write("a.aedat", made_aedat3())), std::int64_t{1} << 31U);
}

TEST(OldAedat, CutsAndFlippedBitsAreRefusedOrCounted) {
  for (const std::string& whole : {made_aedat2(), made_aedat3()}) {
    const TempFolder folder;
    const RecordingOptions options{.geometry = cv::Size(kDavisWidth, kDavisHeight)};
    std::mt19937 random(3);
    for (std::size_t i = 0; i < 30; ++i) {
      read_damaged(folder, whole.substr(0, whole.size() * i / 30), options);
      read_damaged(folder, flip_bits(whole, random, 0, whole.size(), 20), options);
    }
  }
}

TEST(OldAedat, OtherVersionsAndCamerasAreRefusedByName) {
  const TempFolder folder;
  const auto refusal = [&](const std::string& text) {
    return input_error([&] { open_recording(folder.write("a.aedat", text)); });
  };
  EXPECT_THAT(refusal("#!AER-DAT1.0\r\n1234"), HasSubstr("AEDAT 1.0 is not read"));
  EXPECT_THAT(refusal("#!AER-DAT3.0\r\n1234"), HasSubstr("AEDAT 3.0 is not read"));
  EXPECT_THAT(refusal("#!AER-DAT2.0\r\n# AEChip: ch.unizh.ini.jaer.chip.retina.DVS128\r\n1234"), HasSubstr("`DVS128`"));
}

TEST(OldAedat, ARealFileOfADavis240cIsReadWhole) {
  const auto file = data_folder() / "formats" / "davis240c_imu_rotdisk.aedat";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no data";
  const Recording recording = open_recording(file);
  const Contents c = read_all(*recording.dataset);
  EXPECT_EQ(c.events.size(), 374'296u);
  ASSERT_EQ(c.imu.size(), 7384u);
  EXPECT_NEAR(c.imu[0].accel_B.norm(), 9.8, 1.0);
  EXPECT_NEAR(to_seconds(c.events.back().t - c.events.front().t), 3.17, 0.01);
  EXPECT_TRUE(recording.dataset->repairs().empty());
}

}  // namespace
}  // namespace edged
