// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The right cameras of the data sets in HDF5: in the file of the left ones, or in files of their own.
#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include <map>

#include "edged/io/hdf5/h5_test_support.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/parse/evt_test_support.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const RecordingOptions kBothSides{.all_cameras = true};

/// Events that tell the sides apart: the first is at (1, 0) or (2, 0).
std::vector<Event> events_of_side(bool right) {
  std::vector<Event> events = generated_events(5000, 200, 150, 20);
  events.front().x = right ? 2 : 1;
  events.front().y = 0;
  return events;
}

/// "events 5000 from (1, 0)" and "frames2 2 of grey 9" for each camera, by name.
std::vector<std::string> described(const std::filesystem::path& path, const RecordingOptions& options = kBothSides) {
  const Recording r = open_recording(path, nullptr, options);
  std::map<std::string, std::vector<Event>> events;
  std::map<std::string, std::vector<cv::Mat>> images;
  while (const auto m = r.dataset->next()) {
    if (const auto* batch = std::get_if<EventBatch>(&*m))
      events[batch->camera].insert(events[batch->camera].end(), batch->events.begin(), batch->events.end());
    if (const auto* frame = std::get_if<Frame>(&*m)) images[frame->camera].push_back(frame->image);
  }
  std::vector<std::string> out;
  for (const auto& [name, all] : events)
    out.push_back(fmt::format("{} {} from ({}, {})", name, all.size(), all.front().x, all.front().y));
  for (const auto& [name, all] : images)
    out.push_back(fmt::format("{} {} of grey {}", name, all.size(), all.front().at<std::uint8_t>(0, 0)));
  return out;
}

const auto kTwoOfEach =
    ElementsAre("events 5000 from (1, 0)", "events2 5000 from (2, 0)", "frames 2 of grey 8", "frames2 2 of grey 9");

void put_images(const TempFolder& folder, const std::string& where, bool right) {
  for (int i = 0; i < 2; ++i) folder.write_image(fmt::format("{}/00000{}.png", where, i), 16, 12, right ? 9 : 8);
}

TEST(StereoSets, DsecHasAFolderForEachSide) {
  for (const bool zipped_names : {false, true}) {
    TempFolder folder;
    for (const std::string side : {"left", "right"}) {
      const auto place = folder.path() / (zipped_names ? "seq_events_" + side : "events/" + side);
      std::filesystem::create_directories(place);
      write_events(place / "events.h5", events_of_side(side == "right"));
      H5Maker(place / (zipped_names ? "rectify_maps.h5" : "rectify_map.h5"))
          .array("/rectify_map", std::vector<float>(8), {2, 2, 2});
      put_images(folder, "images/" + side + "/distorted", side == "right");
    }
    folder.write("images/timestamps.txt", "5000\n15000\n");
    EXPECT_THAT(described(folder.path()), kTwoOfEach);
    EXPECT_THAT(described(folder.path(), {}), ElementsAre("events 5000 from (1, 0)", "frames 2 of grey 8"));
    EXPECT_THAT(described(folder.path(), {.cameras = {"events2", "frames2"}}),
                ElementsAre("events2 5000 from (2, 0)", "frames2 2 of grey 9"));
  }
}

TEST(StereoSets, VectorHasFilesForEachSide) {
  TempFolder folder;
  for (const std::string side : {"left", "right"}) {
    write_events(folder.path() / fmt::format("desk.synced.{}_event.hdf5", side), events_of_side(side == "right"));
    const std::string camera = fmt::format("desk.synced.{}_camera", side);
    put_images(folder, camera, side == "right");
    folder.write(camera + "/timestamp.txt", "# start and end\n0.010 0.012\n0.020 0.024\n");
  }
  EXPECT_THAT(described(folder.path()), kTwoOfEach);
}

