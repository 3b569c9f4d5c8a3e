// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Recordings: detection, order, damage, and the real ones.
#include "edged/io/open_recording.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <zlib.h>

#include <random>

#include "edged/io/calibration.hpp"
#include "edged/io/parse/text_parsing.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

Timestamp ms(double t) { return timestamp_from_seconds(t * 1e-3); }

Timestamp stamp_of(const Measurement& m) {
  if (const auto* b = std::get_if<EventBatch>(&m)) return b->events.front().t;
  if (const auto* f = std::get_if<Frame>(&m)) return f->t;
  return std::get<ImuSample>(m).t;
}

/// 100 ms: an event every 0.1 ms, an IMU sample every 1 ms, a frame every 20 ms.
void write_small(const TempFolder& folder) {
  std::string events, images, imu;
  for (int i = 0; i < 1000; ++i)
    events += fmt::format("{} {} {} {}\n", format_seconds(ms(0.1 * i)), i % 240, i % 180, i % 2);
  for (int i = 0; i < 100; ++i) imu += fmt::format("{} {} 2 9.81 0.1 0.2 0.3\n", format_seconds(ms(i)), i);
  for (int i = 0; i < 5; ++i) {
    images += fmt::format("{} images/{}.png\n", format_seconds(ms(20 * i)), i);
    folder.write_image(fmt::format("images/{}.png", i), 240, 180, 10 * i);
  }
  folder.write("events.txt", events);
  folder.write("images.txt", images);
  folder.write("imu.txt", imu);
  folder.write("groundtruth.txt", "0.0 1 2 3 0 0 0 1\n0.1 1 2 3 0 0 0 1\n");
}

TEST(Recording, EcdFolderGivesAllSensorsInOrder) {
  TempFolder folder;
  write_small(folder);
  Recording r = open_recording(folder.path());
  const DatasetInfo& info = r.dataset->info();
  EXPECT_EQ(info.format, "ecd");
  EXPECT_EQ(info.pose_frame, "events");
  EXPECT_TRUE(info.has_events && info.has_frames && info.has_imu);
  EXPECT_EQ(info.begin, ms(0));
  EXPECT_EQ(info.end, ms(99.9));
  EXPECT_FALSE(r.calibration);

  const Contents c = read_all(*r.dataset);
  EXPECT_EQ(c.events.size(), 1000u);
  EXPECT_EQ(c.imu.size(), 100u);
  ASSERT_EQ(c.frames.size(), 5u);
  EXPECT_EQ(c.frames[3].image.at<std::uint8_t>(5, 5), 30);
  EXPECT_EQ(c.frames[0].camera, "frames");
  EXPECT_EQ(c.imu[7].accel_B, Eigen::Vector3d(7, 2, 9.81));
  EXPECT_EQ(c.imu[7].gyro_B, Eigen::Vector3d(0.1, 0.2, 0.3));
  for (std::size_t i = 1; i < c.all.size(); ++i) EXPECT_LE(stamp_of(c.all[i - 1]), stamp_of(c.all[i]));
  // Equal stamps at 0: IMU, event, frame.
  EXPECT_TRUE(std::holds_alternative<ImuSample>(c.all[0]));
  ASSERT_TRUE(std::holds_alternative<EventBatch>(c.all[1]));
  EXPECT_EQ(std::get<EventBatch>(c.all[1]).events.size(), 1u);
  EXPECT_EQ(std::get<EventBatch>(c.all[1]).camera, "events");
  EXPECT_TRUE(std::holds_alternative<Frame>(c.all[2]));
  ASSERT_EQ(r.dataset->ground_truth()->trajectory.size(), 2u);
  EXPECT_EQ(r.dataset->ground_truth()->frame, "events");
  EXPECT_TRUE(r.dataset->repairs().empty());
}

TEST(Recording, EventBatchesAloneSpanAtMostFiveMilliseconds) {
  TempFolder folder;
  write_small(folder);
  std::filesystem::remove(folder.path() / "imu.txt");
  std::filesystem::remove(folder.path() / "images.txt");
  Recording r = open_recording(folder.path());
  EXPECT_FALSE(r.dataset->info().has_imu);
  std::size_t events = 0;
  while (const auto m = r.dataset->next()) {
    const auto& batch = std::get<EventBatch>(*m).events;
    events += batch.size();
    EXPECT_LE(batch.back().t - batch.front().t, std::chrono::milliseconds(5));
  }
  EXPECT_EQ(events, 1000u);
}

