// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The reader of all layouts. Of the sources of events, frames and IMU samples, it reads the one that lags most.
#include "edged/io/hdf5/hdf5.hpp"

#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <span>

#include "edged/core/check.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/core/streamed_dataset.hpp"
#include "edged/io/hdf5/layouts.hpp"
#include "edged/io/hdf5/side_files.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kEventsAtOnce = 65536, kSamplesAtOnce = 1024;
constexpr Duration kStep = std::chrono::milliseconds(50);  // of one stream at a time

cv::Mat h5_image(const H5Array& pixels, std::uint64_t row, bool cut) {
  const auto& shape = pixels.shape();
  const int channels = shape.size() == 4 ? static_cast<int>(shape[3]) : 1;
  if (shape[1] > 16384 || shape[2] > 16384 || (channels != 1 && channels != 3))
    throw Damage("images of an invalid size");
  auto bytes = pixels.read<std::uint8_t>(row, 1);
  if (cut && std::ranges::all_of(bytes, [](std::uint8_t b) { return b == 0; }))
    throw Damage("data after the end of a cut file");
  const cv::Mat image(static_cast<int>(shape[1]), static_cast<int>(shape[2]), CV_8UC(channels), bytes.data());
  cv::Mat grey;
  if (channels == 1) return image.clone();
  cv::cvtColor(image, grey, cv::COLOR_RGB2GRAY);
  return grey;
}

class Hdf5Dataset final : public StreamedDataset {
 public:
  Hdf5Dataset(const H5File& file, const Hdf5Layout& layout, H5Cameras cameras, SideFiles side)
      : StreamedDataset(file.path(), side.set.empty() ? std::string(layout.name) : side.set), side_(std::move(side)) {
    if (!side_.truth.read) side_.truth = find_h5_truth(file, layout);
    info_.pose_frame = camera_by_usual_name(cameras.known, side_.truth.frame).value_or(side_.truth.frame);
    for (const fs::path& cut : cameras.cut)
      repairs_.add("file: cut", cut.string() + ": the file ends too early; what it has is read");
    for (std::size_t i = 0; i < cameras.events.size(); ++i) {
      if (i == 0) set_sensor(cameras.recorded[i].sensor);
      info_.end = std::max(info_.end, cameras.events[i].last());
      if (cameras.events[i].ragged())
        repairs_.add("events: arrays of different lengths",
                     name_ + ": x, y, t and p differ in length; the shortest counts");
      add_rows<Event>(std::move(cameras.events[i]), {kEventsAtOnce, 1024, "events", Modality::Events},
                      [this, i](std::span<const Event> part) { push_wanted_events(part, i); });
    }
    for (std::size_t i = 0; i < cameras.frames.size(); ++i) {
      if (auto* images = std::get_if<H5Images>(&cameras.frames[i])) {
        add_images(std::move(*images), i, file.cut());
      } else {
        add_image_files(std::get<StampedLines<FrameEntry>::Spec>(cameras.frames[i]), i);
      }
    }
    auto imu = H5Imu::find(file, layout);
    const bool has_imu = imu || side_.imu;
    if (imu) {
      add_rows<ImuSample>(std::move(*imu), {kSamplesAtOnce, 16, "imu", std::nullopt}, push_samples());
    } else if (side_.imu) {
      add_imu_lines(*side_.imu);
    }
    begin(cameras.recorded, has_imu);
  }

  std::optional<GroundTruth> ground_truth() const override {
    Repairs logged;
    auto truth = side_.truth.read ? side_.truth.read(logged) : std::nullopt;
    if (truth) truth->frame = info_.pose_frame;
    return truth;
  }

 private:
  /// Reads a part of the stream of one sensor and sets the stamp that it has reached. False at its end.
  struct Source {
    std::function<bool(Timestamp&)> read;
    Timestamp reached = Timestamp::min();
  };

  bool read_on() override {
    const auto lagging = std::ranges::min_element(sources_, {}, &Source::reached);
    if (lagging == sources_.end()) return false;
    if (!lagging->read(lagging->reached)) sources_.erase(lagging);
    return true;
  }

