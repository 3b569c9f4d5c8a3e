// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// AEDAT4: every compression, damage, the real recordings.
#include "edged/io/aedat/aedat.hpp"

#include <gmock/gmock.h>

#include <numbers>
#include <random>

#include "edged/io/aedat/aedat4_writer.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/damage_test_support.hpp"
#include "edged/io/parse/evt_test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

const cv::Size kDavis(346, 260);

using Compression = Aedat4Encoder::Compression;

Timestamp frame_time(int ms) { return timestamp_from_ns(1'000'000LL * ms); }

/// 100 packets of 100 events each, a frame in every tenth, an IMU sample in each.
struct SmallAedat4 {
  explicit SmallAedat4(int compression) : encoder(static_cast<Compression>(compression), kDavis) {
    parts.push_back(encoder.header());
    for (auto at = events.begin(); at < events.end(); at += 100) {
      if ((at - events.begin()) % 1000 == 0) {
        const cv::Mat image(2, 4, CV_8UC1, cv::Scalar(static_cast<double>((at - events.begin()) / 1000)));
        parts.push_back(encoder.frame({at->t, "frames", image}, std::chrono::milliseconds(2)));
      }
      const ImuSample sample{at->t, std::numbers::pi * Eigen::Vector3d(1, 0, -0.5), {0, 0, 9.80665}};
      parts.push_back(encoder.imu({&sample, 1}));
      parts.push_back(encoder.events({&*at, 100}));
    }
  }

  /// As after an interrupted recording: without a table at the end.
  std::string interrupted() const {
    std::string text;
    for (const std::string& part : parts) text += part;
    return text;
  }

  std::string whole() const {
    const std::string packets = interrupted(), header = encoder.header(static_cast<std::int64_t>(packets.size()));
    return header + packets.substr(header.size()) + encoder.table();
  }

  std::vector<Event> events = generated_events(10'000, kDavis.width, kDavis.height, 50);
  Aedat4Encoder encoder;
  std::vector<std::string> parts;  ///< header and packets
};

class Aedat4 : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(, Aedat4, ::testing::Range(0, 5));

TEST_P(Aedat4, GivesBackWhatWasWritten) {
  TempFolder folder;
  const SmallAedat4 small(GetParam());
  const std::vector<Event>& events = small.events;
  const Recording recording = open_recording(folder.write("a.aedat4", small.whole()));
  const DatasetInfo& info = recording.dataset->info();
  EXPECT_TRUE(info.has_events && info.has_frames && info.has_imu);
  EXPECT_EQ(info.begin, events.front().t);
  const Contents c = read_all(*recording.dataset);
  EXPECT_TRUE(c.events == events);
  ASSERT_EQ(c.frames.size(), 10u);
  EXPECT_EQ(c.frames[3].image.size(), cv::Size(4, 2));
  EXPECT_EQ(c.frames[3].image.at<std::uint8_t>(1, 3), 3);
  EXPECT_EQ(c.frames[3].t, events[3000].t);  // the middle of the exposure, not the stamp of the frame
  ASSERT_EQ(c.imu.size(), 100u);
  EXPECT_EQ(c.imu[7].t, events[700].t);
  EXPECT_TRUE(c.imu[7].accel_B.isApprox(Eigen::Vector3d(0, 0, 9.80665)));
  EXPECT_TRUE(c.imu[7].gyro_B.isApprox(std::numbers::pi * Eigen::Vector3d(1, 0, -0.5)));
  EXPECT_EQ(recording.dataset->info().end, events.back().t);
  EXPECT_TRUE(recording.dataset->repairs().empty());
}

TEST_P(Aedat4, AnInterruptedRecordingIsReadToItsEnd) {
  TempFolder folder;
  const SmallAedat4 small(GetParam());
  const Recording recording = open_recording(folder.write("a.aedat4", small.interrupted()));
  EXPECT_TRUE(read_all(*recording.dataset).events == small.events);
  EXPECT_THAT(recording.dataset->repairs(), ::testing::ElementsAre(::testing::Pair("file: no table", 1u)));
}

TEST_P(Aedat4, GoesOnBehindADamagedLength) {
  TempFolder folder;
  const SmallAedat4 small(GetParam());
  std::size_t at = 0;  // offset of the 21st packet of events
  for (std::size_t i = 0, events = 0; events < 21; at += small.parts[i++].size()) {
    EXPECT_LT(i, small.parts.size());
    if (small.parts[i + 1][0] == 0 && i > 0) ++events;
  }
  for (const std::string& text : {small.whole(), small.interrupted()})
    for (const std::int32_t wrong : {-1, 0x7fffffff, 10}) {
      std::string damaged = text;
      std::memcpy(damaged.data() + at + 4, &wrong, sizeof wrong);
      const Recording recording = open_recording(folder.write("a.aedat4", damaged));
      const std::vector<Event> read = read_all(*recording.dataset).events;
      EXPECT_GE(read.size(), small.events.size() - 100) << wrong;
      EXPECT_EQ(read.back(), small.events.back());
      EXPECT_EQ(recording.dataset->repairs().at("file: cut"), 1u);
    }
}

TEST_P(Aedat4, CutAnywhereItGivesTheWholePacketsBefore) {
  TempFolder folder;
  const SmallAedat4 small(GetParam());
  EXPECT_GE(expect_beginnings(folder, small.whole(), small.events), 9500u);
}

TEST_P(Aedat4, FlippedBitsAreRefusedOrMended) {
  TempFolder folder;
  const std::string whole = SmallAedat4(GetParam()).whole();
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    // In every third file, damages the header, where each bit matters.
    const std::string damaged = flip_bits(whole, random, 0, i % 3 == 0 ? 1000 : whole.size());
    for (const Event& e : read_damaged(folder, damaged).events) ASSERT_TRUE(e.x < 16384 && e.y < 16384);
  }
}

