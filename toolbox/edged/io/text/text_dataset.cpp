// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Merges sensors by stamp, and loads images when they are needed.
#include "edged/io/text/text_dataset.hpp"

#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/io/core/merger.hpp"

namespace edged {
namespace {

template <typename Stream>
Timestamp next_stamp(std::optional<Stream>& stream) {
  if (!stream) return Timestamp::max();
  const auto* item = stream->peek();
  return item ? item->t : Timestamp::max();
}

}  // namespace

TextDataset::TextDataset(TextLayout layout) : layout_(std::move(layout)) {
  open_streams();
  find_ends();
}

void TextDataset::open_streams() {
  const auto note_empty = [&](const std::string& subject, const SourcePath& file) {
    repairs_.add(subject + ": empty file", file.string() + ": holds nothing readable");
  };
  std::string files;
  const auto opened = [&](auto& stream, const std::string& subject, const SourcePath& file) {
    files += (files.empty() ? "" : ", ") + file.name();
    if (stream.peek()) return true;
    note_empty(subject, file);
    return false;
  };
  DatasetInfo& info = layout_.info;
  for (const EventFile& e : layout_.events) {
    EventTextStream events(e.file, e.columns, e.width, e.height, repairs_);
    if (opened(events, "events", e.file)) events_.push_back({e.camera, std::move(events)});
  }
  for (const FrameFile& f : layout_.frames) {
    StampedLines<FrameEntry> lines(f.lines, repairs_);
    if (opened(lines, "frames", f.lines.file)) frames_.push_back({f.camera, std::move(lines)});
  }
  if (const auto& i = layout_.imu) {
    imu_.emplace(*i, repairs_);
    info.has_imu = opened(*imu_, "imu", i->file);
    if (!info.has_imu) imu_.reset();
  }
  name_cameras();
  if (!info.has_events && !info.has_frames && !info.has_imu)
    throw InputError::format("{}: nothing to read: {} hold no readable line", info.name, files);
}

void TextDataset::name_cameras() {
  DatasetInfo& info = layout_.info;
  info.has_events = !events_.empty();
  info.has_frames = !frames_.empty();
  if (!layout_.events.empty()) info.event_camera = layout_.events.front().camera;
  if (!layout_.frames.empty()) info.frame_camera = layout_.frames.front().camera;
  const auto is_further = [](const auto& streams, const std::string& camera, const std::string& first) {
    return camera != first && std::ranges::any_of(streams, [&](const auto& stream) { return stream.camera == camera; });
  };
  for (const EventFile& e : layout_.events)
    if (is_further(events_, e.camera, info.event_camera))
      info.more_cameras.push_back({e.camera, Modality::Events, e.file.name(), {e.width, e.height}});
  for (const FrameFile& f : layout_.frames)
    if (is_further(frames_, f.camera, info.frame_camera))
      info.more_cameras.push_back({f.camera, Modality::Frames, f.lines.file.name()});
}

void TextDataset::find_ends() {
  DatasetInfo& info = layout_.info;
  info.begin = std::min({next_event_stamp(), next_frame_stamp(), next_stamp(imu_)});
  const auto extend = [&info](std::optional<Timestamp> t) {
    if (t) info.end = std::max(info.end.value_or(*t), *t);
  };
  for (const EventFile& e : layout_.events)
    extend(last_stamp(e.file, [&e](std::string_view line) { return parse_event_stamp(line, e.columns); }));
  for (const FrameFile& f : layout_.frames) extend(f.lines.last_stamp());
  if (imu_) extend(layout_.imu->last_stamp());
}

std::optional<Measurement> TextDataset::next() {
  while (true) {
    const NextStream turn = next_stream(next_stamp(imu_), next_event_stamp(), next_frame_stamp());
    if (turn.stream == NextStream::Stream::None) return std::nullopt;
    if (turn.stream == NextStream::Stream::Imu) return imu_->pop();
    if (turn.stream == NextStream::Stream::Events) return take_events(turn.events_end);
    if (auto frame = load_next_frame()) return std::move(*frame);
  }
}

void TextDataset::leave_out(Modality unwanted) {
  if (unwanted == Modality::Events) {
    events_.clear();
  } else {
    frames_.clear();
  }
}

Timestamp TextDataset::next_event_stamp() {
  Timestamp next = Timestamp::max();
  for (EventStream& stream : events_) next = std::min(next, stream.events.peek() ? stream.events.peek()->t : next);
  return next;
}

/// The next events of all cameras. Of equal stamps, the first camera is first.
EventBatch TextDataset::take_events(Timestamp end) {
  const Timestamp t = next_event_stamp();
  EventStream& stream = *std::ranges::find_if(
      events_, [t](EventStream& candidate) { return candidate.events.peek() && candidate.events.peek()->t == t; });
  return {stream.camera, stream.events.take_before(std::min(end, t + kLongestBatch))};
}

Timestamp TextDataset::next_frame_stamp() const {
  Timestamp next = Timestamp::max();
  for (const FrameStream& stream : frames_) next = std::min(next, stream.lines.peek() ? stream.lines.peek()->t : next);
  return next;
}

/// The next frame of all cameras. Of equal stamps, the first camera is first.
std::optional<Frame> TextDataset::load_next_frame() {
  FrameStream& stream = *std::ranges::find_if(frames_, [t = next_frame_stamp()](const FrameStream& candidate) {
    return candidate.lines.peek() && candidate.lines.peek()->t == t;
  });
  const FrameEntry entry = stream.lines.pop();
  const auto skip = [&](const std::string& kind) {
    repairs_.add("frames: " + kind, entry.image.string() + ": " + kind);
    return std::nullopt;
  };
  if (!entry.image.is_file()) return skip("image missing");
  cv::Mat image = read_gray_image(entry.image);
  if (image.empty()) return skip("image unreadable");
  if (stream.size.empty()) stream.size = image.size();
  if (image.size() != stream.size) return skip("image of another size");
  return Frame{entry.t, stream.camera, image};
}

std::optional<GroundTruth> TextDataset::ground_truth() const {
  ground_truth_repairs_ = Repairs();
  return layout_.ground_truth ? layout_.ground_truth(ground_truth_repairs_) : std::nullopt;
}

std::map<std::string, std::size_t> TextDataset::repairs() const {
  std::map<std::string, std::size_t> all = repairs_.counts();
  for (const auto& [kind, count] : ground_truth_repairs_.counts()) all[kind] += count;
  return all;
}

}  // namespace edged