TEST(Recording, ReadsTwiceToTheSame) {
  TempFolder folder;
  write_small(folder);
  const Contents a = read_all(*open_recording(folder.path()).dataset),
                 b = read_all(*open_recording(folder.path()).dataset);
  EXPECT_EQ(a.events, b.events);
  EXPECT_EQ(a.all.size(), b.all.size());
}

TEST(Recording, DamageIsMendedAndCounted) {
  TempFolder folder;
  write_small(folder);
  folder.write(
      "imu.txt",
      "0.000 0 0 9.8 0 0 0\n0.001 0 0 9.8 0 0 0\n0.001 1 1 1 1 1 1\n0.002 nan 0 9.8 0 0 0\n0.0005 0 0 9.8 0 0 0\n"
      "77.0 0 0 9.8 0 0 0\n0.003 0 0 9.8 0 0 0\n0.004 0 0 9.8 0 0\n0.005 0 0 9.8 0 0 0\n0.006 0 0 9.8 0 0 0.12");
  std::filesystem::remove(folder.path() / "images" / "1.png");
  folder.write("images/2.png", "not a picture");
  folder.write_image("images/3.png", 100, 100);
  folder.write("groundtruth.txt", "0.0 1 2 3 0 0 0 1\nnan 1 2 3 0 0 0 1\n0.1 1 2 3 0 0 0 1\n");
  Recording r = open_recording(folder.path());
  const Contents c = read_all(*r.dataset);
  EXPECT_EQ(c.imu.size(), 5u) << "two of one stamp";
  EXPECT_EQ(c.frames.size(), 2u);
  EXPECT_EQ(r.dataset->ground_truth()->trajectory.size(), 2u);
  EXPECT_EQ(r.dataset->ground_truth()->trajectory.size(), 2u);
  const std::map<std::string, std::size_t> expected{
      {"imu: unreadable line", 2},          {"imu: out of order, dropped", 1},
      {"imu: stamp far ahead, dropped", 1}, {"imu: last line cut", 1},
      {"frames: image missing", 1},         {"frames: image unreadable", 1},
      {"frames: image of another size", 1}, {"groundtruth: bad line", 1}};
  EXPECT_EQ(r.dataset->repairs(), expected);
}

TEST(Recording, SurvivesEveryFileCutAtAnyPlace) {
  TempFolder folder;
  write_small(folder);
  for (const char* name : {"events.txt", "imu.txt", "images.txt", "groundtruth.txt"}) {
    const std::string whole = read_text(folder.path() / name);
    for (std::size_t percent = 0; percent < 100; percent += percent < 10 ? 1 : 9) {
      folder.write(name, whole.substr(0, whole.size() * percent / 100));
      Recording r = open_recording(folder.path());
      const Contents c = read_all(*r.dataset);
      EXPECT_NO_THROW(r.dataset->ground_truth()) << name << " " << percent;
      EXPECT_GE(c.all.size(), 25u);  // without the IMU: 20 batches and 5 frames
    }
    folder.write(name, whole);
  }
}

TEST(Recording, RandomDamageIsMendedOrRefusedButNeverWorse) {
  TempFolder folder;
  write_small(folder);
  folder.write("calibration.yaml", to_yaml(load_rig("davis240c_ecd")));
  const std::string bytes = "0123456789.-+e \n\r,#:[]{}naif\x01\xff";
  std::mt19937_64 random(3);
  for (const std::string name :
       {"events.txt", "imu.txt", "images.txt", "groundtruth.txt", "calibration.yaml", "images/1.png"}) {
    const std::string whole = read_text(folder.path() / name);
    for (int round = 0; round < 40; ++round) {
      std::string text = whole;
      for (int i = 0; i <= round; ++i) text[random() % text.size()] = bytes[random() % bytes.size()];
      folder.write(name, text);
      try {
        Recording r = open_recording(folder.path());
        const Contents c = read_all(*r.dataset);
        r.dataset->ground_truth();
        for (std::size_t i = 1; i < c.all.size(); ++i) ASSERT_LE(stamp_of(c.all[i - 1]), stamp_of(c.all[i]));
      } catch (const InputError& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      }
    }
    folder.write(name, whole);
  }
}