TEST(Aedat4File, ColourFramesBecomeGreyAndOthersAreCounted) {
  TempFolder folder;
  Aedat4Encoder encoder(Compression::Lz4, kDavis);
  std::string text = encoder.header();
  text += encoder.frame({frame_time(10), "", cv::Mat(1, 2, CV_8UC3, cv::Scalar(90, 90, 90))});
  text += encoder.frame({frame_time(20), "", cv::Mat(1, 2, CV_8UC4, cv::Scalar(50, 50, 50, 255))});
  text += encoder.frame({frame_time(30), "", cv::Mat(1, 2, CV_16UC1, cv::Scalar(1))});
  text += encoder.frame({frame_time(40), "", cv::Mat(1, 1, CV_8UC1, cv::Scalar(1))});
  const Recording recording = open_recording(folder.write("a.aedat4", text));
  const Contents c = read_all(*recording.dataset);
  ASSERT_EQ(c.frames.size(), 2u);
  EXPECT_EQ(c.frames[0].image.at<std::uint8_t>(0, 0), 90);
  EXPECT_EQ(c.frames[1].image.at<std::uint8_t>(0, 0), 50);
  EXPECT_EQ(recording.dataset->repairs().at("file: packet unreadable"), 2u);
}

TEST(Aedat4File, SeveralStreamsOfATypeAreAskedForWhereTheRigHasOneCamera) {
  TempFolder folder;
  const Rig rig = load_rig("davis240c_ecd").rig;
  const SmallAedat4 small(1);
  std::string text = small.interrupted();
  text.replace(text.find("FRME"), 4, "EVTS");  // stream 1 of the header becomes a second event camera
  const auto file = folder.write("a.aedat4", text);
  EXPECT_THAT(input_error([&] { open_recording(file, &rig); }),
              HasSubstr("--topic ROLE=NAME (or ROLE=none, CAMERA=NAME); events: events, frames"));
  const Recording chosen = open_recording(file, nullptr, {.topics = {{"events", "events"}}});
  EXPECT_EQ(read_all(*chosen.dataset).events.size(), 10'000u);
  text.replace(text.find("string\">frames") + 8, 6, "events");
  folder.write("a.aedat4", text);
  EXPECT_THAT(input_error([&] { open_recording(file, &rig); }), HasSubstr("events: events@edged#0, events@edged#1"));
  EXPECT_NO_THROW(open_recording(file, nullptr, {.topics = {{"events", "events@edged#0"}}}));
}

TEST(Aedat4File, RefusalsSayWhatIsWrong) {
  TempFolder folder;
  const auto refusal = [&](const std::string& content) {
    const auto file = folder.write("a.aedat4", content);
    return input_error([&] { open_recording(file); });
  };
  EXPECT_THAT(refusal("#!AER-DAT4.0\r\n"), HasSubstr("header is damaged"));
  EXPECT_THAT(refusal(Aedat4Encoder(Compression::Lz4, kDavis).header()), HasSubstr("nothing to read"));
  EXPECT_THAT(refusal(Aedat4Encoder(Compression::Lz4, {}).header()), HasSubstr("--geometry"));
  std::string unknown = Aedat4Encoder(Compression::ZstdHigh, kDavis).header();
  for (std::size_t at = 18; at < 80; at += 2)  // the number of the compression is somewhere among the first fields
    if (unknown[at] == 4 && unknown[at - 2] == 0 && unknown[at + 2] == 0) unknown[at] = 77;
  EXPECT_THAT(refusal(unknown), HasSubstr("header is damaged"));
  Aedat4Encoder encoder(Compression::Lz4, {100, 100});
  const std::vector<Event> events = generated_events(5000, kDavis.width, kDavis.height, 10);
  EXPECT_THAT(refusal(encoder.header() + encoder.events(events)), HasSubstr("outside"));
}

TEST(Aedat4File, ReadsTheRealDavis346Recordings) {
  const auto folder = data_folder() / "formats";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no data";
  struct Counts {
    const char* name;
    std::size_t events, frames, imu;
  };
  for (const Counts& want :
       {Counts{"davis346_0.17s.aedat4", 6676, 4, 160}, {"davis346_0.13s.aedat4", 117'667, 3, 130}}) {
    const Recording recording = open_recording(folder / want.name);
    const Contents c = read_all(*recording.dataset);
    EXPECT_EQ(c.events.size(), want.events);
    EXPECT_EQ(c.frames.size(), want.frames);
    EXPECT_EQ(c.imu.size(), want.imu);
    EXPECT_EQ(c.frames.at(0).image.size(), cv::Size(346, 260));
    EXPECT_NEAR(c.imu.at(0).accel_B.norm(), 9.81, 1.0);
    EXPECT_LT(c.imu.at(0).gyro_B.norm(), 10.0);
    for (const auto& [kind, count] : recording.dataset->repairs()) ADD_FAILURE() << kind << " " << count;
  }
}

}  // namespace
}  // namespace edged
