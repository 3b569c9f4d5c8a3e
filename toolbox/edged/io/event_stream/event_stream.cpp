// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A header, then events of five bytes: the time since the previous one with the polarity, column, row. Single bytes
// between them lengthen that time.
#include "edged/io/event_stream/event_stream.hpp"

#include <spdlog/fmt/fmt.h>

#include <array>

#include "edged/core/check.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/core/streamed_dataset.hpp"

namespace edged {
namespace {

constexpr std::string_view kEventStreamMagic = "Event Stream";
constexpr std::size_t kEventStreamHeaderBytes = 20;

struct EventStreamHeader {
  bool atis = false;  ///< threshold crossings, which measure grey levels, lie between the events
  cv::Size sensor;
};

EventStreamHeader parse_event_stream_header(ByteSpan head, const std::string& file) {
  ByteReader reader(head);
  reader.take(kEventStreamMagic.size());
  const unsigned major = reader.number<std::uint8_t>(), minor = reader.number<std::uint8_t>();
  reader.number<std::uint8_t>();  // patch
  if (major != 2)
    throw InputError::format("{}: Event Stream {}.{} is not read, only 2: convert it with the program that wrote it",
                             file, major, minor);
  constexpr std::array<std::string_view, 5> kKinds{"generic", "DVS", "ATIS", "display", "colour"};
  const unsigned kind = reader.number<std::uint8_t>();
  if (kind != 1 && kind != 2)
    throw InputError::format("{}: holds {} events; of Event Stream, only those of DVS and ATIS can be read", file,
                             kind < kKinds.size() ? kKinds[kind] : "unknown");
  const int width = reader.number<std::uint16_t>(), height = reader.number<std::uint16_t>();
  if (width == 0 || height == 0) throw Damage(fmt::format("a sensor of {} x {} px", width, height));
  return {kind == 2, {width, height}};
}

class EventStreamDataset final : public StreamedDataset {
 public:
  EventStreamDataset(const std::filesystem::path& file, const EventStreamHeader& header, cv::Size sensor)
      : StreamedDataset(file, "event stream"), file_(file), header_(header) {
    set_sensor(sensor);
    begin(OneOfEach{.events = true});
  }

 private:
  bool read_on() override {
    const Bytes bytes = file_.read(at_, kBlockBytes);
    events_.clear();
    std::size_t read = 0;
    while (read < bytes.size()) {
      const std::size_t used = take(ByteSpan(bytes).subspan(read));
      if (used == 0) break;
      read += used;
    }
    at_ += read;
    if (read == 0 && !bytes.empty()) repairs_.add("file: cut", name_ + ": the file ends within an event");
    push_events(events_);
    return read > 0;
  }

  /// Decodes an event or a byte between events, and returns the number of its bytes; 0: it is incomplete. At an event
  /// outside the sensor, bytes are missing or wrong: the next event is searched byte by byte.
  std::size_t take(ByteSpan bytes) {
    constexpr std::size_t kEventBytes = 5;
    const unsigned flags = header_.atis ? 2 : 1;             // bits beside the time in its byte
    const unsigned first = bytes[0], most = 0xFFU >> flags;  // the longest time is no event
    if (const unsigned between = header_.atis ? 0xFC : 0xFE; first >= between) {
      t_us_ += std::int64_t{most} * (first - between);
      return 1;
    }
    if (bytes.size() < kEventBytes) return 0;
    const int x = bytes[1] | bytes[2] << 8, y = bytes[3] | bytes[4] << 8;
    if (x >= header_.sensor.width || y >= header_.sensor.height) {
      if (!searching_) count_outside(1);
      searching_ = true;
      return 1;
    }
    searching_ = false;
    t_us_ += first >> flags;
    const bool crossing = header_.atis && (first & 1U) != 0;
    if (!crossing)
      events_.push_back({timestamp_from_ns(t_us_ * 1000), static_cast<std::uint16_t>(x),
                         static_cast<std::uint16_t>(header_.sensor.height - 1 - y),  // rows count from below
                         (first >> (flags - 1) & 1U) != 0});
    return kEventBytes;
  }

  static constexpr std::size_t kBlockBytes = 262144;
  BinaryFile file_;
  EventStreamHeader header_;
  std::uint64_t at_ = kEventStreamHeaderBytes;
  std::int64_t t_us_ = 0;
  bool searching_ = false;
  std::vector<Event> events_;  // of the last block
};

}  // namespace

bool is_event_stream(ByteSpan head) {  // versions are low numbers, which no text has
  const std::size_t size = kEventStreamMagic.size();
  return as_text(head).starts_with(kEventStreamMagic) && (head.size() == size || head[size] < 0x09);
}

Recording open_event_stream(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options) try {
  const EventStreamHeader header =
      parse_event_stream_header(BinaryFile(file).read(0, kEventStreamHeaderBytes), file.string());
  const cv::Size sensor = event_sensor_size(file, options.geometry ? options.geometry : header.sensor, rig);
  return {std::make_unique<EventStreamDataset>(file, header, sensor), std::nullopt};
} catch (const Damage& damage) {
  throw InputError::format("{}: the header is damaged: {}", file.string(), damage.what());
}

}  // namespace edged