TEST(StereoSets, TumVieHasExposuresForEachSide) {
  TempFolder folder;
  for (const std::string side : {"left", "right"}) {
    write_events(folder.path() / fmt::format("desk-events_{}.h5", side), events_of_side(side == "right"));
    const std::string images = fmt::format("desk-vi_gt_data/{}_images", side);
    put_images(folder, images, side == "right");
    folder.write(fmt::format("{}/image_timestamps_{}.txt", images, side), "10000\n60000\n");
    folder.write(fmt::format("{}/image_exposures_{}.txt", images, side),
                 side == "left" ? "1000\n2000\n" : "3000\n2000\n");
  }
  EXPECT_THAT(described(folder.path()), kTwoOfEach);
  const Recording right = open_recording(folder.path(), nullptr, {.cameras = {"frames2"}});
  EXPECT_EQ(read_all(*right.dataset).frames.front().t, timestamp_from_ns(11'500'000));
}

TEST(StereoSets, M3edHasAllInOneFileAndAColourCameraBesides) {
  TempFolder folder;
  {
    H5Maker file(folder.path() / "car_data.h5");
    for (const std::string side : {"left", "right"}) {
      put_event_columns(file, "/prophesee/" + side, events_of_side(side == "right"));
      file.column("/prophesee/" + side + "/calib/resolution", std::vector<std::int64_t>{1280, 720});
      file.array("/ovc/" + side + "/data", std::vector<std::uint8_t>(2 * 4 * 5, side == "right" ? 9 : 8), {2, 4, 5, 1});
    }
    file.array("/ovc/rgb/data", std::vector<std::uint8_t>(2 * 4 * 5 * 3, 50), {2, 4, 5, 3});
    file.column("/ovc/ts", std::vector<std::int64_t>{2000, 4000});
  }
  EXPECT_THAT(described(folder.path()),
              ElementsAre("events 5000 from (1, 0)", "events2 5000 from (2, 0)", "frames 2 of grey 8",
                          "frames2 2 of grey 9", "frames3 2 of grey 50"));
  const auto cameras = recorded_cameras(open_recording(folder.path(), nullptr, kBothSides).dataset->info());
  EXPECT_EQ(cameras.at(1).stream, "/prophesee/right");
  EXPECT_EQ(cameras.at(1).sensor, cv::Size(1280, 720));
  EXPECT_EQ(cameras.at(4).stream, "/ovc/rgb/data");
}

TEST(StereoSets, MvsecHasADavisOnEachSide) {
  TempFolder folder;
  {
    H5Maker file(folder.path() / "indoor_data.hdf5");
    for (const std::string side : {"left", "right"}) {
      const std::string davis = "/davis/" + side;
      std::vector<double> rows;
      for (const Event& e : events_of_side(side == "right"))
        rows.insert(rows.end(), {e.x * 1.0, e.y * 1.0, to_seconds(e.t), e.positive ? 1.0 : -1.0});
      file.array(davis + "/events", rows, {5000, 4});
      file.array(davis + "/image_raw", std::vector<std::uint8_t>(2 * 260 * 346, side == "right" ? 9 : 8),
                 {2, 260, 346});
      file.column(davis + "/image_raw_ts", std::vector<double>{0.005, side == "right" ? 0.031 : 0.030});
    }
  }
  EXPECT_THAT(described(folder.path()), kTwoOfEach);
  const auto right = read_all(*open_recording(folder.path(), nullptr, {.cameras = {"frames2"}}).dataset);
  EXPECT_EQ(right.frames.back().t, timestamp_from_seconds(0.031));
}

TEST(StereoSets, ARightFileWithoutEventsConcernsOnlyThoseWhoWantIt) {
  TempFolder folder;
  write_events(folder.path() / "desk-events_left.h5", events_of_side(false));
  std::make_unique<H5Maker>(folder.path() / "desk-events_right.h5")->column("/other", std::vector<int>{1});
  EXPECT_THAT(described(folder.path(), {}), ElementsAre("events 5000 from (1, 0)"));
  const std::string refusal = input_error([&] { described(folder.path()); });
  EXPECT_THAT(refusal, AllOf(HasSubstr("desk-events_right.h5: has no events in the layout of desk-events_left.h5"),
                             HasSubstr("cameras=events")));
  folder.write("desk-events_right.h5", "no HDF5");
  EXPECT_THAT(input_error([&] { described(folder.path()); }), HasSubstr("desk-events_right.h5"));
  EXPECT_THAT(described(folder.path(), {}), ElementsAre("events 5000 from (1, 0)"));
}

}  // namespace
}  // namespace edged
