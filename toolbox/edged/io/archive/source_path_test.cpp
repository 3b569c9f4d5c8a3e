// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Recordings in zip archives: equal to unpacked ones, damaged, refused.
#include "edged/io/archive/source_path.hpp"

#include <gmock/gmock.h>
#include <zip.h>

#include <random>

#include "edged/io/calibration.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/parse/text_parsing.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

using Files = std::vector<std::pair<std::string, std::string>>;  // name, content

/// method: ZIP_CM_STORE or ZIP_CM_DEFLATE.
std::filesystem::path write_zip(const std::filesystem::path& file, const Files& files, int method = ZIP_CM_DEFLATE) {
  std::filesystem::remove(file);
  int error = 0;
  zip_t* archive = zip_open(file.c_str(), ZIP_CREATE, &error);
  EXPECT_TRUE(archive) << error;
  for (const auto& [name, content] : files) {
    const auto index =
        zip_file_add(archive, name.c_str(), zip_source_buffer(archive, content.data(), content.size(), 0), 0);
    EXPECT_GE(index, 0) << name;
    zip_set_file_compression(archive, static_cast<zip_uint64_t>(index), method, 1);
  }
  EXPECT_EQ(zip_close(archive), 0);
  return file;
}

std::string png_of(int gray) { return std::string(as_text(encode_png(cv::Mat(180, 240, CV_8UC1, cv::Scalar(gray))))); }

/// 2000 events, 100 IMU samples, 3 frames, ground truth, calibration; below `folder`.
Files packed_ecd(const std::string& folder = "") {
  std::string events, imu;
  const auto t = [](int us) { return format_seconds(timestamp_from_ns(1000LL * us)); };
  for (int i = 0; i < 2000; ++i) events += fmt::format("{} {} {} {}\n", t(50 * i), i % 240, i % 180, i % 2);
  for (int i = 0; i < 100; ++i) imu += fmt::format("{} {} 2 9.81 0.1 0.2 0.3\n", t(1000 * i), i);
  return {{folder + "events.txt", events},
          {folder + "imu.txt", imu},
          {folder + "images.txt", "0.0 images/a.png\n0.04 images/b.png\n0.08 ./images/c.png\n"},
          {folder + "images/a.png", png_of(10)},
          {folder + "images/b.png", png_of(20)},
          {folder + "images/c.png", png_of(30)},
          {folder + "groundtruth.txt", "0.0 1 2 3 0 0 0 1\n0.1 1 2 3 0 0 0 1\n"},
          {folder + "calibration.yaml", to_yaml(load_rig("davis240c_ecd"))}};
}

Contents check_same(const std::filesystem::path& archive) {
  const Recording recording = open_recording(archive);
  EXPECT_EQ(recording.dataset->info().format, "ecd");
  EXPECT_TRUE(recording.calibration && recording.calibration->has_extrinsics);
  Contents c = read_all(*recording.dataset);
  EXPECT_EQ(c.events.size(), 2000u);
  EXPECT_EQ(c.imu.size(), 100u);
  EXPECT_EQ(c.frames.size(), 3u);
  EXPECT_EQ(recording.dataset->ground_truth()->trajectory.size(), 2u);
  EXPECT_TRUE(recording.dataset->repairs().empty());
  return c;
}

TEST(ZippedRecording, GivesWhatTheFolderGives) {
  TempFolder folder;
  for (const auto& [name, content] : packed_ecd()) folder.write("flight/" + name, content);
  const Contents unpacked = check_same(folder.path() / "flight");
  for (const int method : {ZIP_CM_STORE, ZIP_CM_DEFLATE})
    for (const std::string top : {"", "flight/", "./", "flight\\"}) {
      const Contents packed = check_same(write_zip(folder.path() / "a.zip", packed_ecd(top), method));
      EXPECT_TRUE(packed.events == unpacked.events);
      ASSERT_EQ(packed.all.size(), unpacked.all.size());
      for (std::size_t i = 0; i < packed.all.size(); ++i)
        EXPECT_EQ(packed.all[i].index(), unpacked.all[i].index()) << i;
      EXPECT_EQ(packed.frames[2].image.at<std::uint8_t>(0, 0), 30);
    }
  EXPECT_EQ(open_recording(folder.path() / "a.zip").dataset->info().name, "flight");
  EXPECT_EQ(open_recording(write_zip(folder.path() / "b.zip", packed_ecd())).dataset->info().name, "b");
}

