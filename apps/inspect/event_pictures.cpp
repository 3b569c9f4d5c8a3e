// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "inspect/event_pictures.hpp"

#include <array>
#include <cmath>

#include "edged/core/check.hpp"

namespace edged {
namespace {

const cv::Scalar kPaper(255, 255, 255);
const cv::Vec3d kBrighterInk(192, 111, 31), kDarkerInk(26, 80, 200), kCountInk(48, 36, 29);

/// 0 without an event, 0.5 for one, 0.75 for two, ...
std::array<double, 511> ink_by_count() {
  std::array<double, 511> by_count{};
  for (std::size_t n = 0; n < by_count.size(); ++n) by_count[n] = 1.0 - std::exp2(-static_cast<double>(n));
  return by_count;
}

}  // namespace

EventPictures::EventPictures(cv::Size sensor, int binning, const PictureRule& rule)
    : sensor_(sensor), binning_(binning), rule_(rule) {}

void EventPictures::begin_at(Timestamp t) {
  if (!origin_) origin_ = t;
  const Timestamp begin = rule_.events > 0 ? t : *origin_ + (t - *origin_) / rule_.length * rule_.length;
  const cv::Size size((sensor_.width + binning_ - 1) / binning_, (sensor_.height + binning_ - 1) / binning_);
  picture_ = {begin, begin + rule_.length, 0, cv::Mat::zeros(size, CV_8UC1), cv::Mat::zeros(size, CV_8UC1)};
}

void EventPictures::count(const Event& event) {
  if (event.x >= sensor_.width || event.y >= sensor_.height)
    throw InputError::format("an event at ({}, {}) lies outside the sensor of {}x{}; give its size by --geometry",
                             event.x, event.y, sensor_.width, sensor_.height);
  auto& pixel = (event.positive ? picture_.positive : picture_.negative)
                    .at<unsigned char>(event.y / binning_, event.x / binning_);
  if (pixel < 255) ++pixel;
  ++picture_.events;
  last_ = event.t;
}

void EventPictures::add(std::span<const Event> events, const Show& show) {
  for (const Event& event : events) {
    const bool by_count = rule_.events > 0;
    if (picture_.events > 0 && (by_count ? picture_.events == rule_.events : event.t >= picture_.end)) finish(show);
    if (picture_.events == 0) begin_at(event.t);
    count(event);
  }
}

void EventPictures::finish(const Show& show) {
  if (picture_.events == 0) return;
  if (rule_.events > 0) picture_.end = last_;
  show(picture_);
  picture_.events = 0;
}

cv::Mat draw_event_picture(const EventPicture& picture, PictureStyle style) {
  static const std::array<double, 511> kInkByCount = ink_by_count();
  cv::Mat image(picture.positive.size(), CV_8UC3, kPaper);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const int up = picture.positive.at<unsigned char>(y, x), down = picture.negative.at<unsigned char>(y, x);
      const double ink = kInkByCount[static_cast<std::size_t>(up + down)];
      const cv::Vec3d& colour = style == PictureStyle::Counts ? kCountInk : up >= down ? kBrighterInk : kDarkerInk;
      image.at<cv::Vec3b>(y, x) = cv::Vec3d::all(255 * (1.0 - ink)) + ink * colour;
    }
  }
  return image;
}

}  // namespace edged
