// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/visual_turns.hpp"

#include <bit>
#include <opencv2/imgproc.hpp>
#include <opengv/relative_pose/CentralRelativeAdapter.hpp>
#include <opengv/relative_pose/methods.hpp>

#include "edged/camera/binning.hpp"

namespace edged {
namespace {

constexpr std::size_t kFewestPairs = 12;
constexpr int kWidest_px = 640;                                // of an image of events
constexpr std::size_t kMostTurns = 3000;                       // bounds time and memory
constexpr double kEventsPerPixel = 0.3;                        // in an image of events
constexpr Duration kShortest = std::chrono::milliseconds(10);  // between images of events
constexpr Duration kBaseline = std::chrono::milliseconds(80);  // least duration of a rotation: below it noise dominates
constexpr Duration kLongest = std::chrono::milliseconds(200);  // a longer one is a gap

/// By which images of events are binned.
int octaves_of(const RigCamera& camera) {
  if (camera.modality != Modality::Events) return 0;
  return std::countr_zero(static_cast<unsigned>(bin_for(camera.model.width(), kWidest_px)));
}

TrackerConfig with_corners(int corners) {
  TrackerConfig config;
  config.detector.max_features = corners;
  config.klt.window_px = 15;  // for images of events, too
  return config;
}

}  // namespace

Duration turning_time(std::span<const Turn> turns, std::size_t first) {
  Duration time{0};
  for (std::size_t i = first; i < turns.size(); ++i) {
    const Turn& turn = turns[i];
    const Timestamp from = i == 0 ? turn.begin : std::max(turn.begin, turns[i - 1].end);
    if (turn.phi_C.norm() > kLeastTurningRate * to_seconds(turn.end - turn.begin)) time += turn.end - from;
  }
  return time;
}

std::optional<Eigen::Matrix3d> rotation_between(std::span<const Eigen::Vector2d> begin,
                                                std::span<const Eigen::Vector2d> end) {
  if (begin.size() < kFewestPairs) return std::nullopt;
  opengv::bearingVectors_t from, to;
  for (std::size_t i = 0; i < begin.size(); ++i) {
    from.push_back(begin[i].homogeneous().normalized());
    to.push_back(end[i].homogeneous().normalized());
  }
  const opengv::relative_pose::CentralRelativeAdapter adapter(from, to, Eigen::Matrix3d::Identity());
  const Eigen::Matrix3d R = opengv::relative_pose::eigensolver(adapter);
  return R.allFinite() ? std::optional(R) : std::nullopt;
}

VisualTurns::VisualTurns(const RigCamera& camera, int corners)
    : modality_(camera.modality),
      octaves_(octaves_of(camera)),
      tracker_(camera.name, binned(camera.model, 1 << octaves_), with_corners(corners)),
      event_image_(tracker_.camera().height(), tracker_.camera().width(), CV_8UC1, cv::Scalar(0)),
      events_per_image_(static_cast<std::size_t>(kEventsPerPixel * camera.model.width() * camera.model.height())) {}

void VisualTurns::add(const Measurement& measurement) {
  if (turns_.size() >= kMostTurns) return;
  if (const auto* batch = std::get_if<EventBatch>(&measurement); batch && modality_ == Modality::Events)
    add_events(batch->events);
  if (const auto* frame = std::get_if<Frame>(&measurement); frame && modality_ == Modality::Frames)
    if (frame->image.size() == event_image_.size()) add_image(frame->image, frame->t);
}

void VisualTurns::add_events(std::span<const Event> events) {
  constexpr int kGrey = 60;  // grey level of one event; a few in each pixel of the sensor add up to white
  const int grey = std::max(kGrey >> (2 * octaves_), 1);
  const CameraModel& camera = tracker_.camera();
  const bool is_masked = camera.is_masked();
  const int width = event_image_.cols, height = event_image_.rows;
  std::uint8_t* const pixels = event_image_.ptr();
  // More of a wide sensor are not needed: each costs the same, and there are many.
  if (octaves_ > 0 && !views_.empty())
    events = {std::ranges::lower_bound(events, views_.back().t + kShortest, {}, &Event::t), events.end()};
  for (const Event& event : events) {
    const int x = event.x >> octaves_, y = event.y >> octaves_;
    if (x >= width || y >= height || (is_masked && !camera.uses(x, y))) continue;
    std::uint8_t& pixel = pixels[y * width + x];
    pixel = static_cast<std::uint8_t>(std::min(pixel + grey, 255));
  }
  events_ += events.size();
  if (events.empty()) return;
  if (!image_begin_) image_begin_ = events.front().t;
  if (events_ < events_per_image_) return;
  const Timestamp t = *image_begin_ + (events.back().t - *image_begin_) / 2;
  if (!views_.empty() && t - views_.back().t < kShortest) return;
  cv::Mat smooth;
  cv::GaussianBlur(event_image_, smooth, cv::Size(), 1.0);
  add_image(smooth, t);
  event_image_.setTo(0);
  image_begin_.reset();
  events_ = 0;
}

void VisualTurns::add_image(const cv::Mat& image, Timestamp t) {
  if (!views_.empty() && t <= views_.back().t) return;
  tracker_.track(image, t, std::nullopt);
  tracker_.reject_outliers(FeatureTracker::Reference::Previous, std::nullopt);
  while (views_.size() > 1 && t - views_[1].t >= kBaseline) views_.pop_front();
  View view{t, {}};
  for (const Track& track : tracker_.tracks()) view.points[track.id] = track.point;
  if (!views_.empty() && t - views_.front().t >= kBaseline && t - views_.front().t <= kLongest) add_turn(view);
  if (tracker_.needs_detection()) tracker_.detect(image, next_id_);
  for (const Track& track : tracker_.tracks()) view.points[track.id] = track.point;
  views_.push_back(std::move(view));
}

/// The rotation from the oldest view to this one.
void VisualTurns::add_turn(const View& view) {
  std::vector<Eigen::Vector2d> begin, end;
  for (const auto& [id, point] : view.points) {
    const auto before = views_.front().points.find(id);
    if (before == views_.front().points.end()) continue;
    begin.push_back(before->second);
    end.push_back(point);
  }
  const auto R = rotation_between(begin, end);
  if (!R) return;
  turns_.push_back({views_.front().t, view.t, so3::log(Eigen::Quaterniond(*R))});
  for (std::size_t i = 0; i < begin.size(); ++i)
    turns_.back().rays.emplace_back(begin[i].homogeneous().normalized(), end[i].homogeneous().normalized());
}

}  // namespace edged