TEST(ZippedRecording, EurocFoldersAreReadToo) {
  const auto real = data_folder() / "euroc_mh01";
  if (!std::filesystem::exists(real)) GTEST_SKIP() << "no data";
  TempFolder folder;
  Files files;
  for (const char* name : {"mav0/imu0/data.csv", "mav0/imu0/sensor.yaml", "mav0/cam0/sensor.yaml",
                           "mav0/state_groundtruth_estimate0/data.csv"})
    files.emplace_back(name, read_text(real / name));
  files.emplace_back("mav0/cam0/data.csv", "#timestamp\n1403636579763555584,a.png\n");
  files.emplace_back("mav0/cam0/data/a.png", png_of(99));
  const Recording recording = open_recording(write_zip(folder.path() / "MH_01.zip", files));
  EXPECT_EQ(recording.dataset->info().name, "MH_01");
  EXPECT_EQ(recording.calibration->rig.cameras.at(0).name, "cam0");
  const Contents c = read_all(*recording.dataset);
  EXPECT_EQ(c.imu.size(), 3231u);
  EXPECT_EQ(c.frames.size(), 1u);
  EXPECT_EQ(recording.dataset->ground_truth()->trajectory.size(), 3015u);
}

TEST(ZippedRecording, WhatComesBeforeDamageIsRead) {
  TempFolder folder;
  for (const int method : {ZIP_CM_STORE, ZIP_CM_DEFLATE}) {
    const auto file = write_zip(folder.path() / "a.zip", packed_ecd(), method);
    std::string bytes = read_text(file);
    const std::size_t middle = bytes.find("imu.txt") * 9 / 10;  // within events.txt, the first of the archive
    for (std::size_t i = 0; i < 100; ++i) bytes[middle + i] = '\xff';
    const Recording recording = open_recording(folder.write("a.zip", bytes));
    const Contents c = read_all(*recording.dataset);
    EXPECT_GT(c.events.size(), 1000u);
    EXPECT_EQ(c.imu.size(), 100u);
    EXPECT_EQ(c.frames.size(), 3u);
    EXPECT_EQ(recording.dataset->repairs().at("events: file cut by damage"), 1u);
  }
}

TEST(ZippedRecording, WhatUnpacksToFarMoreThanSensorsWriteIsNotReadToItsEnd) {
  TempFolder folder;
  Files files = packed_ecd();
  const std::string comment = "#" + std::string(60'000, ' ') + "\n";
  for (int i = 0; i < 1400; ++i) files[0].second += comment;  // 84 MB
  const Recording recording = open_recording(write_zip(folder.path() / "a.zip", files));
  EXPECT_EQ(read_all(*recording.dataset).events.size(), 2000u);
  EXPECT_EQ(recording.dataset->repairs().at("events: file cut by damage"), 1u);
}

TEST(ZippedRecording, CutAnywhereIsRefusedInOneLine) {
  TempFolder folder;
  const std::string whole = read_text(write_zip(folder.path() / "a.zip", packed_ecd()));
  for (std::size_t percent = 0; percent < 100; ++percent) {
    const auto file = folder.write("cut.zip", whole.substr(0, whole.size() * percent / 100));
    const std::string message = input_error([&] { read_all(*open_recording(file).dataset); });
    EXPECT_THAT(message, HasSubstr("cut.zip"));  // the list of files lies at the end of an archive
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(ZippedRecording, FlippedBitsAreMendedOrRefused) {
  TempFolder folder;
  const std::string whole = read_text(write_zip(folder.path() / "a.zip", packed_ecd()));
  std::mt19937 random(7);
  for (int i = 0; i < 400; ++i) {
    std::string damaged = whole;
    // In every third archive, damages the list of files at its end.
    const std::size_t at = i % 3 == 0 ? whole.size() - 1 - random() % 600 : random() % whole.size();
    damaged[at] = static_cast<char>(damaged[at] ^ 1 << random() % 8);
    const auto file = folder.write("a.zip", damaged);
    const std::string message = input_error([&] {
      const Recording recording = open_recording(file);
      for (const Event& e : read_all(*recording.dataset).events) ASSERT_TRUE(e.x < 240 && e.y < 180);
      recording.dataset->ground_truth();
    });
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST(ZippedRecording, RefusalsSayWhatIsWrong) {
  TempFolder folder;
  const auto refusal = [&](const Files& files) {
    const auto file = write_zip(folder.path() / "a.zip", files);
    return input_error([&] { read_all(*open_recording(file).dataset); });
  };
  EXPECT_THAT(refusal({{"readme.txt", "x"}}), HasSubstr("no recording at the top of the archive"));
  EXPECT_THAT(refusal({{"a/events.txt", "0.1 1 1 1\n"}, {"b/events.txt", "0.1 1 1 1\n"}}),
              HasSubstr("several recordings (a, b)"));
  int error = 0;
  zip_t* archive = zip_open(write_zip(folder.path() / "a.zip", packed_ecd()).c_str(), 0, &error);
  zip_file_set_encryption(archive, 0, ZIP_EM_AES_256, "secret");
  zip_close(archive);
  EXPECT_THAT(input_error([&] { open_recording(folder.path() / "a.zip"); }), HasSubstr("a.zip/events.txt"));
}

}  // namespace
}  // namespace edged
