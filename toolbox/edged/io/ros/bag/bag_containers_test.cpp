// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Each container of messages: complete, compressed, split, without index and damaged.
#include <bzlib.h>
#include <gmock/gmock.h>

#include "edged/io/damage_test_support.hpp"
#include "edged/io/ros/bag/bag_test_support.hpp"
#include "edged/io/ros/bag/open_messages.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class BagContainers : public ::testing::TestWithParam<BagContainer> {
 protected:
  /// The wire format of the container.
  SmallBag small_bag() const { return SmallBag(GetParam().make(folder_.path() / "unused")->wire()); }
  fs::path write(const SmallBag& bag) const { return write_bag(folder_, GetParam(), bag.topics); }

  TempFolder folder_;
};

TEST_P(BagContainers, GiveBackEverySensorAndTheGroundTruth) {
  const SmallBag bag = small_bag();
  const Recording r = open_recording(write(bag));
  const DatasetInfo& info = r.dataset->info();
  EXPECT_EQ(info.event_sensor, kBagSensor);
  EXPECT_EQ(info.begin, timestamp_from_seconds(100));
  EXPECT_NEAR(to_seconds(*info.end), 100.195, 1e-3);
  const Contents c = read_all(*r.dataset);
  EXPECT_TRUE(c.events == bag.events);
  ASSERT_EQ(c.frames.size(), 8u);
  EXPECT_EQ(c.frames[3].image.at<std::uint8_t>(19, 29), 15);
  EXPECT_EQ(c.frames[3].t, timestamp_from_seconds(100.075));
  ASSERT_EQ(c.imu.size(), 40u);
  EXPECT_EQ(c.imu[7].gyro_B, Eigen::Vector3d(0.1 * 7, 1.0 / 3.0, -2.0));
  EXPECT_EQ(c.imu[7].accel_B, 3.0 * c.imu[7].gyro_B);
  const auto truth = r.dataset->ground_truth();
  ASSERT_TRUE(truth);
  ASSERT_EQ(truth->trajectory.size(), 40u);
  EXPECT_EQ(truth->frame, "body");
  EXPECT_EQ(truth->trajectory[7].T.translation(), c.imu[7].gyro_B);
  EXPECT_TRUE(r.dataset->repairs().empty());
}

TEST_P(BagContainers, CutAnywhereTheyGiveWhatIsWholeBefore) {
  const SmallBag bag = small_bag();
  const std::string whole = read_text(write(bag));
  if (std::string(GetParam().extension) != ".db3") {
    EXPECT_GE(expect_beginnings(folder_, whole, bag.events), bag.events.size() / 2);
    return;
  }
  for (std::size_t percent = 0; percent < 100; ++percent) {
    // The pages of SQLite lie in any order, and missing ones are read as zeros.
    const DamagedRead read = read_damaged(folder_, cut_at(whole, percent));
    EXPECT_LE(read.events.size(), bag.events.size());
    EXPECT_TRUE(!read.refusal.empty() || read.repairs.contains("bag: cut")) << percent;
  }
}

TEST_P(BagContainers, FlippedBitsAreRefusedOrMended) {
  const SmallBag bag = small_bag();
  const std::string whole = read_text(write(bag));
  std::mt19937 random(7);
  std::size_t read_events = 0;
  constexpr int kRounds = 300;
  for (int i = 0; i < kRounds; ++i)
    read_events += read_damaged(folder_, flip_bits(whole, random, 0, whole.size())).events.size();
  // One bit costs a message or a chunk, not the recording.
  EXPECT_GT(read_events, bag.events.size() * kRounds / 2);
}

/// The complete messages of a topic, and the repairs.
std::vector<std::string> messages_of(const fs::path& file, std::size_t topic, bool alone, Repairs& repairs) {
  std::vector<std::string> found;
  const auto source = open_messages(file, &repairs);
  while (const auto message = alone ? source->next_of(topic) : source->next())
    if (message->topic == topic) found.emplace_back(as_text(message->data));
  return found;
}

