// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Checks the bounds and restores the order of pushed measurements.
#include "edged/io/streamed_dataset.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/measurement_stamps.hpp"

namespace edged {
namespace {

/// "events or IMU samples"
std::string names_of(const Merger::Streams& streams) {
  std::string names;
  const auto add = [&names](bool there, const char* name) {
    if (there) names += (names.empty() ? "" : " or ") + std::string(name);
  };
  add(streams.events, "events");
  add(streams.frames, "frames");
  add(streams.imu, "IMU samples");
  return names;
}

}  // namespace

StreamedDataset::StreamedDataset(const std::filesystem::path& path, std::string format)
    : name_(path.string()), merger_(repairs_) {
  info_.name = std::filesystem::absolute(path / ".").parent_path().stem().string();
  info_.format = std::move(format);
}

void StreamedDataset::begin(const Merger::Streams& expected) {
  info_.has_events = expected.events;
  info_.has_frames = expected.frames;
  info_.has_imu = expected.imu;
  merger_.expect(expected);
  first_ = merged();
  if (!first_) throw InputError::format("{}: nothing to read: holds no {}", name_, names_of(expected));
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

void StreamedDataset::push_events(std::span<const Event> events) {
  if (!wants(Modality::Events)) return;
  const cv::Size size = info_.event_sensor;
  const auto outside = [size](const Event& e) { return e.x >= size.width || e.y >= size.height; };
  if (size.empty() || std::ranges::none_of(events, outside)) {
    inside_ += events.size();
    merger_.push(events);
    return;
  }
  std::vector<Event> inside(events.begin(), events.end());
  count_outside(std::erase_if(inside, outside));
  inside_ += inside.size();
  merger_.push(inside);
}

void StreamedDataset::push_frame(Timestamp t, cv::Mat image) {
  if (!wants(Modality::Frames)) return;
  if (image_size_.empty()) image_size_ = image.size();
  if (image.size() != image_size_) throw Damage("an image of another size");
  merger_.push(Frame{t, "frames", std::move(image)});
}

void StreamedDataset::count_outside(std::size_t count) {
  const cv::Size size = info_.event_sensor;
  for (; count > 0; --count, ++outside_)
    repairs_.add("events: pixel outside the sensor",
                 fmt::format("{}: events outside the {} x {} sensor", name_, size.width, size.height));
  if (outside_ > 1000 && outside_ > inside_ / 100)
    throw InputError::format(
        "{}: {} of {} events lie outside the {} x {} sensor; give its size with --geometry WIDTHxHEIGHT, or the right "
        "--rig or --calib",
        name_, outside_, outside_ + inside_, size.width, size.height);
}

}  // namespace edged