TEST(Recording, EmptyFilesAreCountedUntilNothingRemains) {
  TempFolder folder;
  write_small(folder);
  folder.write("events.txt", "");
  Recording r = open_recording(folder.path());
  EXPECT_FALSE(r.dataset->info().has_events);
  EXPECT_EQ(r.dataset->repairs().at("events: empty file"), 1u);
  folder.write("imu.txt", "");
  folder.write("images.txt", "# nothing\n");
  EXPECT_THAT(input_error([&] { open_recording(folder.path()); }),
              HasSubstr("nothing to read: events.txt, images.txt, imu.txt"));
}

std::string gzipped(const TempFolder& folder, const std::string& text) {
  const std::string file = (folder.path() / "packed").string();
  gzFile out = gzopen(file.c_str(), "wb");
  gzwrite(out, text.data(), static_cast<unsigned>(text.size()));
  gzclose(out);
  return read_text(file);
}

TEST(Recording, AFolderWithOneRecordingAndAnImuInACsvIsBoth) {
  TempFolder folder;
  write_small(folder);
  const auto loose = folder.path() / "loose";
  const std::string events = read_text(folder.path() / "events.txt");
  const std::string imu = "t[s],ax[m/s^2],ay,az,gx[rad/s],gy,gz\n" + read_text(folder.path() / "imu.txt");
  folder.write("loose/flight.csv", events);
  folder.write("loose/sensor.csv", imu);
  folder.write("loose/calibration.yaml", to_yaml(load_rig("davis240c_ecd")));
  folder.write("loose/weather.csv", "warm\n");
  Recording r = open_recording(loose);
  EXPECT_TRUE(r.dataset->info().has_events && r.dataset->info().has_imu);
  ASSERT_TRUE(r.calibration);
  std::size_t samples = 0;
  while (const auto m = r.dataset->next()) samples += std::holds_alternative<ImuSample>(*m) ? 1 : 0;
  EXPECT_EQ(samples, 100u);

  // An imu.txt without a heading does not make it a folder of the Event-Camera Dataset.
  std::filesystem::remove(loose / "sensor.csv");
  folder.write("loose/imu.txt", "0.0 0 0 9.81 0.1 0.2 0.3\n0.001 0 0 9.81 0.1 0.2 0.3\n0.002 0 0 9.81 0.1 0.2 0.3\n");
  const Recording named = open_recording(loose);
  EXPECT_EQ(named.dataset->info().format, "csv");
  EXPECT_TRUE(named.dataset->info().has_imu);

  // Packed text gives the same recording. If it is cut, the text before the cut is read.
  std::filesystem::remove(loose / "flight.csv");
  const std::string packed = gzipped(folder, events);
  folder.write("loose/flight.csv.gz", packed);
  EXPECT_TRUE(open_recording(loose).dataset->info().has_events);
  const auto count = [&](const std::string& bytes) {
    const auto file = folder.write("loose/flight.csv.gz", bytes);
    const Rig rig = load_rig("davis240c_ecd").rig;
    Recording alone = open_recording(file, &rig);
    std::size_t found = 0;
    while (const auto m = alone.dataset->next()) found += std::get<EventBatch>(*m).events.size();
    return std::pair(found, alone.dataset->repairs().size());
  };
  EXPECT_EQ(count(packed), std::pair(std::size_t{1000}, std::size_t{0}));
  const auto [cut, repairs] = count(packed.substr(0, packed.size() / 2));
  EXPECT_LT(cut, 1000u);
  EXPECT_GT(repairs, 0u);

  folder.write("loose/second.csv", events);
  EXPECT_THAT(input_error([&] { open_recording(loose); }), HasSubstr("flight.csv.gz, second.csv"));
}

TEST(Recording, UnknownFoldersAreRefusedWithWhatWasLookedFor) {
  TempFolder folder;
  EXPECT_THAT(input_error([&] { open_recording(folder.path()); }),
              ::testing::AllOf(HasSubstr("events.txt"), HasSubstr("cam0/data.csv")));
  EXPECT_THAT(input_error([&] { open_recording(folder.path() / "none"); }), HasSubstr("no such file or folder"));
  EXPECT_THAT(input_error([&] { open_recording(folder.write("a.bag", "x")); }), HasSubstr("give the folder"));
}

