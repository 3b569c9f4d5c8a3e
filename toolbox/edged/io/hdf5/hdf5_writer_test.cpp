// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Written files have the layout that the tools of DSEC expect, and read back. Events of all formats:
// write_recording_test.cpp.
#include "edged/io/hdf5/hdf5.hpp"

#include <gtest/gtest.h>

#include "edged/io/calibration.hpp"
#include "edged/io/hdf5/h5.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/parse/evt_test_support.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

WriterSetup setup_for(const std::filesystem::path& file) {
  WriterSetup setup;
  setup.path = file;
  setup.info.event_sensor = cv::Size(640, 480);
  return setup;
}

TEST(Hdf5Writer, EventsStampsAndIndexAreThoseOfDsec) {
  TempFolder folder;
  const std::vector<Event> events = generated_events(150'000, 640, 480, 20);
  const auto writer = write_hdf5(setup_for(folder.path() / "a.h5"));
  writer->write(EventBatch{"events", events});
  writer->finish();
  const H5File file(folder.path() / "a.h5");
  const auto t = file.find("/events/t").value().read<std::int64_t>(0, events.size());
  const auto offset = file.find("/t_offset").value().read<std::int64_t>(0, 1).front();
  for (std::size_t i = 0; i < events.size(); ++i) ASSERT_EQ(timestamp_from_ns(1000 * (offset + t[i])), events[i].t);
  const auto array = file.find("/ms_to_idx");
  const auto index = array.value().read<std::uint64_t>(0, array->rows());
  ASSERT_EQ(index.size(), static_cast<std::size_t>(t.back() / 1000 + 1));
  for (std::size_t ms = 0; ms < index.size(); ++ms) {
    const auto us = static_cast<std::int64_t>(1000 * ms);
    ASSERT_GE(t[index[ms]], us);
    if (index[ms] > 0) {
      ASSERT_LT(t[index[ms] - 1], us);
    }
  }
}

TEST(Hdf5Writer, FramesImuTruthAndSensorComeBackToTheLastBit) {
  TempFolder folder;
  const auto writer = write_hdf5(setup_for(folder.path() / "a.h5"));
  GroundTruth truth{{}, "events"};
  for (int i = 0; i < 3000; ++i)
    truth.trajectory.push_back({timestamp_from_ns(1'000'000 + 7 * i),
                                SE3(Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), Eigen::Vector3d(i / 3.0, 0.1, -7))});
  writer->write(truth);
  std::vector<ImuSample> imu;
  for (std::int64_t i = 0; i < 3000; ++i) {
    const Timestamp t = timestamp_from_ns(1'000'001 + 1'000'003 * i);
    const double value = static_cast<double>(i) / 7.0;
    imu.push_back({t, {value, 2, 3}, {4, -value, 6}});
    writer->write(imu.back());
    writer->write(EventBatch{"events", {Event{timestamp_from_ns(2'000'000 + 1'000'000 * i), 1, 2, true}}});
    if (i % 100 == 0)
      writer->write(Frame{t, "frames", cv::Mat(5, 7, CV_8UC1, cv::Scalar(static_cast<double>(i / 100)))});
  }
  writer->finish();
  const Recording recording = open_recording(folder.path() / "a.h5");
  EXPECT_EQ(recording.dataset->info().event_sensor, cv::Size(640, 480));
  const Contents c = read_all(*recording.dataset);
  ASSERT_EQ(c.imu.size(), imu.size());
  for (std::size_t i = 0; i < imu.size(); ++i) {
    ASSERT_EQ(c.imu[i].t, imu[i].t);
    ASSERT_EQ(c.imu[i].gyro_B, imu[i].gyro_B);
    ASSERT_EQ(c.imu[i].accel_B, imu[i].accel_B);
  }
  ASSERT_EQ(c.frames.size(), 30u);
  EXPECT_EQ(c.frames[29].image.at<std::uint8_t>(4, 6), 29);
  EXPECT_EQ(c.frames[29].t, imu[2900].t);
  const auto back = recording.dataset->ground_truth();
  ASSERT_TRUE(back);
  EXPECT_EQ(back->frame, "events");
  ASSERT_EQ(back->trajectory.size(), truth.trajectory.size());
  EXPECT_EQ(back->trajectory[2999].T.translation(), truth.trajectory[2999].T.translation());
  EXPECT_EQ(back->trajectory[2999].T.rotation().coeffs(), truth.trajectory[2999].T.rotation().coeffs());
}

TEST(Hdf5Writer, ItsFolderIsReadWithTheCalibrationBesideIt) {
  TempFolder folder;
  const auto writer = write_hdf5(setup_for(folder.path() / "a.h5"));
  writer->write(ImuSample{timestamp_from_ns(1'000'000), {1, 2, 3}, {4, 5, 6}});
  writer->write(EventBatch{"events", {Event{timestamp_from_ns(2'000'000), 1, 2, true}}});
  writer->finish();
  EXPECT_FALSE(open_recording(folder.path()).calibration);
  folder.write("calibration.yaml", to_yaml(load_rig("davis240c_ecd")));
  const Recording recording = open_recording(folder.path());
  ASSERT_TRUE(recording.calibration);
  EXPECT_EQ(recording.calibration->rig.cameras.size(), 2U);
  EXPECT_TRUE(recording.dataset->info().has_imu);
}

}  // namespace
}  // namespace edged
