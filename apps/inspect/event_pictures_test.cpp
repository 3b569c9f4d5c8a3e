// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "inspect/event_pictures.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "edged/core/check.hpp"
#include "inspect/player_data.hpp"

namespace edged {
namespace {

const cv::Size kSmallSensor(6, 4);

Event event_at_ms(int ms, int x, int y, bool positive = true) {
  return {Timestamp(std::chrono::milliseconds(ms)), static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
          positive};
}

std::vector<EventPicture> pictures_of(const std::vector<Event>& events, const PictureRule& rule, int binning = 1) {
  std::vector<EventPicture> all;
  const auto keep = [&all](const EventPicture& picture) {
    all.push_back(picture);
    all.back().positive = picture.positive.clone();
    all.back().negative = picture.negative.clone();
  };
  EventPictures pictures(kSmallSensor, binning, rule);
  pictures.add(events, keep);
  pictures.finish(keep);
  return all;
}

TEST(EventPictures, OfEqualLengthLieOnOneGridAndSkipSilence) {
  const auto all =
      pictures_of({event_at_ms(5, 0, 0), event_at_ms(14, 1, 0), event_at_ms(15, 2, 0), event_at_ms(57, 3, 0)},
                  {std::chrono::milliseconds(10)});
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].events, 2u);
  EXPECT_EQ(to_ns(all[1].begin), 15'000'000);
  EXPECT_EQ(to_ns(all[2].begin), 55'000'000);
  EXPECT_EQ(to_ns(all[2].end), 65'000'000);
}

TEST(EventPictures, OfSoManyEventsEndWithTheLastOfThem) {
  const auto all = pictures_of({event_at_ms(0, 0, 0), event_at_ms(7, 0, 0), event_at_ms(9, 0, 0)}, {{}, 2});
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(to_ns(all[0].end), 7'000'000);
  EXPECT_EQ(all[1].events, 1u);
}

TEST(EventPictures, CountByPolarityAndSeveralPixelsOfTheSensorAsOne) {
  const auto all = pictures_of({event_at_ms(0, 4, 2), event_at_ms(1, 5, 3), event_at_ms(2, 5, 3, false)},
                               {std::chrono::milliseconds(10)}, 2);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].positive.size(), cv::Size(3, 2));
  EXPECT_EQ(all[0].positive.at<unsigned char>(1, 2), 2);
  EXPECT_EQ(all[0].negative.at<unsigned char>(1, 2), 1);
}

TEST(EventPictures, RefuseAnEventOutsideTheSensor) {
  EXPECT_THROW(pictures_of({event_at_ms(0, 6, 0)}, {std::chrono::milliseconds(10)}), InputError);
}

TEST(EventPictures, AreBlueWhereItGrewBrighterAndRedWhereItGrewDarker) {
  const auto all = pictures_of({event_at_ms(0, 0, 0), event_at_ms(1, 1, 0, false)}, {std::chrono::milliseconds(10)});
  const cv::Mat image = draw_event_picture(all.at(0), PictureStyle::Polarity);
  EXPECT_GT(image.at<cv::Vec3b>(0, 0)[0], image.at<cv::Vec3b>(0, 0)[2]);
  EXPECT_LT(image.at<cv::Vec3b>(0, 1)[0], image.at<cv::Vec3b>(0, 1)[2]);
  EXPECT_EQ(image.at<cv::Vec3b>(3, 5), cv::Vec3b(255, 255, 255));
  const cv::Vec3b grey = draw_event_picture(all.at(0), PictureStyle::Counts).at<cv::Vec3b>(0, 1);
  EXPECT_LT(std::abs(grey[0] - grey[2]), 20);
}

TEST(PlayerData, ThinsOutEvenlyToStayWithinItsLimitAndNamesEachFrameOnce) {
  PlayerData player(4000);
  const cv::Mat grey(40, 60, CV_8UC1, cv::Scalar(90));
  const auto add = [&player](const EventPicture& picture) { player.add(picture); };
  EventPictures pictures(kSmallSensor, 1, {std::chrono::milliseconds(10)});
  for (int i = 0; i < 200; ++i) {
    if (i % 100 == 0) player.add(Frame{Timestamp(std::chrono::milliseconds(10 * i)), "frames", grey});
    pictures.add(std::vector<Event>{event_at_ms(10 * i, i % 6, 0)}, add);
  }
  pictures.finish(add);
  const nlohmann::ordered_json json = player.to_json();
  EXPECT_GT(player.every(), 1u);
  EXPECT_EQ(json["pictures"].size(), player.pictures());
  EXPECT_EQ(json["frames"].size(), 2u);
  std::size_t bytes = 0;
  for (const auto& picture : json["pictures"]) bytes += picture["png"].get<std::string>().size();
  EXPECT_LE(bytes, 4000u);
  const double step = json["pictures"][1]["begin"].get<double>() - json["pictures"][0]["begin"].get<double>();
  EXPECT_NEAR(step, 0.01 * static_cast<double>(player.every()), 1e-9);
  EXPECT_EQ(json["pictures"][0]["frame"], 0);
  EXPECT_EQ(json["pictures"].back()["frame"], 1);
}

}  // namespace
}  // namespace edged