  /// A source of items with stamps. refill() reads items into an empty vector and returns false at the end. They may
  /// span more time than the merger waits for other streams, so they are pushed in short steps.
  template <typename T>
  void add_source(std::function<bool(std::vector<T>&)> refill, std::function<void(std::span<const T>)> push) {
    sources_.push_back({[refill = std::move(refill), push = std::move(push), items = std::vector<T>(),
                         next = std::size_t{0}](Timestamp& reached) mutable {
      if (next == items.size()) {
        items.clear();
        next = 0;
        if (!refill(items)) return false;
        if (items.empty()) return true;  // all of it was damaged
      }
      const auto first = items.begin() + static_cast<std::ptrdiff_t>(next);
      auto end = std::find_if(first, items.end(), [&](const T& item) { return item.t >= reached + kStep; });
      if (end == first) ++end;  // after a gap or a wrong stamp, which the next item decides
      push(std::span<const T>(first, end));
      next = static_cast<std::size_t>(end - items.begin());
      reached = end == items.end() ? std::prev(end)->t : std::min(std::prev(end)->t, end->t);
      return true;
    }});
  }

  /// Calls read(first, count). If it throws Damage, reads both halves separately, so that at most `smallest` rows
  /// around the damage are left out.
  template <typename Read>
  void read_parts(std::uint64_t first, std::uint64_t count, std::uint64_t smallest, const char* subject,
                  const Read& read) {
    try {
      read(first, count);
    } catch (const Damage& damage) {
      if (count > smallest) {
        read_parts(first, count / 2, smallest, subject, read);
        read_parts(first + count / 2, count - count / 2, smallest, subject, read);
      } else {
        repairs_.add(std::string(subject) + ": part unreadable", fmt::format("{}: {}", name_, damage.what()));
      }
    }
  }

  /// How rows are read: so many at once, and so few around damage. Those of an unwanted modality are not read.
  struct RowReading {
    std::uint64_t at_once, smallest;
    const char* subject;
    std::optional<Modality> modality;
  };

  /// A source of the rows of H5Events or H5Imu.
  template <typename T, typename Rows>
  void add_rows(Rows from, const RowReading& how, std::function<void(std::span<const T>)> push) {
    const auto refill = [this, rows = std::make_shared<Rows>(std::move(from)), how,
                         at = std::uint64_t{0}](std::vector<T>& items) mutable {
      if (at == rows->rows() || !wants(how.modality)) return false;
      const std::uint64_t count = std::min(how.at_once, rows->rows() - at);
      if (how.modality && skips_block(count)) {
        at += count;
        return true;
      }
      read_parts(at, count, how.smallest, how.subject, [&](std::uint64_t first, std::uint64_t n) {
        std::vector<T> read = rows->read(first, n);
        std::erase_if(read, [&](const T& item) { return !is_stamp(item.t, how.subject) || !is_finite(item); });
        items.insert(items.end(), read.begin(), read.end());
      });
      at += count;
      return true;
    };
    add_source<T>(refill, std::move(push));
  }

  bool is_stamp(Timestamp t, const char* subject) {
    if (t != Timestamp::min()) return true;
    repairs_.add(std::string(subject) + ": stamp out of range", fmt::format("{}: a stamp of the {}", name_, subject));
    return false;
  }

  static bool is_finite(const Event& /*event*/) { return true; }
  bool is_finite(const ImuSample& sample) {
    if (sample.gyro_B.allFinite() && sample.accel_B.allFinite()) return true;
    repairs_.add("imu: not finite", name_ + ": an IMU sample is not finite");
    return false;
  }

  std::function<void(std::span<const ImuSample>)> push_samples() {
    return [this](std::span<const ImuSample> part) {
      for (const ImuSample& sample : part) push_imu(sample);
    };
  }

  void add_images(H5Images images, std::size_t camera, bool cut) {
    const auto shared = std::make_shared<H5Images>(std::move(images));
    const std::uint64_t rows = std::min(shared->pixels.rows(), shared->stamps.rows());
    sources_.push_back({[this, shared, rows, camera, cut, at = std::uint64_t{0}](Timestamp& reached) mutable {
      if (at == rows || !wants(Modality::Frames)) return false;
      read_parts(at++, 1, 1, "frames", [&](std::uint64_t row, std::uint64_t) {
        const Timestamp t = shared->stamps.read(row, 1).front();
        if (!is_stamp(t, "frames")) return;
        reached = t;
        push_frame(t, h5_image(shared->pixels, row, cut), camera);
      });
      return true;
    }});
  }

