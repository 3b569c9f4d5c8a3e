// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Merges sensors by stamp, and loads images when they are needed.
#include "edged/io/text/text_dataset.hpp"

#include <algorithm>
#include <map>

#include "edged/core/check.hpp"
#include "edged/io/core/merger.hpp"

namespace edged {
namespace {

/// The items of one camera.
template <typename Items>
struct CameraItems {
  std::string camera;
  Items items;
  cv::Size size = {};  ///< of its first image
};

/// The camera with the next item, of equal stamps the first; null after the last item.
template <typename Items>
CameraItems<Items>* next_camera(std::vector<CameraItems<Items>>& cameras) {
  CameraItems<Items>* next = nullptr;
  for (CameraItems<Items>& camera : cameras)
    if (const auto* item = camera.items.peek(); item && (!next || item->t < next->items.peek()->t)) next = &camera;
  return next;
}

template <typename Items>
Timestamp next_stamp(CameraItems<Items>* camera) {
  return camera ? camera->items.peek()->t : Timestamp::max();
}

class TextDataset final : public Dataset {
 public:
  explicit TextDataset(TextLayout layout) : layout_(std::move(layout)) {
    open_streams();
    find_ends();
  }

  const DatasetInfo& info() const override { return layout_.info; }

  std::optional<Measurement> next() override {
    while (true) {
      auto* const events = next_camera(events_);
      auto* const frames = next_camera(frames_);
      const NextStream turn = next_stream(next_imu(), next_stamp(events), next_stamp(frames));
      if (turn.stream == NextStream::Stream::None) return std::nullopt;
      if (turn.stream == NextStream::Stream::Imu) return imu_->pop();
      if (turn.stream == NextStream::Stream::Events) {
        const Timestamp end = std::min(turn.events_end, next_stamp(events) + kLongestBatch);
        return EventBatch{events->camera, events->items.take_before(end)};
      }
      if (auto frame = load_frame(*frames)) return std::move(*frame);
    }
  }

  void leave_out(Modality unwanted) override {
    if (unwanted == Modality::Events) {
      events_.clear();
    } else {
      frames_.clear();
    }
  }

  std::optional<GroundTruth> ground_truth() const override {
    ground_truth_repairs_ = Repairs();
    return layout_.ground_truth ? layout_.ground_truth(ground_truth_repairs_) : std::nullopt;
  }

  std::map<std::string, std::size_t> repairs() const override {
    std::map<std::string, std::size_t> all = repairs_.counts();
    for (const auto& [kind, count] : ground_truth_repairs_.counts()) all[kind] += count;
    return all;
  }

 private:
  void open_streams() {
    std::string files;
    const auto opened = [&](auto& stream, const std::string& subject, const SourcePath& file) {
      files += (files.empty() ? "" : ", ") + file.name();
      if (stream.peek()) return true;
      repairs_.add(subject + ": empty file", file.string() + ": holds nothing readable");
      return false;
    };
    DatasetInfo& info = layout_.info;
    for (const EventFile& e : layout_.events) {
      EventTextStream events(e.file, e.columns, e.width, e.height, repairs_);
      if (!opened(events, "events", e.file)) continue;
      if (&e != &layout_.events.front())
        info.more_cameras.push_back({e.camera, Modality::Events, e.file.name(), {e.width, e.height}});
      events_.push_back({e.camera, std::move(events)});
    }
    for (const FrameFile& f : layout_.frames) {
      StampedLines<FrameEntry> lines(f.lines, repairs_);
      if (!opened(lines, "frames", f.lines.file)) continue;
      if (&f != &layout_.frames.front()) info.more_cameras.push_back({f.camera, Modality::Frames, f.lines.file.name()});
      frames_.push_back({f.camera, std::move(lines)});
    }
    if (const auto& i = layout_.imu) {
      imu_.emplace(*i, repairs_);
      info.has_imu = opened(*imu_, "imu", i->file);
      if (!info.has_imu) imu_.reset();
    }
    info.has_events = !events_.empty();
    info.has_frames = !frames_.empty();
    if (!layout_.events.empty()) info.event_camera = layout_.events.front().camera;
    if (!layout_.frames.empty()) info.frame_camera = layout_.frames.front().camera;
    if (!info.has_events && !info.has_frames && !info.has_imu)
      throw InputError::format("{}: nothing to read: {} hold no readable line", info.name, files);
  }

  void find_ends() {
    DatasetInfo& info = layout_.info;
    info.begin = std::min({next_imu(), next_stamp(next_camera(events_)), next_stamp(next_camera(frames_))});
    const auto extend = [&info](std::optional<Timestamp> t) {
      if (t) info.end = std::max(info.end.value_or(*t), *t);
    };
    for (const EventFile& e : layout_.events)
      extend(last_stamp(e.file, [&e](std::string_view line) { return parse_event_stamp(line, e.columns); }));
    for (const FrameFile& f : layout_.frames) extend(f.lines.last_stamp());
    if (imu_) extend(layout_.imu->last_stamp());
  }

  Timestamp next_imu() const { return imu_ && imu_->peek() ? imu_->peek()->t : Timestamp::max(); }

  /// Nothing for an image that is left out.
  std::optional<Frame> load_frame(CameraItems<StampedLines<FrameEntry>>& stream) {
    const FrameEntry entry = stream.items.pop();
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

  TextLayout layout_;
  Repairs repairs_;
  mutable Repairs ground_truth_repairs_;  ///< made in the last reading, so that repeated readings are not counted twice
  std::vector<CameraItems<EventTextStream>> events_;
  std::vector<CameraItems<StampedLines<FrameEntry>>> frames_;
  std::optional<StampedLines<ImuSample>> imu_;
};

}  // namespace

std::unique_ptr<Dataset> open_text(TextLayout layout) { return std::make_unique<TextDataset>(std::move(layout)); }

}  // namespace edged