TEST_P(BagContainers, GiveTheMessagesOfOneTopicAlone) {
  SmallBag bag = small_bag();
  auto& poses = bag.topics[3].messages;
  poses.erase(poses.begin(), poses.end() - 3);  // the poses begin late
  const fs::path file = write(bag);
  Repairs repairs;
  for (std::size_t topic = 0; topic < bag.topics.size(); ++topic) {
    const std::vector<std::string> alone = messages_of(file, topic, true, repairs);
    EXPECT_EQ(alone.size(), bag.topics[topic].messages.size());
    EXPECT_EQ(alone, messages_of(file, topic, false, repairs));
  }
  EXPECT_TRUE(repairs.counts().empty());
}

INSTANTIATE_TEST_SUITE_P(All, BagContainers, ::testing::ValuesIn(kBagContainers),
                         [](const auto& test) { return std::string(test.param.name); });

/// Their damage would be counted.
TEST(BagContainer, OfOneTopicAloneChunksWithoutItAreNotRead) {
  for (const BagContainer& container : {kBagContainers[1], kBagContainers[3]}) {
    TempFolder folder;
    SmallBag bag(container.make(folder.path() / "unused")->wire());
    auto& poses = bag.topics[3].messages;
    poses.erase(poses.begin(), poses.end() - 3);
    std::string text = read_text(write_bag(folder, container, bag.topics));
    text[text.size() / 4] = static_cast<char>(text[text.size() / 4] ^ 0x55);
    const fs::path damaged = folder.write("damaged", text);
    Repairs of_all, of_poses;
    messages_of(damaged, 3, false, of_all);
    EXPECT_EQ(messages_of(damaged, 3, true, of_poses).size(), 3U);
    EXPECT_FALSE(of_all.counts().empty()) << container.name;
    EXPECT_TRUE(of_poses.counts().empty()) << container.name;
  }
}

TEST(BagContainer, AFileThatWasNeverFinishedIsReadThrough) {
  for (const auto& [container, wire] : {std::pair(kBagContainers[1], Wire::Ros1), {kBagContainers[4], Wire::Cdr}}) {
    TempFolder folder;
    const SmallBag bag(wire);
    std::string text = read_text(write_bag(folder, container, bag.topics));
    // Of an MCAP, the footer with the offset of the summary, 28 bytes before the magic at the end.
    text.replace(wire == Wire::Ros1 ? text.find("index_pos=") + 10 : text.size() - 8 - 20, 8, 8, '\0');
    const DamagedRead read = read_damaged(folder, text);
    EXPECT_TRUE(read.events == bag.events);
    EXPECT_EQ(read.repairs, (std::map<std::string, std::size_t>{{"bag: no index", 1}}));
  }
}

TEST(BagContainer, AnMcapWithOtherTopicsGivesThoseOfRosWithoutComplaint) {
  TempFolder folder;
  const SmallBag bag(Wire::Cdr);
  const fs::path file = folder.path() / "mixed.mcap";
  McapWriter writer(file, "");
  const std::size_t other = writer.add_topic({"/camera", "json", "sensor_msgs/Image", "jsonschema", "{}"});
  for (const TestTopic& topic : bag.topics) {
    const std::size_t id = writer.add_topic({topic.name, "cdr", topic.type, "ros2msg", topic.definition.text});
    for (const auto& [t, message] : topic.messages) writer.write(id, t, message), writer.write(other, t, "{}");
  }
  writer.write_metadata("of", {{"no", "interest"}});
  writer.finish();
  const Recording r = open_recording(file);
  const Contents c = read_all(*r.dataset);
  EXPECT_TRUE(c.events == bag.events);
  EXPECT_EQ(c.frames.size(), 8u);
  EXPECT_TRUE(r.dataset->repairs().empty());
}

TEST(BagContainer, ADamagedChunkCostsOnlyItselfWhereThereIsAnIndex) {
  for (const std::size_t which : {0u, 2u}) {  // not compressed
    TempFolder folder;
    const SmallBag bag(which == 0 ? Wire::Ros1 : Wire::Cdr);
    std::string text = read_text(write_bag(folder, kBagContainers[which], bag.topics));
    const std::size_t middle = text.size() / 2;
    for (std::size_t i = 0; i < 600; ++i) text[middle + i] = '\xFF';
    const DamagedRead read = read_damaged(folder, text);
    EXPECT_GE(read.events.size(), bag.events.size() * 7 / 10);
    EXPECT_LT(read.events.size(), bag.events.size());
    EXPECT_FALSE(read.repairs.empty());
  }
}

