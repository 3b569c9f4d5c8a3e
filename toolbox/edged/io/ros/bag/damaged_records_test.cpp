// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What is lost of a bag when an opcode, a length, a checksum or an index is wrong, and that each difference is counted.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "edged/io/damage_test_support.hpp"
#include "edged/io/ros/bag/bag_test_support.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

template <typename T>
T number_in(const std::string& text, std::size_t at) {
  return ByteReader(as_bytes(std::string_view(text).substr(at))).number<T>();
}

/// A chunk in a bag or an MCAP file.
struct ChunkPlace {
  std::size_t begin, opcode, length, data;  ///< offsets of the record and of parts of it
};

std::vector<ChunkPlace> chunks_of(const std::string& text, bool mcap) {
  std::vector<ChunkPlace> chunks;
  for (std::size_t at = mcap ? kMcapMagic.size() : kBagMagic.size(); at + 13 < text.size();) {
    if (mcap) {
      if (text[at] == 6) chunks.push_back({at, at, at + 1, at + 9 + 40 + number_in<std::uint32_t>(text, at + 37)});
      at += 9 + number_in<std::uint64_t>(text, at + 1);
      continue;
    }
    const std::size_t length = at + 4 + number_in<std::uint32_t>(text, at), op = text.find("op=", at) + 3;
    if (text[op] == 5) chunks.push_back({at, op, length, length + 4});
    at = length + 4 + number_in<std::uint32_t>(text, length);
  }
  return chunks;
}

/// A small bag as a file of records, with an index or as after a crash of its recorder.
struct RecordBag {
  RecordBag(const BagContainer& container, bool indexed)
      : mcap(std::string(container.extension) == ".mcap"), bag(container.make(folder.path() / "unused")->wire()) {
    text = read_text(write_bag(folder, container, bag.topics));
    chunks = chunks_of(text, mcap);
    if (!indexed) text.replace(mcap ? text.size() - 28 : text.find("index_pos=") + 10, 8, 8, '\0');
  }

  /// Most events of a damaged file, with repairs beside that of a missing index.
  void expect_most(const std::string& damaged, const std::string& what) const {
    const DamagedRead read = read_damaged(folder, damaged);
    EXPECT_EQ(read.refusal, "") << what;
    EXPECT_GE(read.events.size(), bag.events.size() * 2 / 3) << what;
    EXPECT_LE(read.events.size(), bag.events.size()) << what;
    EXPECT_FALSE(read.events.empty() || !(read.events.back() == bag.events.back())) << what;
    EXPECT_GT(read.repairs.size(), read.repairs.count("bag: no index")) << what;
  }

  TempFolder folder;
  bool mcap;
  SmallBag bag;
  std::string text;
  std::vector<ChunkPlace> chunks;
};

const BagContainer kRecordContainers[] = {kBagContainers[0], kBagContainers[1], kBagContainers[2], kBagContainers[4]};

class DamagedRecords : public ::testing::TestWithParam<std::tuple<BagContainer, bool>> {
 protected:
  const RecordBag file_{std::get<0>(GetParam()), std::get<1>(GetParam())};
};

INSTANTIATE_TEST_SUITE_P(All, DamagedRecords,
                         ::testing::Combine(::testing::ValuesIn(kRecordContainers), ::testing::Bool()),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param).name) +
                                  (std::get<1>(test.param) ? "" : "_without_index");
                         });

TEST_P(DamagedRecords, AChunkIsReadWhateverItsOpcode) {
  for (const int wrong : {2, 4, 7, 15, 0x15, 0x86}) {
    std::string damaged = file_.text;
    damaged[file_.chunks[2].opcode] = static_cast<char>(wrong);
    const DamagedRead read = read_damaged(file_.folder, damaged);
    EXPECT_TRUE(read.events == file_.bag.events) << wrong << read.refusal;
    EXPECT_EQ(read.repairs.at("bag: record damaged"), 1u) << wrong;
  }
}

TEST_P(DamagedRecords, ReadingGoesOnBehindADamagedLength) {
  for (const int bit : {0, 4, 9, 14, 19, 27}) {
    std::string damaged = file_.text;
    damaged[file_.chunks[2].length + static_cast<unsigned>(bit) / 8] ^= static_cast<char>(1 << bit % 8);
    file_.expect_most(damaged, fmt::format("bit {}", bit));
  }
}

