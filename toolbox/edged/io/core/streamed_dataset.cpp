// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/core/streamed_dataset.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

/// "events or IMU samples"
std::string list_of(const Merger::Streams& streams) {
  std::string names;
  const auto add = [&names](bool there, const char* name) {
    if (there) names += (names.empty() ? "" : " or ") + std::string(name);
  };
  add(!streams.events.empty(), "events");
  add(!streams.frames.empty(), "frames");
  add(streams.imu, "IMU samples");
  return names;
}

}  // namespace

StreamedDataset::StreamedDataset(const std::filesystem::path& path, std::string format)
    : name_(path.string()), merger_(repairs_) {
  info_.name = std::filesystem::absolute(path / ".").parent_path().stem().string();
  info_.format = std::move(format);
}

void StreamedDataset::begin(const OneOfEach& there) {
  std::vector<RecordedCamera> cameras;
  if (there.events) cameras.push_back({"events", Modality::Events});
  if (there.frames) cameras.push_back({"frames", Modality::Frames});
  begin(cameras, there.imu);
}

void StreamedDataset::begin(const std::vector<RecordedCamera>& cameras, bool imu) {
  Merger::Streams expected{.imu = imu};
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    const bool events = modality == Modality::Events;
    std::vector<std::string>& names = events ? expected.events : expected.frames;
    for (const RecordedCamera& camera : cameras) {
      if (camera.modality != modality) continue;
      if (!names.empty()) info_.more_cameras.push_back(camera);
      names.push_back(camera.name);
    }
    if (!names.empty()) (events ? info_.event_camera : info_.frame_camera) = names.front();
  }
  info_.has_events = !expected.events.empty();
  info_.has_frames = !expected.frames.empty();
  info_.has_imu = imu;
  image_sizes_.resize(std::max<std::size_t>(expected.frames.size(), 1));
  merger_.expect(expected);
  first_ = merged();
  if (!first_) throw InputError::format("{}: nothing to read: holds no {}", name_, list_of(expected));
  info_.begin = first_stamp(*first_);
}

std::optional<Measurement> StreamedDataset::next() { return first_ ? std::exchange(first_, std::nullopt) : merged(); }

void StreamedDataset::leave_out(Modality unwanted) {
  left_out_.insert(unwanted);
  merger_.leave_out(unwanted);
  const bool events = unwanted == Modality::Events;
  if (first_ && (events ? std::holds_alternative<EventBatch>(*first_) : std::holds_alternative<Frame>(*first_)))
    first_.reset();
}

std::optional<Measurement> StreamedDataset::merged() {
  while (true) {
    if (auto measurement = merger_.pop()) return measurement;
    if (finished_) return std::nullopt;
    finished_ = !read_on();
    if (finished_) merger_.finish();
  }
}

bool StreamedDataset::skips_block(std::size_t events) {
  skip_sum_ += skip_share_;
  if (events == 0 || skip_sum_ < 1.0) return false;
  skip_sum_ -= 1.0;
  skipped_ += events;
  return true;
}

/// The last event tells the merger how far the stream is.
void StreamedDataset::push_events(std::span<const Event> events, std::size_t camera) {
  if (events.size() > 1 && skips_block(events.size() - 1)) events = events.last(1);
  push_wanted_events(events, camera);
}

void StreamedDataset::push_wanted_events(std::span<const Event> events, std::size_t camera) {
  if (!wants(Modality::Events)) return;
  const cv::Size size = sensor_of(camera);
  const auto outside = [size](const Event& e) { return e.x >= size.width || e.y >= size.height; };
  if (size.empty() || std::ranges::none_of(events, outside)) {
    inside_ += events.size();
    merger_.push(events, camera);
    return;
  }
  std::vector<Event> inside(events.begin(), events.end());
  count_outside(std::erase_if(inside, outside), camera);
  inside_ += inside.size();
  merger_.push(inside, camera);
}

void StreamedDataset::push_frame(Timestamp t, cv::Mat image, std::size_t camera) {
  if (!wants(Modality::Frames)) return;
  cv::Size& size = image_sizes_.at(camera);
  if (size.empty()) size = image.size();
  if (image.size() != size) throw Damage("an image of another size");
  merger_.push(Frame{t, "", std::move(image)}, camera);
}

void StreamedDataset::count_outside(std::size_t count, std::size_t camera) {
  const cv::Size size = sensor_of(camera);
  outside_ += count;
  repairs_.add("events: pixel outside the sensor",
               fmt::format("{}: events outside the {} x {} sensor", name_, size.width, size.height), count);
  if (outside_ > 1000 && outside_ > inside_ / 100)
    throw InputError::format(
        "{}: {} of {} events lie outside the {} x {} sensor; give its size with --geometry WIDTHxHEIGHT, or the right "
        "--rig or --calib",
        name_, outside_, outside_ + inside_, size.width, size.height);
}

}  // namespace edged
