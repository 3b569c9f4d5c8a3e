// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/target_picture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "edged/core/check.hpp"

namespace edged {
namespace {

constexpr Duration kReach = std::chrono::milliseconds(500);    // a pixel without an event for so long is not known
constexpr Duration kNear = std::chrono::milliseconds(30);      // an edge within that time of the instant moves
constexpr std::size_t kFewestEvents = 2;                       // for each pixel, to know how many steps an edge has
constexpr double kLeastMoving = 0.02;                          // share of the pixels: else the camera stands still
constexpr Duration kSameEdge = std::chrono::milliseconds(40);  // longest pause within the steps of one edge
constexpr double kEdgesOfTarget = 0.7;                         // of all events, the rest are of fainter edges
// Where edges lie between the logarithms of black and white, as a share of half their difference: at the mean of the
// brightness for a contrast of 12, that of paper over toner. How steep the picture is there.
constexpr float kMiddle = 0.44F, kSteepness = 5.0F;
constexpr double kBlur_px = 0.6;

}  // namespace

TargetPictures::TargetPictures(int width, int height, Receiver receiver)
    : width_(width), height_(height), receiver_(std::move(receiver)) {
  const std::size_t n = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  past_.resize(n), future_.resize(n);
}

void TargetPictures::add(std::span<const Event> events) {
  for (const Event& event : events) {
    if (event.x < width_ && event.y < height_) waiting_.push_back(event);
  }
  if (!waiting_.empty()) pass(waiting_.back().t);
}

void TargetPictures::finish() { pass(Timestamp::max()); }

void TargetPictures::pass(Timestamp now) {
  if (range_ == 0.0F && waiting_.size() > kFewestEvents * past_.size()) find_range();
  while (!instants_.empty() && (now == Timestamp::max() || now > instants_.front() + kReach)) {
    if (range_ > 0.0F) {
      take_until(instants_.front());
      make(instants_.front());
    } else if (!waiting_.empty() && waiting_.front().t < instants_.front() - 2 * kReach) {  // still at rest
      waiting_.erase(waiting_.begin(), std::ranges::lower_bound(waiting_, instants_.front() - kReach, {}, &Event::t));
    }
    instants_.pop_front();
  }
  // The next instant is later than that: nothing waits for what is past.
  if (range_ > 0.0F && now != Timestamp::max()) take_until(now - kReach);
}

/// Half the steps of the strong edges: the events are sorted by the length of the run of equal steps that they are in.
void TargetPictures::find_range() {
  constexpr std::size_t kMostEvents = 3'000'000;
  std::vector<int> run(past_.size(), 0);
  std::vector<Timestamp> last(past_.size(), Timestamp::min());
  std::vector<bool> up(past_.size(), false);
  std::vector<std::size_t> events_by_length(64, 0);
  std::size_t count = 0;
  for (const Event& event : waiting_) {
    if (++count > kMostEvents) break;
    const std::size_t i = index(event);
    const bool goes_on = run[i] > 0 && up[i] == event.positive && event.t - last[i] < kSameEdge;
    if (!goes_on) {
      const auto length = std::min<std::size_t>(static_cast<std::size_t>(run[i]), events_by_length.size() - 1);
      events_by_length[length] += length;
      run[i] = 0;
    }
    ++run[i];
    up[i] = event.positive, last[i] = event.t;
  }
  std::size_t all = 0, below = 0, length = 1;
  for (const std::size_t events : events_by_length) all += events;
  for (; length + 1 < events_by_length.size(); ++length) {
    below += events_by_length[length];
    if (static_cast<double>(below) >= kEdgesOfTarget * static_cast<double>(all)) break;
  }
  range_ = std::max(1.0F, 0.5F * static_cast<float>(length));
}

float TargetPictures::stepped(float sum, bool up) const {
  return std::clamp(sum + (up ? 1.0F : -1.0F), -range_, range_);
}

void TargetPictures::take_until(Timestamp t) {
  for (; !waiting_.empty() && waiting_.front().t <= t; waiting_.pop_front()) {
    const Event& event = waiting_.front();
    Side& past = past_[index(event)];
    past = {stepped(past.sum, event.positive), event.positive, true, event.t};
  }
}

/// Within an edge the brightness goes on from the last step to the next: without that, every edge would be late by half
/// a step.
float TargetPictures::brightness(const Side& past, const Side& future, Timestamp t) const {
  const bool before = past.known && t - past.t < kReach;
  if (!before) return future.known ? future.sum : 0.0F;
  if (!future.known) return past.sum;
  const float sum = 0.5F * (past.sum + future.sum);
  if (past.up != future.up || future.t - past.t > kSameEdge || future.t <= past.t) return sum;
  const double share = to_seconds(t - past.t) / to_seconds(future.t - past.t);
  return sum + static_cast<float>(past.up ? share : -share);
}

void TargetPictures::make(Timestamp t) {
  std::ranges::fill(future_, Side());
  const auto end = std::ranges::upper_bound(waiting_, t + kReach, {}, &Event::t);
  for (auto event = end; event != waiting_.begin();) {
    --event;
    Side& future = future_[index(*event)];
    future = {stepped(future.sum, !event->positive), event->positive, true, event->t};
  }
  std::size_t moving = 0;
  for (const Side& past : past_) moving += past.known && t - past.t < kNear ? 1 : 0;
  if (static_cast<double>(moving) < kLeastMoving * static_cast<double>(past_.size())) return;
  cv::Mat_<float> picture(height_, width_);
  for (std::size_t i = 0; i < past_.size(); ++i)
    picture(static_cast<int>(i) / width_, static_cast<int>(i) % width_) =
        255.0F / (1.0F + std::exp(-kSteepness * (brightness(past_[i], future_[i], t) / range_ - kMiddle)));
  cv::GaussianBlur(picture, picture, {}, kBlur_px);
  cv::Mat out;
  picture.convertTo(out, CV_8U);
  receiver_(t, out);
}

}  // namespace edged
