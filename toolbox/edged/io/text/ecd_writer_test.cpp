// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What is written reads back to the same bits.
#include "edged/io/text/dataset_formats.hpp"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>

#include "edged/io/calibration.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/test_support.hpp"
#include "edged/io/write_recording.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

void copy_as_ecd(Dataset& source, const std::filesystem::path& folder,
                 const std::optional<Calibration>& calibration = {}) {
  write_recording(source, writable_format("ecd", folder), folder, calibration);
}

TEST(EcdWriter, WrittenRecordingReadsBackToTheSameBits) {
  TempFolder folder;
  ListedDataset source = random_dataset();
  int calls = 0;
  const Calibration calibration = load_rig("davis240c_ecd");
  const WriteCounts counts = write_recording(source, writable_format("ecd", ""), folder.path() / "out", calibration,
                                             {.progress = [&](Timestamp) { ++calls; }});
  EXPECT_GT(calls, 0);

  ListedDataset again = random_dataset();
  const Contents a = read_all(again);
  Recording r = open_recording(folder.path() / "out");
  const Contents b = read_all(*r.dataset);
  EXPECT_EQ(counts.events, a.events.size());
  EXPECT_EQ(a.events, b.events);
  ASSERT_EQ(a.imu.size(), b.imu.size());
  for (std::size_t i = 0; i < a.imu.size(); ++i) {
    EXPECT_EQ(a.imu[i].t, b.imu[i].t);
    EXPECT_EQ(a.imu[i].gyro_B, b.imu[i].gyro_B);
    EXPECT_EQ(a.imu[i].accel_B, b.imu[i].accel_B);
  }
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    EXPECT_EQ(a.frames[i].t, b.frames[i].t);
    EXPECT_EQ(cv::norm(a.frames[i].image, b.frames[i].image, cv::NORM_INF), 0.0);
  }
  EXPECT_TRUE(r.dataset->repairs().empty());
  ASSERT_TRUE(r.calibration);
  EXPECT_EQ(r.calibration->rig.camera("events").model, calibration.rig.camera("events").model);
}

TEST(EcdWriter, GroundTruthBecomesThatOfTheCameraOnItsClock) {
  TempFolder folder;
  ListedDataset source = random_dataset();
  const Calibration calibration = load_rig("davis240c_ecd");
  copy_as_ecd(source, folder.path() / "out", calibration);
  const GroundTruth truth = *open_recording(folder.path() / "out").dataset->ground_truth();
  const RigCamera& camera = calibration.rig.camera("events");
  EXPECT_EQ(truth.frame, "events");
  EXPECT_EQ(truth.trajectory[0].t, source.truth->trajectory[0].t - std::chrono::microseconds(2400));
  EXPECT_TRUE(truth.trajectory[0].T.matrix().isApprox((source.truth->trajectory[0].T * camera.T_B_C).matrix(), 1e-12));
}

TEST(EcdWriter, RefusesWhatTheFormatCannotHold) {
  TempFolder folder;
  ListedDataset source = random_dataset();
  EXPECT_THAT(input_error([&] { copy_as_ecd(source, folder.path() / "a"); }),
              HasSubstr("a calibration with extrinsics"));
  source.truth.reset();
  source.measurements.emplace_back(EventBatch{"right", {Event{}}});
  EXPECT_THAT(input_error([&] { copy_as_ecd(source, folder.path() / "b"); }), HasSubstr("not both left and right"));
  folder.write("c/imu.txt", "");
  EXPECT_THAT(input_error([&] { copy_as_ecd(source, folder.path() / "c"); }), HasSubstr("holds a recording already"));
  EXPECT_THAT(input_error([&] { copy_as_ecd(source, "/proc/none/out"); }), HasSubstr("cannot be made"));
}

TEST(EcdWriter, CopiesARealRecordingExactly) {
  const auto path = data_folder() / "ecd" / "slider_depth";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no data";
  TempFolder folder;
  copy_as_ecd(*open_recording(path).dataset, folder.path() / "out");
  EXPECT_EQ(read_text(folder.path() / "out" / "events.txt"), read_text(path / "events.txt"));
  EXPECT_EQ(read_all(*open_recording(folder.path() / "out").dataset).frames.size(), 87u);
}

}  // namespace
}  // namespace edged
