// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Each layout and compression of HDF5 recordings, their other files, damage, the real sample.
#include "edged/io/hdf5/hdf5.hpp"

#include <gmock/gmock.h>

#include <random>

#include "edged/io/damage_test_support.hpp"
#include "edged/io/hdf5/h5_test_support.hpp"
#include "edged/io/parse/evt_test_support.hpp"

/// For the leak sanitizer: the library itself leaks a few hundred bytes with some damaged files.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }  // NOLINT

namespace edged {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

const RecordingOptions kVga{.geometry = cv::Size(640, 480)};

std::vector<Event> vga_events(std::size_t count) { return generated_events(count, 640, 480, 20); }

Timestamp us(std::int64_t t) { return timestamp_from_ns(1000 * t); }

class H5Packs : public ::testing::TestWithParam<H5Pack> {};
INSTANTIATE_TEST_SUITE_P(, H5Packs,
                         ::testing::Values(H5Pack::None, H5Pack::Deflate, H5Pack::Blosc, H5Pack::Zstd, H5Pack::Lzf));

TEST_P(H5Packs, GiveBackTheEvents) {
  TempFolder folder;
  const std::vector<Event> events = vga_events(200'000);
  write_events(folder.path() / "a.h5", events, GetParam(), 30'000);
  const Recording recording = open_recording(folder.path() / "a.h5", nullptr, kVga);
  EXPECT_EQ(recording.dataset->info().begin, events.front().t);
  EXPECT_EQ(recording.dataset->info().end, events.back().t);
  EXPECT_TRUE(read_all(*recording.dataset).events == events);
  EXPECT_TRUE(recording.dataset->repairs().empty());
}

TEST(Hdf5, MetavisionEventsComeInEcfWithTheGeometryAsAttribute) {
  TempFolder folder;
  const std::vector<Event> events = vga_events(50'000);
  std::vector<EcfEvent> rows;
  for (const Event& e : events) rows.push_back({e.x, e.y, e.positive, 0, to_ns(e.t) / 1000});
  for (const H5Pack pack : {H5Pack::Ecf, H5Pack::Deflate}) {
    {
      H5Maker file(folder.path() / "a.hdf5");
      file.compound("/CD/events", rows, pack, 16384);
      file.text_attribute("geometry", "640x480");
    }
    const Recording recording = open_recording(folder.path() / "a.hdf5");
    EXPECT_EQ(recording.dataset->info().event_sensor, cv::Size(640, 480));
    EXPECT_EQ(recording.dataset->info().format, "metavision");
    EXPECT_TRUE(read_all(*recording.dataset).events == events);
  }
}

TEST(Hdf5, TheOffsetOfTimeIsAdded) {
  TempFolder folder;
  const std::vector<Event> events = vga_events(1000);
  {
    H5Maker file(folder.path() / "a.h5");
    put_event_columns(file, "/events", events, -1'600'000'000'000'000);
    file.array("/t_offset", std::vector<std::int64_t>{1'600'000'000'000'000}, {});
  }
  std::vector<Event> shifted = events;
  for (Event& e : shifted) e.t += std::chrono::seconds(3'200'000'000);
  EXPECT_TRUE(read_all(*open_recording(folder.path() / "a.h5", nullptr, kVga).dataset).events == shifted);
}

TEST(Hdf5, DsecFoldersHaveTheirImagesAndTheLeftEvents) {
  TempFolder folder;
  const std::vector<Event> events = vga_events(20'000);
  for (const char* side : {"left", "right"}) {
    std::filesystem::create_directories(folder.path() / "events" / side);
    H5Maker file(folder.path() / "events" / side / "events.h5");
    put_event_columns(file, "/events", side[0] == 'l' ? events : vga_events(5000), 0, H5Pack::Blosc, 4096);
    H5Maker(folder.path() / "events" / side / "rectify_map.h5").array("/rectify_map", std::vector<float>(8), {2, 2, 2});
  }
  std::string stamps;
  for (int i = 0; i < 4; ++i) {
    folder.write_image("images/left/rectified/00000" + std::to_string(i) + ".png", 144, 108, 10 + i);
    stamps += std::to_string(5000 + 10'000 * i) + "\n";
  }
  folder.write("images/timestamps.txt", stamps);
  for (const auto& path : {folder.path(), folder.path() / "events/left/events.h5"}) {
    const Recording recording = open_recording(path);
    EXPECT_EQ(recording.dataset->info().format, "dsec");
    EXPECT_EQ(recording.dataset->info().event_sensor, cv::Size(640, 480));
    const Contents c = read_all(*recording.dataset);
    EXPECT_TRUE(c.events == events);
    ASSERT_EQ(c.frames.size(), 4u);
    EXPECT_EQ(c.frames[2].t, us(25'000));
    EXPECT_EQ(c.frames[2].image.at<std::uint8_t>(0, 0), 12);
  }
}

TEST(Hdf5, VectorSequencesHaveImuImagesInTheMiddleOfTheirExposureAndTruth) {
  TempFolder folder;
  const std::vector<Event> events = vga_events(20'000);
  const std::string name = "desk_fast1.synced.";
  write_events(folder.path() / (name + "left_event.hdf5"), events, H5Pack::Zstd, 4096);
  folder.write(name + "imu.txt",
               "# IMU of desk_fast1\n# more\n# timestamp gx gy gz ax ay az qx qy qz qw\n"
               "0.01 1 2 3 4 5 6 0 0 0 1\n0.02 1 2 3 4 5 7 0 0 0 1\n");
  folder.write(name + "left_camera/timestamp.txt", "# Left\n# start and end\n0.010 0.012\n0.020 0.024\n");
  folder.write_image(name + "left_camera/0.010000.png", 12, 10, 1);
  folder.write_image(name + "left_camera/0.020000.png", 12, 10, 2);
  folder.write(name + "gt.txt", "# ground truth\n# timestamp px py pz qx qy qz qw\n0.01 1 2 3 0 0 0 1\n");
  for (const auto& path : {folder.path(), folder.path() / (name + "left_event.hdf5")}) {
    const Recording recording = open_recording(path);
    EXPECT_EQ(recording.dataset->info().format, "vector");
    const Contents c = read_all(*recording.dataset);
    EXPECT_TRUE(c.events == events);
    ASSERT_EQ(c.imu.size(), 2u);
    EXPECT_EQ(c.imu[1].t, us(20'000));
    EXPECT_EQ(c.imu[1].gyro_B, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(c.imu[1].accel_B, Eigen::Vector3d(4, 5, 7));
    ASSERT_EQ(c.frames.size(), 2u);
    EXPECT_EQ(c.frames[1].t, us(22'000));
    const auto truth = recording.dataset->ground_truth();
    ASSERT_TRUE(truth);
    EXPECT_EQ(truth->frame, "body");
    EXPECT_EQ(truth->trajectory.at(0).T.translation(), Eigen::Vector3d(1, 2, 3));
    EXPECT_TRUE(recording.dataset->repairs().empty());
  }
}

TEST(Hdf5, TumVieSequencesHaveStampsInMicrosecondsAndExposuresInAFileOfTheirOwn) {
  TempFolder folder;
  const std::vector<Event> events = generated_events(20'000, 1280, 720, 20);
  const std::string data = "mocap-desk-vi_gt_data/";
  write_events(folder.path() / "mocap-desk-events_left.h5", events, H5Pack::Blosc, 4096);
  write_events(folder.path() / "mocap-desk-events_right.h5", events);
  folder.write(data + "imu_data.txt", "# timestamp[us] gx gy gz ax ay az temperature\n10000.5 1 2 3 4 5 6 30\n");
  folder.write(data + "mocap_data.txt", "# timestamp px py pz qx qy qz qw\n2.0e+04 1 2 3 0 0 0 1\n");
  folder.write(data + "left_images/image_timestamps_left.txt", "# timestamp [us]\n10000\n60000\n");
  folder.write(data + "left_images/image_exposures_left.txt", "# exposure [us]\n1000\n2000\n");
  folder.write_image(data + "left_images/00000.jpg", 16, 16, 1);
  folder.write_image(data + "left_images/00001.jpg", 16, 16, 2);
  const Recording recording = open_recording(folder.path());
  EXPECT_EQ(recording.dataset->info().format, "tum-vie");
  EXPECT_EQ(recording.dataset->info().event_sensor, cv::Size(1280, 720));
  const Contents c = read_all(*recording.dataset);
  EXPECT_TRUE(c.events == events);
  ASSERT_EQ(c.imu.size(), 1u);
  EXPECT_EQ(c.imu[0].t, timestamp_from_ns(10'000'500));
  ASSERT_EQ(c.frames.size(), 2u);
  EXPECT_EQ(c.frames[0].t, us(10'500));
  EXPECT_EQ(c.frames[1].t, us(61'000));
  EXPECT_EQ(recording.dataset->ground_truth().value().trajectory.at(0).t, us(20'000));
}

TEST(Hdf5, M3edFilesHoldAllButTheTruthWhichIsTheInverseOfItsMatrices) {
  TempFolder folder;
  const std::vector<Event> events = generated_events(20'000, 1280, 720, 20);
  {
    H5Maker file(folder.path() / "car_data.h5");
    put_event_columns(file, "/prophesee/left", events, 0, H5Pack::Lzf, 4096);
    file.column("/prophesee/left/calib/resolution", std::vector<std::int64_t>{1280, 720});
    std::vector<std::uint8_t> pixels(3 * 4 * 5);
    std::iota(pixels.begin(), pixels.end(), std::uint8_t{1});
    file.array("/ovc/left/data", pixels, {3, 4, 5, 1}, H5Pack::Lzf, 1);
    file.column("/ovc/ts", std::vector<std::int64_t>{2000, 4000, 6000});
    file.array("/ovc/imu/omega", std::vector<double>{1, 2, 3, 4, 5, 6}, {2, 3});
    file.array("/ovc/imu/accel", std::vector<double>{7, 8, 9, 10, 11, 12}, {2, 3});
    file.column("/ovc/imu/ts", std::vector<std::int64_t>{2000, 4500});
    H5Maker truth(folder.path() / "car_pose_gt.h5");
    truth.array("/Cn_T_C0", std::vector<double>{0, -1, 0, 5, 1, 0, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1}, {1, 4, 4});
    truth.column("/ts", std::vector<std::int64_t>{3000});
  }
  const Recording recording = open_recording(folder.path());
  EXPECT_EQ(recording.dataset->info().format, "m3ed");
  const Contents c = read_all(*recording.dataset);
  EXPECT_TRUE(c.events == events);
  ASSERT_EQ(c.frames.size(), 3u);
  EXPECT_EQ(c.frames[1].t, us(4000));
  EXPECT_EQ(c.frames[1].image.at<std::uint8_t>(3, 4), 40);
  ASSERT_EQ(c.imu.size(), 2u);
  EXPECT_EQ(c.imu[1].gyro_B, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(c.imu[1].accel_B, Eigen::Vector3d(10, 11, 12));
  const auto truth = recording.dataset->ground_truth();
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->frame, "events");
  EXPECT_EQ(truth->trajectory.at(0).t, us(3000));
  EXPECT_TRUE(truth->trajectory.at(0).T.translation().isApprox(Eigen::Vector3d(-6, 5, -7)));
}

TEST(Hdf5, MvsecFilesCountInSecondsAndHaveTheAccelerometerWhereGravityIs) {
  TempFolder folder;
  const double t0 = 1'504'645'177.0;
  for (const bool accel_first : {true, false}) {
    {
      H5Maker file(folder.path() / "indoor_data.hdf5");
      std::vector<double> rows, imu;
      for (int i = 0; i < 1000; ++i)
        rows.insert(rows.end(), {i % 346 * 1.0, i % 260 * 1.0, t0 + 1e-5 * i, i % 2 ? 1. : -1.});
      for (const int part : {0, 1})
        for (const double v : accel_first == (part == 0) ? std::array{0.1, -9.8, 0.2} : std::array{0.01, 0.02, 0.03})
          imu.push_back(v);
      file.array("/davis/left/events", rows, {1000, 4}, H5Pack::Deflate, 100);
      file.array("/davis/left/image_raw", std::vector<std::uint8_t>(260 * 346, 7), {1, 260, 346});
      file.column("/davis/left/image_raw_ts", std::vector<double>{t0 + 0.005});
      file.array("/davis/left/imu", imu, {1, 6});
      file.column("/davis/left/imu_ts", std::vector<double>{t0 + 0.002});
      H5Maker truth(folder.path() / "indoor_gt.hdf5");
      truth.array("/davis/left/pose", std::vector<double>{1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1}, {1, 4, 4});
      truth.column("/davis/left/pose_ts", std::vector<double>{t0});
    }
    const Recording recording = open_recording(folder.path() / "indoor_data.hdf5");
    EXPECT_EQ(recording.dataset->info().event_sensor, cv::Size(346, 260));
    const Contents c = read_all(*recording.dataset);
    ASSERT_EQ(c.events.size(), 1000u);
    EXPECT_EQ(c.events[7].x, 7);
    EXPECT_TRUE(c.events[7].positive);
    EXPECT_FALSE(c.events[8].positive);
    EXPECT_NEAR(to_seconds(c.events[999].t - c.events[0].t), 999e-5, 1e-6);
    ASSERT_EQ(c.frames.size(), 1u);
    ASSERT_EQ(c.imu.size(), 1u);
    EXPECT_EQ(c.imu[0].accel_B, Eigen::Vector3d(0.1, -9.8, 0.2));
    EXPECT_EQ(c.imu[0].gyro_B, Eigen::Vector3d(0.01, 0.02, 0.03));
    EXPECT_EQ(recording.dataset->ground_truth().value().trajectory.at(0).T.translation(), Eigen::Vector3d(5, 6, 7));
  }
}

TEST(Hdf5, EdsFoldersHaveImagesImuAndTruth) {
  TempFolder folder;
  const std::vector<Event> events = vga_events(20'000);
  put_event_columns(*std::make_unique<H5Maker>(folder.path() / "events.h5"), "", events, 0, H5Pack::Blosc, 4096);
  folder.write("images_timestamps.txt", "10000\n20000\n");
  folder.write_image("images/frame_0000000000.png", 64, 48, 1);
  folder.write_image("images/frame_0000000001.png", 64, 48, 2);
  folder.write("imu.csv", "timestamp,gx,gy,gz,ax,ay,az\n10000,1,2,3,4,5,6\n");
  folder.write("stamped_groundtruth.txt", "# timestamp tx ty tz qx qy qz qw\n0.01 1 2 3 0 0 0 1\n");
  const Recording recording = open_recording(folder.path());
  EXPECT_EQ(recording.dataset->info().format, "eds");
  const Contents c = read_all(*recording.dataset);
  EXPECT_TRUE(c.events == events);
  EXPECT_EQ(c.frames.size(), 2u);
  ASSERT_EQ(c.imu.size(), 1u);
  EXPECT_EQ(c.imu[0].accel_B, Eigen::Vector3d(4, 5, 6));
  ASSERT_TRUE(recording.dataset->ground_truth());
  EXPECT_EQ(recording.dataset->ground_truth()->frame, "events");
  EXPECT_TRUE(recording.dataset->repairs().empty());
}

TEST(Hdf5, EventsOutOfOrderAreSortedInAndCounted) {
  TempFolder folder;
  const std::vector<Event> events = vga_events(20'000);
  std::vector<Event> mixed = events;
  for (std::size_t i = 100; i + 20 < mixed.size(); i += 1000) std::swap(mixed[i], mixed[i + 20]);
  write_events(folder.path() / "a.h5", mixed);
  const Recording recording = open_recording(folder.path() / "a.h5", nullptr, kVga);
  const Contents c = read_all(*recording.dataset);
  EXPECT_EQ(c.events.size(), events.size());
  EXPECT_TRUE(std::ranges::is_sorted(c.events, {}, &Event::t));
  EXPECT_FALSE(recording.dataset->repairs().empty());
}

TEST(Hdf5, RefusalsSayWhatIsWrong) {
  TempFolder folder;
  const auto refusal = [&](const RecordingOptions& options = {}) {
    return input_error([&] { read_all(*open_recording(folder.path() / "a.h5", nullptr, options).dataset); });
  };
  { H5Maker(folder.path() / "a.h5").array("/depth/map", std::vector<float>(6), {2, 3}); }
  EXPECT_THAT(refusal(), HasSubstr("/depth/map (2, 3)"));
  EXPECT_THAT(refusal(), HasSubstr("/prophesee/left (m3ed)"));
  EXPECT_THAT(input_error([&] { open_recording(folder.path()); }), HasSubstr("/depth/map (2, 3)"));
  write_events(folder.path() / "a.h5", vga_events(5000));
  EXPECT_THAT(refusal(), HasSubstr("--geometry"));
  EXPECT_THAT(refusal({.geometry = cv::Size(100, 100)}), HasSubstr("outside the 100 x 100"));
  write_events(folder.path() / "b.h5", vga_events(5000));
  EXPECT_THAT(input_error([&] { open_recording(folder.path()); }), HasSubstr("give one of"));
  folder.write("a.h5", "\x89HDF\r\n\x1a\nand no more");
  EXPECT_THAT(refusal(), HasSubstr("cannot be opened"));
}

/// Else a file of events could name any file of the system.
TEST(Hdf5, DataInOtherFilesAreNotRead) {
  TempFolder folder;
  const auto file = folder.path() / "a.h5", other = write_events(folder.path() / "other.h5", vga_events(100));
  {
    H5Maker maker(file);
    put_event_columns(maker, "/events", vga_events(100));
  }
  H5Handle opened(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  H5Ldelete(opened.get(), "/events/x", H5P_DEFAULT);
  EXPECT_GE(H5Lcreate_external(other.c_str(), "/events/x", opened.get(), "/events/x", H5P_DEFAULT, H5P_DEFAULT), 0);
  H5Ldelete(opened.get(), "/events/y", H5P_DEFAULT);
  const H5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  EXPECT_GE(H5Pset_external(creation.get(), "/etc/passwd", 0, 200), 0);
  const hsize_t count = 100;
  const H5Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  H5Handle data(
      H5Dcreate2(opened.get(), "/events/y", H5T_STD_U16LE, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
      H5Dclose);
  ASSERT_TRUE(data);
  data = H5Handle(), opened = H5Handle();
  const H5File reader(file);
  EXPECT_FALSE(reader.find("/events/x"));
  EXPECT_FALSE(reader.find("/events/y"));
  EXPECT_TRUE(reader.find("/events/t"));
}

TEST_P(H5Packs, CutAnywhereItIsRefusedOrGivesEventsOfTheRecording) {
  TempFolder folder;
  const std::string whole = read_text(write_events(folder.path() / "whole.h5", vga_events(30'000), GetParam(), 2000));
  std::size_t most = 0;
  for (std::size_t percent = 0; percent < 100; ++percent) {
    const std::size_t events = read_damaged(folder, cut_at(whole, percent), kVga).events.size();
    EXPECT_LE(events, 30'000u);
    most = std::max(most, events);
  }
  EXPECT_GT(most, 15'000u);  // the last array begins at about three quarters of the file
}

TEST_P(H5Packs, FlippedBytesAreRefusedOrPassedOver) {
  TempFolder folder;
  const std::string whole = read_text(write_events(folder.path() / "whole.h5", vga_events(30'000), GetParam(), 2000));
  std::mt19937 random(11);
  for (int i = 0; i < 100; ++i) {
    std::string damaged = whole;
    for (int k = 0; k < 20; ++k) damaged[random() % whole.size()] = static_cast<char>(random());
    read_damaged(folder, damaged, kVga);
  }
}

TEST(Hdf5, AChunkThatCannotBeUnpackedIsCountedAndPassedOver) {
  TempFolder folder;
  const std::vector<Event> events = vga_events(30'000);
  write_events(folder.path() / "a.h5", events, H5Pack::Zstd, 2000);
  std::string bytes = read_text(folder.path() / "a.h5");
  const std::string zstd_magic("\x28\xb5\x2f\xfd", 4);
  std::size_t at = bytes.find(zstd_magic);
  for (int i = 0; i < 7; ++i) at = bytes.find(zstd_magic, at + 1);  // the eighth chunk of x
  bytes[at] = 0;
  const Recording recording = open_recording(folder.write("a.h5", bytes), nullptr, kVga);
  const Contents c = read_all(*recording.dataset);
  EXPECT_GE(c.events.size(), events.size() - 2000 - 2 * 1024);
  EXPECT_LE(c.events.size(), events.size() - 2000);
  EXPECT_GT(recording.dataset->repairs().at("events: part unreadable"), 0u);
}

TEST(Hdf5, TheRealSampleHoldsSeventeenEvents) {
  const auto file = data_folder() / "formats" / "event.hdf5";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no data";
  EXPECT_THAT(input_error([&] { open_recording(file); }), HasSubstr("--geometry"));
  const Recording recording = open_recording(file, nullptr, {.geometry = cv::Size(240, 190)});
  const Contents c = read_all(*recording.dataset);
  // As python3-h5py prints them: 0.000779999 s, 0.005748 s.
  ASSERT_EQ(c.events.size(), 17u);
  EXPECT_TRUE(c.events[1] == (Event{timestamp_from_ns(779'999), 59, 158, false}));
  EXPECT_TRUE(c.events[16] == (Event{us(5748), 74, 181, false}));
  EXPECT_TRUE(recording.dataset->repairs().empty());
}

}  // namespace
}  // namespace edged