TEST(BagContainer, AWrongLengthOfAChunkCostsNothingWhereThereIsAnIndex) {
  TempFolder folder;
  const SmallBag bag(Wire::Ros1);
  std::string text = read_text(write_bag(folder, kBagContainers[0], bag.topics));
  std::size_t at = text.find("compression=none");
  at = text.find("size=", text.find("compression=none", at + 1)) + 9;  // the length of the data of the second chunk
  const std::uint32_t wrong = static_cast<std::uint32_t>(text.size() / 2);
  std::memcpy(text.data() + at, &wrong, sizeof wrong);
  const DamagedRead read = read_damaged(folder, text);
  EXPECT_TRUE(read.events == bag.events);
  EXPECT_EQ(read.repairs.at("bag: record damaged"), 1u);
}

std::string pack_bz2(std::string_view bytes) {
  std::string packed(bytes.size() + bytes.size() / 100 + 600, '\0');
  auto size = static_cast<unsigned>(packed.size());
  BZ2_bzBuffToBuffCompress(packed.data(), &size, const_cast<char*>(bytes.data()), static_cast<unsigned>(bytes.size()),
                           9, 0, 0);
  packed.resize(size);
  return packed;
}

/// An uncompressed bag, cut after its first chunk, which is then compressed. The rest is left out, as its index is no
/// longer valid.
TEST(BagContainer, ChunksCompressedByBzip2AreRead) {
  TempFolder folder;
  const SmallBag bag(Wire::Ros1);
  const fs::path file = folder.path() / "whole.bag";
  const auto writer = create_ros1_bag(file, {.compression = "none", .bytes = 1U << 24U});
  const std::string text = read_text(write_bag(file, *writer, bag.topics));
  constexpr std::size_t kChunk = 13 + 4096;
  const auto number = [&](std::size_t at) {
    return ByteReader(as_bytes(std::string_view(text).substr(at))).number<std::uint32_t>();
  };
  const std::size_t header_bytes = number(kChunk), data = kChunk + 4 + header_bytes + 4;
  std::string header = text.substr(kChunk + 4, header_bytes);
  const std::string field = std::string("\x10\0\0\0", 4) + "compression=none";
  ASSERT_NE(header.find(field), std::string::npos);
  header.replace(header.find(field), field.size(), std::string("\x0f\0\0\0", 4) + "compression=bz2");
  const std::string packed = pack_bz2(std::string_view(text).substr(data, number(data - 4)));
  std::string out = text.substr(0, kChunk);
  append_sized(out, header);
  append_sized(out, packed);
  EXPECT_TRUE(read_all(*open_recording(folder.write("bz2.bag", out)).dataset).events == bag.events);
}

/// The recording in three files, as a recorder splits them.
std::vector<std::vector<TestTopic>> three_parts(const SmallBag& bag) {
  std::vector<std::vector<TestTopic>> parts(3, bag.topics);
  for (std::size_t p = 0; p < 3; ++p)
    for (std::size_t i = 0; i < bag.topics.size(); ++i) {
      const auto& all = bag.topics[i].messages;
      const auto cut = [&](std::size_t k) { return all.begin() + static_cast<std::ptrdiff_t>(all.size() * k / 3); };
      parts[p][i].messages.assign(cut(p), cut(p + 1));
    }
  return parts;
}

TEST(BagFolder, GivesItsFilesInTheOrderOfTheirNumbers) {
  const SmallBag bag(Wire::Cdr);
  const auto parts = three_parts(bag);
  for (const BagContainer& container : {kBagContainers[2], kBagContainers[5]}) {
    TempFolder folder;
    const std::string names[] = {"rec_2", "rec_9", "rec_10"};
    for (std::size_t p = 0; p < 3; ++p) {
      const fs::path file = folder.path() / (names[p] + container.extension);
      write_bag(file, *container.make(file), parts[p]);
    }
    std::string list = "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n";
    for (const std::string& name : names) list += fmt::format("    - {}{}\n", name, container.extension);
    folder.write("metadata.yaml", list);
    const Recording r = open_recording(folder.path());
    EXPECT_TRUE(read_all(*r.dataset).events == bag.events);
    EXPECT_EQ(r.dataset->ground_truth()->trajectory.size(), 40u);
    EXPECT_TRUE(r.dataset->repairs().empty());
  }
}

