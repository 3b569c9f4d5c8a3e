// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "common/json_text.hpp"
#include "live/live_feed.hpp"
#include "live/page_server.hpp"
#include "report/report_data.hpp"
#include "report/report_page.hpp"

namespace edged {
namespace {

const Rig kHead{"head", {{"events", Modality::Events, CameraModel(240, 180, 200, 200, 120, 90), SE3(), {}}}};

/// A run of steps, added to the feed.
class LiveRun : public ::testing::Test {
 protected:
  void go_on(int steps) {
    for (const int end = made + steps; made < end; ++made) {
      Step step;
      step.t = timestamp_from_seconds(50.0 + 0.03 * made);
      step.status = made < 5 ? TrackingStatus::Initializing : TrackingStatus::Good;
      if (made < 5) step.waiting_for = fmt::format("parallax, {} px of 5", made);
      step.state.T_W_B = SE3(Eigen::Quaterniond::Identity(), {1e-3 * made, 0.0, 0.0});
      step.keyframe = true;
      step.rig = kHead;
      step.landmarks = {{static_cast<FeatureId>(made), Eigen::Vector3d(2.0, made, 0.0)}};
      step.cameras = {
          {.name = "events", .modality = Modality::Events, .image = cv::Mat(180, 240, CV_8UC1, cv::Scalar(99))}};
      statistics.add(step);
      snapshots.add(step);
      feed.add(step, {statistics, 1.0, {4.0, std::nullopt}}, snapshots);
    }
  }

  nlohmann::json news(LiveFeed::Place& place) const { return nlohmann::json::parse(feed.news(place)); }