TEST_P(DamagedRecords, ReadingGoesOnBehindBytesThatAreInsertedOrLost) {
  for (const std::size_t place : {file_.chunks[2].begin, file_.chunks[2].begin + 3, file_.chunks[2].data + 50}) {
    file_.expect_most(std::string(file_.text).insert(place, "ab"), fmt::format("inserted at {}", place));
    file_.expect_most(std::string(file_.text).erase(place, 1), fmt::format("lost at {}", place));
  }
}

/// Pieces of records stand in compressed data, too.
TEST_P(DamagedRecords, CutWithinAChunkNothingIsTakenForARecord) {
  for (const std::size_t more : {100U, 500U, 900U}) {
    const DamagedRead read = read_damaged(file_.folder, file_.text.substr(0, file_.chunks[3].data + more));
    EXPECT_TRUE(std::equal(read.events.begin(), read.events.end(), file_.bag.events.begin()));
    EXPECT_EQ(read.repairs.count("bag: record damaged"), 0u);
  }
}

TEST(DamagedMcap, AChunkWhoseChecksumDiffersIsLeftOutAndCounted) {
  const RecordBag file(kBagContainers[2], true);
  std::string damaged = file.text;
  damaged[file.chunks[2].data + 900] ^= 4;
  const DamagedRead read = read_damaged(file.folder, damaged);
  EXPECT_EQ(read.repairs.at("bag: record damaged"), 1u);
  EXPECT_GT(read.repairs.at("bag: message missing"), 1u);
  EXPECT_LT(read.events.size(), file.bag.events.size());
  for (const Event& event : read.events) EXPECT_EQ(std::ranges::count(file.bag.events, event), 1);
}

TEST(DamagedMcap, ASummaryWhoseChecksumDiffersIsNotBelieved) {
  RecordBag file(kBagContainers[2], true);
  const std::size_t footer = file.text.size() - 8 - 20;
  file.text.replace(footer + 16, 4, "\x12\x34\x56\x78");
  const DamagedRead read = read_damaged(file.folder, file.text);
  EXPECT_TRUE(read.events == file.bag.events);
  EXPECT_EQ(read.repairs, (std::map<std::string, std::size_t>{{"bag: no index", 1}}));
}

/// Nothing else tells of it: a bag has no checksums.
TEST(DamagedBag, AMessageThatTheIndexCountsAndNoRecordHoldsIsMissing) {
  const RecordBag file(kBagContainers[0], true);
  std::string damaged = file.text;
  const std::size_t op = damaged.find(std::string("op=") + '\x02', file.chunks[2].data) + 3;
  damaged[op] = 3;
  const DamagedRead read = read_damaged(file.folder, damaged);
  EXPECT_EQ(read.repairs, (std::map<std::string, std::size_t>{{"bag: message missing", 1}}));
}

TEST(DamagedBag, AMessageOfAnUnknownTopicIsCountedAndTheOthersAreRead) {
  const RecordBag file(kBagContainers[0], false);
  std::string damaged = file.text;
  damaged[damaged.find("conn=", damaged.find(std::string("op=") + '\x02')) + 5] = 77;
  const DamagedRead read = read_damaged(file.folder, damaged);
  EXPECT_EQ(read.repairs.at("bag: message of an unknown topic"), 1u);
  EXPECT_GE(read.events.size(), file.bag.events.size() - 50);
}

TEST(DamagedMcap, AChunkThatClaimsAGigabyteIsRefusedBeforeItIsUnpacked) {
  const RecordBag file(kBagContainers[4], true);
  std::string damaged = file.text;
  for (const ChunkPlace& chunk : file.chunks)
    damaged.replace(chunk.begin + 9 + 16, 8, std::string("\0\0\0\x40\0\0\0\0", 8));
  const DamagedRead read = read_damaged(file.folder, damaged);
  EXPECT_TRUE(read.events.empty());
  EXPECT_THAT(read.refusal, HasSubstr("nothing to read"));
}

TEST(CutRecording, ThatIsCutWhileItIsReadEndsWithAnError) {
  TempFolder folder;
  for (const BagContainer& container : {kBagContainers[0], kBagContainers[2]}) {
    const SmallBag bag(container.make(folder.path() / "unused")->wire());
    const fs::path file = write_bag(folder, container, bag.topics);
    const Recording recording = open_recording(file);
    fs::resize_file(file, fs::file_size(file) / 2);
    EXPECT_THAT(input_error([&] { read_all(*recording.dataset); }), HasSubstr("was truncated while it was read"));
  }
}

