// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Prophesee files: old and new headers, damage, the real one.
#include "edged/io/prophesee/raw.hpp"

#include <gmock/gmock.h>

#include <random>

#include "edged/io/damage_test_support.hpp"
#include "edged/io/parse/evt_test_support.hpp"

namespace edged {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct RawFile {
  std::string name, header;
  EvtFormat format;
};

class PropheseeFile : public ::testing::TestWithParam<RawFile> {};

const std::string kDatType{'\x0C', '\x08'};

INSTANTIATE_TEST_SUITE_P(
    , PropheseeFile,
    ::testing::Values(
        RawFile{"evt3", "% date 2023-03-29 16:37:46\n% evt 3.0\n% format EVT3;height=720;width=1280\n% end\n",
                EvtFormat::Evt3},
        RawFile{"evt3_geometry_only", "% evt 3.0\r\n% geometry 1280x720\r\n% end\r\n", EvtFormat::Evt3},
        RawFile{"evt2_without_end", "% evt 2.0\n% plugin_name hal_plugin_gen41_evk2\n", EvtFormat::Evt2},
        RawFile{"evt21", "% format EVT21;endianness=little;height=720;width=1280\n% end\n", EvtFormat::Evt21},
        RawFile{"evt21_of_two_keys", "% evt 2.1\n% endianness little\n% geometry 1280x720\n% end\n", EvtFormat::Evt21},
        RawFile{"evt21_halves_swapped", "% format EVT21;height=720;width=1280\n% end\n", EvtFormat::Evt21Legacy},
        RawFile{"evt4", "% evt 4.0\n% format EVT4;height=720;width=1280\n% end\n", EvtFormat::Evt4},
        RawFile{"evt4_of_one_key", "% evt 4.0\n% geometry 1280x720\n% end\n", EvtFormat::Evt4},
        RawFile{"dat", "% Data file containing CD events\n% Version 2\n% Width 1280\n% Height 720\n" + kDatType,
                EvtFormat::Dat}),
    [](const auto& parameter) { return parameter.param.name; });

TEST_P(PropheseeFile, GivesBackEveryEvent) {
  TempFolder folder;
  const std::vector<Event> events = generated_events(200'000, 1280, 720, 20);
  const auto file = folder.write("a.bin", GetParam().header + AnyEvtEncoder(GetParam().format).encode(events));
  const Recording recording = open_recording(file);
  const DatasetInfo& info = recording.dataset->info();
  EXPECT_TRUE(info.has_events && !info.has_frames && !info.has_imu);
  EXPECT_EQ(info.name, "a");
  EXPECT_EQ(info.begin, events.front().t);
  EXPECT_EQ(info.end.value_or(events.back().t), events.back().t);
  const bool wraps = GetParam().format == EvtFormat::Evt3 || GetParam().format == EvtFormat::Dat;
  EXPECT_EQ(info.end.has_value(), !wraps);  // if the counter may have wrapped, the end is unknown
  const Contents c = read_all(*recording.dataset);
  EXPECT_TRUE(c.events == events);
  EXPECT_TRUE(recording.dataset->repairs().empty());
  for (const Measurement& m : c.all) {
    const auto& batch = std::get<EventBatch>(m);
    EXPECT_EQ(batch.camera, "events");
    EXPECT_LE(batch.events.back().t - batch.events.front().t, std::chrono::milliseconds(5));
  }
}

TEST_P(PropheseeFile, CutAnywhereItGivesWhatCameBefore) {
  TempFolder folder;
  const std::vector<Event> events = generated_events(2000, 1280, 720, 20);
  const std::string whole = GetParam().header + AnyEvtEncoder(GetParam().format).encode(events);
  EXPECT_GT(expect_beginnings(folder, whole, events), 1900u);
  for (std::size_t percent = 0; percent < 100; ++percent) {
    const DamagedRead read = read_damaged(folder, cut_at(whole, percent));
    EXPECT_EQ(read.refusal.empty(), !read.events.empty()) << percent;
  }
}

TEST_P(PropheseeFile, FlippedBitsAreSurvived) {
  TempFolder folder;
  const std::vector<Event> events = generated_events(2000, 1280, 720, 100);
  const std::string &header = GetParam().header, whole = header + AnyEvtEncoder(GetParam().format).encode(events);
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    // In every third file, damages the header, which may change the format.
    if (i % 3 == 0) {
      read_damaged(folder, flip_bits(whole, random, 0, 200));
      continue;
    }
    const DamagedRead read = read_damaged(folder, flip_bits(whole, random, header.size(), whole.size()));
    EXPECT_EQ(read.refusal, "");
    EXPECT_GT(read.events.size(), 1500u);
  }
}

std::string refusal(const std::string& content) {
  TempFolder folder;
  const auto file = folder.write("a.raw", content);
  return input_error([&] { open_recording(file); });
}

TEST(PropheseeRaw, ALostByteCostsFewEvents) {
  TempFolder folder;
  const std::vector<Event> events = generated_events(200'000, 1280, 720, 20);
  for (const EvtFormat format : {EvtFormat::Evt3, EvtFormat::Evt2, EvtFormat::Evt21Legacy, EvtFormat::Evt4}) {
    const std::string words = AnyEvtEncoder(format).encode(events);
    const std::map<EvtFormat, std::string> names{{EvtFormat::Evt3, "EVT3"},
                                                 {EvtFormat::Evt2, "EVT2"},
                                                 {EvtFormat::Evt21Legacy, "EVT21"},
                                                 {EvtFormat::Evt4, "EVT4"}};
    const std::string& name = names.at(format);
    for (const std::size_t lost : {1U, 3U}) {
      const std::string cut = std::string(words).erase(words.size() / 3, lost).erase(words.size() / 2, 1);
      const DamagedRead read = read_damaged(folder, "% format " + name + ";height=720;width=1280\n% end\n" + cut);
      EXPECT_EQ(read.refusal, "") << name;
      EXPECT_GT(read.events.size(), events.size() - 2000) << name;
      EXPECT_TRUE(read.events.back() == events.back()) << name;
      EXPECT_EQ(read.repairs.at("file: bytes missing"), 2u) << name;
    }
  }
}

/// Of 25 pulses at input 2, 40 ms apart, each with both edges, between two events.
std::string words_with_triggers(EvtFormat format) {
  const std::vector<Event> events = generated_events(2, 640, 480, 1);
  std::string out = AnyEvtEncoder(format).encode(events);
  const auto time_and_trigger = [&](std::int64_t t_us, unsigned value) {
    const auto high = static_cast<std::uint32_t>(t_us >> 6), low = static_cast<std::uint32_t>(t_us & 63);
    const std::uint32_t trigger = low << 22 | 2U << 8 | value;
    if (format == EvtFormat::Evt3) {
      append_number(out, static_cast<std::uint16_t>(0x8000 | t_us >> 12));
      append_number(out, static_cast<std::uint16_t>(0x6000 | (t_us & 0xFFF)));
      append_number(out, static_cast<std::uint16_t>(0xA000 | 2 << 8 | value));
    } else if (format == EvtFormat::Evt21) {
      append_number(out, std::uint64_t{0x80000000U | high} << 32);
      append_number(out, std::uint64_t{0xA0000000U | trigger} << 32);
    } else {
      append_number(out, (format == EvtFormat::Evt4 ? 0xE0000000U : 0x80000000U) | high);
      append_number(out, (format == EvtFormat::Evt4 ? 0x90000000U : 0xA0000000U) | trigger);
    }
  };
  for (int pulse = 0; pulse < 25; ++pulse) {
    time_and_trigger(100'000 + 40'000 * pulse, 1);
    time_and_trigger(100'500 + 40'000 * pulse, 0);
  }
  return out;
}

TEST(PropheseeRaw, PulsesOfTheTriggerInputAreListedWithTheirPeriod) {
  const TempFolder folder;
  for (const auto& [name, format] :
       {std::pair("EVT2", EvtFormat::Evt2), std::pair("EVT3", EvtFormat::Evt3),
        std::pair("EVT21;endianness=little", EvtFormat::Evt21), std::pair("EVT4", EvtFormat::Evt4)}) {
    const std::string header = std::string("% format ") + name + ";height=480;width=640\n% end\n";
    const Recording recording = open_recording(folder.write("a.raw", header + words_with_triggers(format)));
    EXPECT_EQ(read_all(*recording.dataset).events.size(), 2u);
    const std::vector<StreamInfo>& streams = recording.dataset->info().streams;
    ASSERT_EQ(streams.size(), 1u) << name;
    EXPECT_EQ(streams[0].name, "trigger 2");
    EXPECT_EQ(streams[0].type, "pulses, every 40.000 ms");
    EXPECT_EQ(streams[0].count, 25u);
    EXPECT_TRUE(recording.dataset->repairs().empty());
  }
}

TEST(PropheseeRaw, RefusalsSayWhatIsWrongAndWhatToDo) {
  const std::string evt2 = AnyEvtEncoder(EvtFormat::Evt2).encode(generated_events(10, 100, 100, 1));
  EXPECT_THAT(refusal("% evt 2.0\n% end\n" + evt2), HasSubstr("--geometry"));
  EXPECT_THAT(refusal("% format HISTO3D;height=320;width=320\n% end\n"), HasSubstr("`HISTO3D`"));
  EXPECT_THAT(refusal("% evt 5.0\n% end\n" + evt2), AllOf(HasSubstr("`5.0`"), HasSubstr("metavision_file_to_hdf5")));
  EXPECT_THAT(refusal("% evt 2.0\n% geometry 100x100\n% end\n"), HasSubstr("holds no events"));
  EXPECT_THAT(refusal("% Version 2\n% Width 9\n% Height 9\n"), HasSubstr("ends in its header"));
  EXPECT_THAT(refusal("% Version 2\n% Width 9\n% Height 9\n\x0E\x08"), HasSubstr("type 14"));
  EXPECT_THAT(refusal("neither text nor events"), HasSubstr("Prophesee RAW"));
}

TEST(PropheseeRaw, TheRigGoesBeforeTheUsersSizeAndThatBeforeTheHeaders) {
  TempFolder folder;
  const std::vector<Event> events = generated_events(2000, 640, 480, 20);
  const auto file =
      folder.write("a.raw", "% evt 2.0\n% geometry 640x480\n% end\n" + AnyEvtEncoder(EvtFormat::Evt2).encode(events));
  const auto count = [&](const Rig* rig, std::optional<cv::Size> geometry) {
    return read_all(*open_recording(file, rig, {.geometry = geometry}).dataset).events.size();
  };
  EXPECT_EQ(count(nullptr, std::nullopt), 2000u);
  const std::size_t smaller = count(nullptr, cv::Size(640, 400));
  EXPECT_LT(smaller, 2000u);
  Rig rig;
  rig.cameras.push_back({"events", Modality::Events, CameraModel(640, 240, 200, 200, 160, 120), SE3(), Duration(0)});
  EXPECT_LT(count(&rig, cv::Size(640, 480)), smaller);
}

TEST(PropheseeRaw, AFileMostlyOutsideItsSensorIsRefused) {
  const std::vector<Event> events = generated_events(5000, 1280, 720, 20);
  EXPECT_THAT(refusal("% evt 3.0\n% geometry 320x320\n% end\n" + AnyEvtEncoder(EvtFormat::Evt3).encode(events)),
              HasSubstr("--geometry"));
}

TEST(PropheseeRaw, ReadsTheRealGen3Recording) {
  const auto file = data_folder() / "formats" / "gen3_evt2.raw";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no data";
  const Recording recording = open_recording(file);
  const Contents c = read_all(*recording.dataset);
  EXPECT_EQ(c.events.size(), 521'252u);  // the number of words of types 0 and 1, counted without this decoder
  EXPECT_TRUE(recording.dataset->repairs().empty());
  EXPECT_NEAR(to_seconds(c.events.back().t - c.events.front().t), 0.096, 0.002);
}

}  // namespace
}  // namespace edged