  int made = 0;
  RunStatistics statistics;
  Snapshots snapshots;
  LivePoints dense;
  LiveFeed feed{"events", dense};
};

TEST_F(LiveRun, TellsEachViewerWhatItDoesNotKnowYet) {
  LiveFeed::Place early, late;
  EXPECT_TRUE(news(early)["rows"]["t"].empty());
  go_on(3);
  EXPECT_EQ(news(early)["rows"]["t"], nlohmann::json({0.0, 0.03, 0.06}));
  go_on(4);
  const auto more = news(early), all = news(late);
  EXPECT_EQ(more["rows_from"], 3);
  EXPECT_EQ(more["rows"]["t"].size(), 4u);
  EXPECT_EQ(all["rows_from"], 0);
  EXPECT_EQ(all["rows"]["t"].size(), 7u);
  EXPECT_EQ(all["rows"]["x"][4], nullptr);
  EXPECT_EQ(all["rows"]["x"][6], 0.006);
  EXPECT_EQ(all["rows"]["processing"][6], 4.0);
  EXPECT_EQ(all["rows"]["latency"][6], nullptr);  // not live
  EXPECT_EQ(all["newest"]["x"][0], 0.006);
  EXPECT_EQ(all["progress"]["packets"], 7);
}

TEST_F(LiveRun, SaysWhyTheStatusIsWhatItIs) {
  LiveFeed::Place place;
  go_on(2);
  EXPECT_EQ(news(place)["changes"][0]["reason"], "waits for parallax, 1 px of 5");
  go_on(4);
  const auto update = news(place);
  EXPECT_EQ(update["changes_from"], 0);  // the last reason is sent again
  EXPECT_EQ(update["changes"][0]["reason"], "waits for parallax, 4 px of 5");
  EXPECT_EQ(update["changes"][1]["status"], "Good");
  EXPECT_EQ(update["status"], "Good");
}

TEST_F(LiveRun, StaysSmallHoweverLongItIs) {
  LiveFeed::Place place, fresh;
  go_on(1000);
  news(place);
  go_on(20000);
  const auto update = news(place), all = news(fresh);
  EXPECT_EQ(update["rows_from"], 0);  // rows have been thinned out: all are sent again
  EXPECT_EQ(update["rows"], all["rows"]);
  const auto t = all["rows"]["t"].get<std::vector<double>>();
  EXPECT_LT(t.size(), LiveFeed::kMostRows);
  EXPECT_GE(t.size(), LiveFeed::kMostRows / 2);
  for (std::size_t i = 1; i < t.size(); ++i) EXPECT_NEAR(t[i] - t[i - 1], t[1] - t[0], 1e-3);
  EXPECT_DOUBLE_EQ(all["t"].get<double>(), 0.03 * 20999);
}

TEST_F(LiveRun, CopiesNoImageUnlessThereIsAViewer) {
  LiveFeed::Place place;
  go_on(3);
  EXPECT_TRUE(feed.picture("events").empty());
  EXPECT_FALSE(news(place).contains("map"));
  feed.viewer_came();
  go_on(3);
  EXPECT_EQ(news(place)["pictures"]["events"], 1);
  EXPECT_FALSE(feed.picture("events").empty());
  EXPECT_TRUE(feed.picture("frame").empty());
  feed.viewer_left();
  EXPECT_EQ(feed.viewers(), 0u);
}

TEST_F(LiveRun, TellsTheMapOnce) {
  LiveFeed::Place place;
  feed.viewer_came();
  go_on(2);
  EXPECT_EQ(news(place)["map"].size(), 3u);  // at the first step; the next one comes within the same two seconds
  EXPECT_FALSE(news(place).contains("map"));
}

/// So many points on a line, of a keyframe at t.
DepthMap line_of_points(Timestamp t, int count) {
  DepthMap map{t, "frames", CameraModel(240, 180, 200, 200, 120, 90), SE3(), 0, {}};
  for (int i = 0; i < count; ++i)
    map.points.push_back({120, 90, 1.0F / static_cast<float>(1 + i), 0.01F, static_cast<std::uint8_t>(i % 251), 5});
  return map;
}

/// As the page does.
std::size_t with_news(std::size_t points, const nlohmann::json& news) {
  for (int i = 0; i < news["halved"]; ++i) points = (points + 1) / 2;
  return points + news["grey"].get<std::string>().size() / 4 * 3 - (news["grey"].get<std::string>().ends_with("=")) -
         (news["grey"].get<std::string>().ends_with("=="));
}

TEST_F(LiveRun, TellsEachDensePointOnceAndFewAtATime) {
  const Timestamp t = timestamp_from_seconds(3);
  LiveFeed::Place place;
  go_on(1);
  EXPECT_FALSE(news(place).contains("dense"));
  dense.add(line_of_points(t, 5));
  EXPECT_FALSE(news(place).contains("dense")) << "a keyframe that is not known";
  dense.note_keyframe(t, SE3(Eigen::Quaterniond::Identity(), {0.0, 0.0, 10.0}));
  dense.add(line_of_points(t, 5));
  nlohmann::json told = news(place)["dense"];
  EXPECT_EQ(told["all"], 5);
  EXPECT_NEAR(told["low"][2].get<double>(), 11.0, 1e-4);
  EXPECT_EQ(told["grey"], base64({0, 1, 2, 3, 4}));
  EXPECT_FALSE(news(place).contains("dense"));
  dense.add(line_of_points(t, static_cast<int>(LivePoints::kMostAtOnce) + 7));
  EXPECT_EQ(with_news(0, news(place)["dense"]), LivePoints::kMostAtOnce);
  EXPECT_EQ(with_news(0, news(place)["dense"]), 7U);
}

TEST_F(LiveRun, TellsTheVoxelsWhenTheyHaveChanged) {
  LiveFeed::Place place;
  go_on(1);
  EXPECT_FALSE(news(place).contains("voxels"));
  dense.set_voxels({{1.0F, 2.0F, 3.0F}, {2.0F, 2.0F, 3.0F}}, 0.1);
  const nlohmann::json told = news(place)["voxels"];
  EXPECT_EQ(told["all"], 2);
  EXPECT_EQ(told["edge_m"], 0.1);
  EXPECT_EQ(told["low"][0], 1.0);
  EXPECT_FALSE(news(place).contains("voxels"));
  dense.set_voxels(std::vector<Eigen::Vector3f>(3 * LivePoints::kMostVoxels, {1.0F, 2.0F, 3.0F}), 0.1);
  const nlohmann::json more = news(place)["voxels"];
  EXPECT_EQ(more["all"], 3 * LivePoints::kMostVoxels);
  EXPECT_EQ(more["xyz"].get<std::string>().size(), 8 * LivePoints::kMostVoxels) << "6 bytes each, in base64";
}

TEST(LivePointsOfALongRun, AreBoundedAndTheSameForEarlyAndLateViewers) {
  LivePoints points;
  const Timestamp t = timestamp_from_seconds(3);
  points.note_keyframe(t, SE3());
  LivePoints::Place early, late;
  std::size_t of_early = 0, of_late = 0;
  const auto take_all = [&points](LivePoints::Place& place, std::size_t& count) {
    for (auto news = points.news(place); !news.is_null(); news = points.news(place)) count = with_news(count, news);
  };
  const DepthMap map = line_of_points(t, 99'999);
  for (int i = 0; i < 25; ++i) {
    points.add(map);
    if (i % 6 == 0) take_all(early, of_early);
  }
  take_all(early, of_early);
  take_all(late, of_late);
  EXPECT_EQ(of_early, of_late);
  EXPECT_LT(of_late, LivePoints::kMost);
  EXPECT_GE(of_late, LivePoints::kMost / 2);
}

TEST(LivePage, HasTheScriptThatAsksAndMayAsk) {
  const std::string live = live_report_page({{"recording", "a"}});
  EXPECT_NE(live.find("new EventSource"), std::string::npos);
  EXPECT_NE(live.find("connect-src 'self'"), std::string::npos);
  const std::string report = report_page({{"runs", nlohmann::ordered_json::array()}});
  EXPECT_EQ(report.find("new EventSource"), std::string::npos);
  EXPECT_EQ(report.find("connect-src"), std::string::npos);
}

TEST(ServeAddressText, IsAPortOrAHostAndAPort) {
  const auto is = [](const std::string& text, const std::string& host, int port) {
    const auto address = parse_serve_address(text);
    return address && address->host == host && address->port == port;
  };
  EXPECT_TRUE(is("true", "127.0.0.1", 8765));
  EXPECT_TRUE(is("0", "127.0.0.1", 0));
  EXPECT_TRUE(is("9000", "127.0.0.1", 9000));
  EXPECT_TRUE(is("0.0.0.0:80", "0.0.0.0", 80));
  EXPECT_TRUE(is("[::1]:9000", "::1", 9000));
  for (const char* text : {"", "x", "65536", "-1", "80x", ":80", "host:", "host", "1.5"})
    EXPECT_FALSE(parse_serve_address(text)) << text;
}

}  // namespace
}  // namespace edged
