// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/text/sample_files.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/test_support.hpp"
#include "edged/io/text/dataset_formats.hpp"
#include "edged/io/write_recording.hpp"

namespace edged {
namespace {

class ExternalText : public ::testing::Test {
 protected:
  /// An IMU of 1 s at 10 Hz beside it.
  std::vector<ExternalSample> read(const std::string& name, const std::string& text) {
    std::string imu;
    for (int i = 0; i < 11; ++i) imu += std::to_string(1.0 + 0.1 * i) + " 0 0 9.81 0 0 0\n";
    folder_.write("imu.txt", imu);
    folder_.write(name, text);
    const Recording recording = open_recording(folder_.path());
    std::vector<ExternalSample> all;
    while (const auto m = recording.dataset->next())
      if (const auto* sample = std::get_if<ExternalSample>(&*m)) all.push_back(*sample);
    repairs_ = recording.dataset->repairs();
    return all;
  }

  TempFolder folder_;
  std::map<std::string, std::size_t> repairs_;
};

TEST_F(ExternalText, ReadsHeightsAndSigmasOfAFolder) {
  const auto all = read("height.txt", "# t height sigma\n1.05 2.5 0.1\n1.15 2.6\n1.25 -1e1 0.3\n");
  ASSERT_EQ(all.size(), 3U);
  const auto& first = std::get<HeightSample>(all[0]);
  EXPECT_EQ(to_ns(first.t), 1'050'000'000);
  EXPECT_EQ(first.height_m, 2.5);
  EXPECT_EQ(first.sigma_m, 0.1);
  EXPECT_EQ(std::get<HeightSample>(all[1]).sigma_m, 0.0);
  EXPECT_EQ(std::get<HeightSample>(all[2]).height_m, -10.0);
}

TEST_F(ExternalText, ReadsVelocitiesWithOneThreeOrNoSigmas) {
  const auto all = read("velocity.txt", "1.05 1 2 3\n1.15 1 2 3 0.5\n1.25 1 2 3 0.1 inf 0.3\n1.35 1 nan 3 0.1\n");
  ASSERT_EQ(all.size(), 4U);
  const auto sigma = [&](std::size_t i) { return std::get<VelocitySample>(all[i]).sigma; };
  EXPECT_EQ(std::get<VelocitySample>(all[0]).v_S, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(sigma(0), Eigen::Vector3d::Zero());
  EXPECT_EQ(sigma(1), Eigen::Vector3d::Constant(0.5));
  EXPECT_TRUE(std::isinf(sigma(2).y()));
  EXPECT_EQ(sigma(2).z(), 0.3);
  EXPECT_TRUE(std::isinf(sigma(3).y()));
}

TEST_F(ExternalText, ColumnsAndUnitsMayBeNamed) {
  const auto all = read("height.csv", "quality,height [cm],timestamp [us]\n1,250,1050000\n1,260,1150000\n");
  ASSERT_EQ(all.size(), 2U);
  EXPECT_DOUBLE_EQ(std::get<HeightSample>(all[0]).height_m, 2.5);
  EXPECT_EQ(to_ns(time_of(all[1])), 1'150'000'000);
}

TEST_F(ExternalText, AnEurocFolderHasItsOwnPlaceAndNanoseconds) {
  std::string imu = "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n";
  for (int i = 0; i < 11; ++i)
    imu += std::to_string(1'400'000'000'000'000'000 + 100'000'000L * i) + ",0,0,0,0,0,9.81\n";
  folder_.write("mav0/imu0/data.csv", imu);
  folder_.write("mav0/height0/data.csv", "#timestamp [ns],height [m]\n1400000000150000000,7\n1400000000250000000,8\n");
  const Recording recording = open_recording(folder_.path());
  EXPECT_EQ(recording.dataset->info().external, std::vector<std::string>{"height"});
  std::size_t heights = 0;
  while (const auto m = recording.dataset->next()) heights += std::holds_alternative<ExternalSample>(*m) ? 1 : 0;
  EXPECT_EQ(heights, 2U);
}

TEST_F(ExternalText, DamagedLinesAreCountedAndLeftOut) {
  const auto all =
      read("height.txt", "1.05 2.5\n1.06 x\n1.07 1e9\n1.08 1 -0.5\n1.15 2.6 0.1 0.2\n1.14\n1.25 2.7\n1.24 2.7\n1.35 2");
  EXPECT_EQ(all.size(), 2U);
  EXPECT_EQ(repairs_["height: unreadable line"], 5U);
  EXPECT_EQ(repairs_["height: out of order, dropped"], 1U);
  EXPECT_EQ(repairs_["height: last line cut"], 1U);
}

TEST_F(ExternalText, AFirstLineThatLacksAColumnIsRefusedWithFileLineAndRemedy) {
  try {
    read("velocity.csv", "t,vx,vy\n1.05,1,2\n");
    FAIL();
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("velocity.csv:1: `t,vx,vy` has no column vz"), std::string::npos) << text;
    EXPECT_NE(text.find("t[s],vx[m/s],vy[m/s],vz[m/s]"), std::string::npos) << text;
  }
}

TEST_F(ExternalText, AnotherClockAndAnEmptyFileAreRefused) {
  EXPECT_THROW(read("height.txt", "101.05 2.5\n101.15 2.6\n"), InputError);
  EXPECT_THROW(read("height.txt", "nothing\n"), InputError);
}

TEST_F(ExternalText, WhatIsWrittenIsReadToTheLastBit) {
  const auto all = read("velocity.txt", "1.050000001 0.1 0.2 -0.30000000000000004 0.1 inf 0.7\n1.25 1 2 3\n");
  const Recording again = open_recording(folder_.path());
  write_recording(*again.dataset, writable_format("ecd", ""), folder_.path() / "copy", std::nullopt);
  const Recording copy = open_recording(folder_.path() / "copy");
  std::vector<ExternalSample> same;
  while (const auto m = copy.dataset->next())
    if (const auto* sample = std::get_if<ExternalSample>(&*m)) same.push_back(*sample);
  ASSERT_EQ(same.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(time_of(same[i]), time_of(all[i]));
    EXPECT_EQ(sensor_of(all[i]).numbers(same[i]).values, sensor_of(all[i]).numbers(all[i]).values);
    EXPECT_EQ(sensor_of(all[i]).numbers(same[i]).sigmas, sensor_of(all[i]).numbers(all[i]).sigmas);
  }
}

}  // namespace
}  // namespace edged