TEST(Recording, APipeIsRefusedAndNotWaitedFor) {
  TempFolder folder;
  for (const char* name : {"a.raw", "b.bag", "c.txt", "d.h5"}) {
    const auto pipe = folder.path() / name;
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_THAT(input_error([&] { open_recording(pipe); }), HasSubstr("not a file but a pipe"));
  }
  EXPECT_THAT(input_error([&] { open_recording(folder.path()); }), HasSubstr("a.raw: is not a file but a pipe"));
}

TEST(Recording, APipeInTheFolderOfARecordingIsNamedAndNotTakenForAMissingFile) {
  TempFolder folder;
  folder.write("events.txt", "0.1 30 20 1\n0.2 1 1 0\n");
  ASSERT_EQ(::mkfifo((folder.path() / "imu.txt").c_str(), 0600), 0);
  EXPECT_THAT(input_error([&] { open_recording(folder.path()); }), HasSubstr("imu.txt: is not a file but a pipe"));
}

TEST(Recording, SensorSizeComesFromTheRigElseTheImagesElseTheDavis) {
  TempFolder folder;
  folder.write("events.txt", "0.1 300 200 1\n0.2 1 1 0\n");
  const auto events = [&](const Rig* rig) {
    return read_all(*open_recording(folder.path(), rig).dataset).events.size();
  };
  EXPECT_EQ(events(nullptr), 1u);
  Rig rig;
  rig.cameras.push_back({"events", Modality::Events, CameraModel(320, 240, 200, 200, 160, 120), SE3(), Duration(0)});
  EXPECT_EQ(events(&rig), 2u);
  folder.write("images.txt", "0.0 images/a.png\n");
  folder.write_image("images/a.png", 346, 260);
  EXPECT_EQ(events(nullptr), 2u);
}

TEST(Recording, ReadsTheRealEventCameraDataset) {
  const auto path = data_folder() / "ecd" / "slider_depth";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no data";
  Recording r = open_recording(path);
  const Contents c = read_all(*r.dataset);
  EXPECT_EQ(r.dataset->info().name, "slider_depth");
  ASSERT_EQ(c.events.size(), 50'000u);
  EXPECT_EQ(c.events[1], (Event{timestamp_from_ns(3'820'001), 127, 171, false}));
  EXPECT_EQ(c.frames.size(), 87u);
  EXPECT_EQ(c.frames[0].image.size(), cv::Size(240, 180));
  EXPECT_FALSE(r.dataset->info().has_imu);
  EXPECT_EQ(r.dataset->ground_truth()->trajectory.size(), 339u);
  EXPECT_TRUE(r.dataset->repairs().empty());
}

TEST(Recording, ReadsTheRealEurocFolder) {
  const auto path = data_folder() / "euroc_mh01";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no data";
  for (const auto& folder : {path, path / "mav0"}) {
    Recording r = open_recording(folder);
    EXPECT_EQ(r.dataset->info().name, "euroc_mh01");
    EXPECT_EQ(r.dataset->info().pose_frame, "body");
    ASSERT_TRUE(r.calibration);
    EXPECT_EQ(r.calibration->rig.cameras[0].name, "cam0");
    const Contents c = read_all(*r.dataset);
    EXPECT_EQ(c.frames.size(), 220u);
    EXPECT_EQ(c.frames[0].camera, "cam0");
    ASSERT_EQ(c.imu.size(), 3231u);
    EXPECT_EQ(to_ns(c.imu[0].t), 1'403'636'579'758'555'584);
    EXPECT_EQ(c.imu[0].gyro_B, Eigen::Vector3d(-0.0991347015, 0.1473057889, 0.0272271363));
    EXPECT_EQ(c.imu[0].accel_B, Eigen::Vector3d(8.147691708, -0.3759215833, -2.40262925));
    EXPECT_EQ(r.dataset->ground_truth()->frame, "body");
    EXPECT_EQ(r.dataset->ground_truth()->trajectory.size(), 3015u);
    EXPECT_TRUE(r.dataset->repairs().empty());
  }
}

}  // namespace
}  // namespace edged