TEST(BagFolder, UnpacksFilesThatTheRecorderCompressedAndLeavesNothingBehind) {
  const SmallBag bag(Wire::Cdr);
  const auto parts = three_parts(bag);
  TempFolder folder;
  const fs::path recording = folder.path() / "rec", scratch = folder.path() / "scratch";
  fs::create_directories(scratch);
  for (std::size_t p = 0; p < 3; ++p) {
    const fs::path file = scratch / fmt::format("rec_{}.db3", p);
    Db3Writer writer(file);
    folder.write(fmt::format("rec/rec_{}.db3.zstd", p), compress("zstd", read_text(write_bag(file, writer, parts[p]))));
    fs::remove(file);
  }
  ::setenv("TMPDIR", scratch.c_str(), 1);
  const Recording r = open_recording(recording);
  EXPECT_TRUE(fs::is_empty(scratch));
  EXPECT_TRUE(read_all(*r.dataset).events == bag.events);
  EXPECT_TRUE(r.dataset->repairs().empty());
  // After a cut, the tables of SQLite may be missing: that is reported, and nothing else fails.
  const std::string packed = read_text(recording / "rec_1.db3.zstd");
  folder.write("rec/rec_1.db3.zstd", packed.substr(0, packed.size() / 2));
  std::map<std::string, std::size_t> repairs;
  const std::string refusal = input_error([&] {
    const Recording cut = open_recording(recording);
    read_all(*cut.dataset);
    repairs = cut.dataset->repairs();
  });
  EXPECT_TRUE(repairs.contains("bag: cut") || !refusal.empty());
  ::unsetenv("TMPDIR");
}

/// name_0.bag to name_2.bag, as `rosbag record --split` writes them.
void write_split_bag(const fs::path& folder, const std::vector<std::vector<TestTopic>>& parts) {
  fs::create_directories(folder);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const fs::path file = folder / fmt::format("name_{}.bag", p);
    write_bag(file, *make_bag(file, "lz4"), parts[p]);
  }
}

TEST(SplitBag, IsOneRecordingByItsFolderAndByItsFirstPart) {
  const SmallBag bag(Wire::Ros1);
  TempFolder folder;
  write_split_bag(folder.path() / "rec", three_parts(bag));
  for (const char* name : {"rec", "rec/name_0.bag"}) {
    const Recording r = open_recording(folder.path() / name);
    EXPECT_TRUE(read_all(*r.dataset).events == bag.events) << name;
    EXPECT_EQ(r.dataset->ground_truth()->trajectory.size(), 40u);
    EXPECT_TRUE(r.dataset->repairs().empty());
  }
  EXPECT_LT(read_all(*open_recording(folder.path() / "rec/name_1.bag").dataset).events.size(), bag.events.size());
}

TEST(SplitBag, AMissingPartIsCountedAndTheOthersAreRead) {
  const SmallBag bag(Wire::Ros1);
  for (const char* gone : {"rec/name_0.bag", "rec/name_1.bag"}) {
    TempFolder folder;
    write_split_bag(folder.path() / "rec", three_parts(bag));
    fs::remove(folder.path() / gone);
    const Recording r = open_recording(folder.path() / "rec");
    const std::size_t events = read_all(*r.dataset).events.size();
    EXPECT_GT(events, bag.events.size() / 2);
    EXPECT_LT(events, bag.events.size());
    EXPECT_EQ(r.dataset->repairs().at("bag: part missing"), 1u);
  }
}

TEST(SplitBag, BagsOfOtherTimesAreRecordingsOfTheirOwn) {
  const SmallBag bag(Wire::Ros1);
  TempFolder folder;
  auto parts = three_parts(bag);
  for (TestTopic& topic : parts[1])
    for (auto& message : topic.messages) message.first += std::chrono::minutes(5);
  write_split_bag(folder.path() / "rec", parts);
  const std::size_t events = read_all(*open_recording(folder.path() / "rec/name_0.bag").dataset).events.size();
  EXPECT_GT(events, 0u);
  EXPECT_LT(events, bag.events.size() / 2);
}

TEST(BagFolder, ACompressedFileThatIsNoBagIsRefused) {
  TempFolder folder;
  const fs::path file = folder.write("a.zst", compress("zstd", "anything"));
  EXPECT_THAT(input_error([&] { open_recording(file); }), HasSubstr("not a ROS bag"));
}

}  // namespace
}  // namespace edged