  void add_image_files(const StampedLines<FrameEntry>::Spec& spec, std::size_t camera) {
    const auto lines = std::make_shared<StampedLines<FrameEntry>>(spec, repairs_);
    sources_.push_back({[this, lines, camera](Timestamp& reached) {
      if (!lines->peek() || !wants(Modality::Frames)) return false;
      const FrameEntry entry = lines->pop();
      reached = entry.t;
      try {
        if (!entry.image.is_file()) throw Damage("image missing");
        cv::Mat image = read_gray_image(entry.image);
        if (image.empty()) throw Damage("image unreadable");
        push_frame(entry.t, std::move(image), camera);
      } catch (const Damage& damage) {
        repairs_.add(fmt::format("frames: {}", damage.what()), entry.image.string() + ": " + damage.what());
      }
      return true;
    }});
  }

  void add_imu_lines(const StampedLines<ImuSample>::Spec& spec) {
    const auto refill = [lines =
                             std::make_shared<StampedLines<ImuSample>>(spec, repairs_)](std::vector<ImuSample>& items) {
      while (lines->peek() && items.size() < kSamplesAtOnce) items.push_back(lines->pop());
      return !items.empty();
    };
    add_source<ImuSample>(refill, push_samples());
  }

  SideFiles side_;
  std::vector<Source> sources_;
};

[[noreturn]] void refuse_layout(const H5File& file) {
  constexpr std::size_t kMostListed = 20;
  const auto described = [](const Hdf5Layout& layout) {
    return fmt::format("{}{} ({})", layout.events, layout.events.empty() ? "/x, y, t, p" : "", layout.name);
  };
  std::vector<std::string> held = file.list(kMostListed + 1);
  const bool more = held.size() > kMostListed;
  if (more) held.resize(kMostListed);
  if (held.empty()) held = {"no data sets"};
  throw InputError::format("{}: no events in a layout that is known; looked for {}; the file holds {}{}",
                           file.path().string(), fmt::join(texts_of(hdf5_layouts(), described), ", "),
                           fmt::join(held, ", "), more ? " and more" : "");
}

bool holds_events(const fs::path& file) try {
  const H5File h5(file);
  return std::ranges::any_of(hdf5_layouts(), [&](const Hdf5Layout& l) { return H5Events::find(h5, l).has_value(); });
} catch (const InputError&) {
  return false;
}

}  // namespace

std::optional<fs::path> find_hdf5_events(const fs::path& folder) {
  constexpr int kDeepest = 3;
  std::vector<fs::path> all, with_events;
  std::error_code ignored;
  for (auto it = fs::recursive_directory_iterator(folder, ignored); it != fs::recursive_directory_iterator();
       it.increment(ignored)) {
    if (it.depth() >= kDeepest) it.disable_recursion_pending();
    const std::string extension = it->path().extension().string();
    if ((extension == ".h5" || extension == ".hdf5") && it->is_regular_file(ignored)) all.push_back(it->path());
  }
  if (all.empty()) return std::nullopt;
  std::ranges::sort(all);
  std::ranges::copy_if(all, std::back_inserter(with_events), holds_events);
  if (with_events.size() > 1) {
    std::vector<fs::path> left = with_events;
    std::erase_if(
        left, [&](const fs::path& p) { return fs::relative(p, folder).string().find("left") == std::string::npos; });
    if (left.size() == 1) return left.front();
    const auto name = [](const fs::path& p) { return p.string(); };
    throw InputError::format("{}: events in several files: give one of {}", folder.string(),
                             fmt::join(texts_of(with_events, name), ", "));
  }
  // A file without events is refused when it is opened, with its content in the message.
  return with_events.empty() ? all.front() : with_events.front();
}

Recording open_hdf5(const fs::path& path, const Rig* rig, const RecordingOptions& options) {
  const H5File file(path);
  for (const Hdf5Layout& layout : hdf5_layouts()) {
    if (!H5Events::find(file, layout)) continue;
    SideFiles side = find_side_files(path, layout.name, options.own_imu);
    H5Cameras cameras = find_h5_cameras(file, layout, side, rig, options);
    return {std::make_unique<Hdf5Dataset>(file, layout, std::move(cameras), std::move(side)), std::nullopt};
  }
  refuse_layout(file);
}

}  // namespace edged