TEST(Db3, ReadsTheLogOfARecorderThatWasKilledAndChangesNothing) {
  const SmallBag bag(Wire::Cdr);
  TempFolder folder;
  const fs::path running = folder.path() / "running.db3", killed = folder.path() / "rec" / "rec_0.db3";
  fs::create_directories(killed.parent_path());
  Db3Writer writer(running);
  writer.finish();
  writer.run("PRAGMA journal_mode=WAL");
  writer.run("PRAGMA wal_autocheckpoint=0");
  writer.run("BEGIN");
  write_bag(running, writer, bag.topics);
  for (const char* end : {"", "-wal"}) fs::copy_file(running.string() + end, killed.string() + end);
  const std::string before = read_text(killed), log = read_text(killed.string() + "-wal");
  const Recording recording = open_recording(killed.parent_path());
  EXPECT_TRUE(read_all(*recording.dataset).events == bag.events);
  EXPECT_TRUE(recording.dataset->repairs().empty());
  EXPECT_TRUE(read_text(killed) == before && read_text(killed.string() + "-wal") == log);
  EXPECT_FALSE(fs::exists(killed.string() + "-shm"));
}

TEST(Db3, AViewInPlaceOfATableIsRefusedAsItMayHaveNoEnd) {
  TempFolder folder;
  const fs::path file = folder.path() / "a.db3";
  Db3Writer writer(file);
  writer.add_topic("/imu", "sensor_msgs/Imu", {});
  writer.run("DROP TABLE messages");
  writer.run(
      "CREATE VIEW messages AS WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL SELECT id + 1 FROM n) "
      "SELECT id, 1 AS topic_id, id AS timestamp, x'00' AS data FROM n");
  writer.finish();
  EXPECT_THAT(input_error([&] { open_recording(file); }), HasSubstr("lacks the tables"));
}

TEST(Db3, CutInTheMiddleGivesItsFirstHalf) {
  SmallBag bag(Wire::Cdr);
  TempFolder folder;
  const std::string whole = read_text(write_bag(folder, kBagContainers[5], bag.topics));
  const DamagedRead read = read_damaged(folder, cut_at(whole, 60));
  EXPECT_GT(read.events.size(), bag.events.size() / 4);
  std::size_t others = 0;  // of a message whose last page is missing
  for (const Event& event : read.events) others += std::ranges::count(bag.events, event) == 0 ? 1 : 0;
  EXPECT_LE(others, 50u);
  EXPECT_TRUE(read.repairs.contains("bag: cut"));
}

/// rec_0 to rec_2, each with a third of the messages; the first two compressed as by the recorder.
std::vector<fs::path> write_parts(const fs::path& folder, const SmallBag& bag) {
  std::vector<fs::path> files;
  fs::create_directories(folder);
  for (std::size_t p = 0; p < 3; ++p) {
    std::vector<TestTopic> topics = bag.topics;
    for (TestTopic& topic : topics) {
      const auto all = topic.messages;
      topic.messages = {all.begin() + static_cast<std::ptrdiff_t>(all.size() * p / 3),
                        all.begin() + static_cast<std::ptrdiff_t>(all.size() * (p + 1) / 3)};
    }
    fs::path file = folder / fmt::format("rec_{}.db3", p);
    write_bag(file, *std::make_unique<Db3Writer>(file), topics);
    if (p < 2) {
      std::ofstream(file.string() + ".zstd", std::ios::binary) << compress("zstd", read_text(file));
      fs::remove(file);
      file += ".zstd";
    }
    files.push_back(file);
  }
  return files;
}

TEST(BagParts, AreReadInTheOrderOfTheirNumbersCompressedOrNot) {
  const SmallBag bag(Wire::Cdr);
  TempFolder folder;
  write_parts(folder.path() / "rec", bag);
  const Recording recording = open_recording(folder.path() / "rec");
  EXPECT_TRUE(read_all(*recording.dataset).events == bag.events);
  EXPECT_TRUE(recording.dataset->repairs().empty());
}

TEST(BagParts, OneThatCannotBeReadIsCountedByItsOwnNameAndTheOthersAreRead) {
  const SmallBag bag(Wire::Cdr);
  TempFolder folder;
  const std::vector<fs::path> files = write_parts(folder.path() / "rec", bag);
  fs::resize_file(files[1], 40);
  const Recording recording = open_recording(folder.path() / "rec");
  EXPECT_GT(read_all(*recording.dataset).events.size(), bag.events.size() / 2);
  EXPECT_EQ(recording.dataset->repairs().at("bag: part unreadable"), 1u);
  for (const fs::path& file : files) fs::resize_file(file, 40);
  EXPECT_THAT(input_error([&] { open_recording(folder.path() / "rec"); }), HasSubstr("rec_0.db3.zstd: not a ROS bag"));
}

}  // namespace
}  // namespace edged
