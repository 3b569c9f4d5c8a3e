// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The FlatBuffers of the format: six tables with numbered fields, built without generated code.
#include "edged/io/aedat/aedat4_writer.hpp"

#include <flatbuffers/flatbuffers.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>
#include <numbers>

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/io/aedat/aedat.hpp"
#include "edged/io/aedat/aedat4_dataset.hpp"
#include "edged/io/archive/compression.hpp"
#include "edged/io/core/camera_names.hpp"

namespace edged {
namespace {

using flatbuffers::FlatBufferBuilder;

flatbuffers::voffset_t slot(unsigned field) { return static_cast<flatbuffers::voffset_t>(4 + 2 * field); }

std::int64_t to_us(Timestamp t) { return to_ns(t) / 1000; }

/// The buffer with its length in front.
std::string finished(FlatBufferBuilder& b, flatbuffers::uoffset_t start, const char* type) {
  b.FinishSizePrefixed(flatbuffers::Offset<void>(b.EndTable(start)), type);
  return {reinterpret_cast<const char*>(b.GetBufferPointer()), b.GetSize()};
}

/// A table with the list as its only field.
template <typename List>
std::string finished_list(FlatBufferBuilder& b, List list, const char* type) {
  const auto start = b.StartTable();
  b.AddOffset(slot(aedat4::kItems), list);
  return finished(b, start, type);
}

std::string stream_xml(int number, const char* compression, const std::string& output, const char* type,
                       const std::string& info) {
  const std::string path = fmt::format("/mainloop/Recorder/outInfo/{}/", number);
  return fmt::format(
      R"(<node name="{0}" path="{1}"><attr key="compression" type="string">{2}</attr>)"
      R"(<attr key="originalModuleName" type="string">capture</attr>)"
      R"(<attr key="originalOutputName" type="string">{3}</attr>)"
      R"(<attr key="typeDescription" type="string">{3}</attr><attr key="typeIdentifier" type="string">{4}</attr>)"
      R"(<node name="info" path="{1}info/">{5}<attr key="source" type="string">edged</attr>)"
      R"(<attr key="tsOffset" type="long">0</attr></node></node>)",
      number, path, compression, output, type, info);
}

std::string size_xml(cv::Size size) {
  return fmt::format(R"(<attr key="sizeX" type="int">{}</attr><attr key="sizeY" type="int">{}</attr>)", size.width,
                     size.height);
}

}  // namespace

void Aedat4Encoder::set_cameras(std::vector<cv::Size> sensors, std::size_t frame_cameras) {
  sensors_ = std::move(sensors);
  frame_cameras_ = frame_cameras;
}

int Aedat4Encoder::stream_of(Modality modality, std::size_t camera) const {
  constexpr std::size_t kFurther = 3;
  const bool events = modality == Modality::Events;
  if (camera == 0) return events ? 0 : 1;
  return static_cast<int>(kFurther + camera - 1 + (events ? 0 : sensors_.size() - 1));
}

std::string Aedat4Encoder::header_xml() const {
  const char* const name = kAedat4Compressions[static_cast<std::size_t>(compression_)].name;
  std::map<int, std::string> streams = {{2, stream_xml(2, name, "imu", "IMUS", "")}};
  const auto add = [&](Modality modality, const char* type, std::size_t camera, cv::Size size) {
    const int number = stream_of(modality, camera);
    streams[number] = stream_xml(number, name, usual_camera_name(modality, camera), type, size_xml(size));
  };
  for (std::size_t i = 0; i < sensors_.size(); ++i) add(Modality::Events, "EVTS", i, sensors_[i]);
  for (std::size_t i = 0; i < frame_cameras_; ++i)
    add(Modality::Frames, "FRME", i, sensors_[std::min(i, sensors_.size() - 1)]);
  std::string xml = R"(<dv version="2.0">)";
  if (pose_frame_ != "body")
    xml += fmt::format(R"(<attr key="{}" type="string">{}</attr>)", kAedat4PoseFrame, pose_frame_);
  xml += R"(<node name="outInfo" path="/mainloop/Recorder/outInfo/">)";
  for (const auto& [number, stream] : streams) xml += stream;
  return xml + "</node></dv>";
}

std::string Aedat4Encoder::header(std::int64_t table_at) const {
  FlatBufferBuilder b;
  const auto xml = b.CreateString(header_xml());
  const auto start = b.StartTable();
  b.AddElement<std::int32_t>(slot(aedat4::kCompression), static_cast<std::int32_t>(compression_), 0);
  b.AddElement<std::int64_t>(slot(aedat4::kTableAt), table_at,
                             0);  // no default value, so that the length of the header is constant
  b.AddOffset(slot(aedat4::kXml), xml);
  return std::string(kAedat4Magic) + finished(b, start, "IOHE");
}

std::string Aedat4Encoder::events(std::span<const Event> events, std::size_t camera) {
  struct alignas(8) WireEvent {
    std::int64_t t;
    std::int16_t x, y;
    std::uint8_t on, none[3];
  };
  std::vector<WireEvent> wire;
  wire.reserve(events.size());
  for (const Event& e : events)
    wire.push_back({to_us(e.t), static_cast<std::int16_t>(e.x), static_cast<std::int16_t>(e.y), e.positive, {}});
  FlatBufferBuilder b;
  const auto list = b.CreateVectorOfStructs(wire);
  const int stream = stream_of(Modality::Events, camera);
  return packet(
      {0, stream, 0, static_cast<std::int64_t>(events.size()), to_us(events.front().t), to_us(events.back().t)},
      finished_list(b, list, "EVTS"));
}

std::string Aedat4Encoder::frame(const Frame& frame, Duration exposure, std::size_t camera) {
  const cv::Mat image = frame.image.isContinuous() ? frame.image : frame.image.clone();
  FlatBufferBuilder b;
  const auto pixels = b.CreateVector(image.data, image.total() * image.elemSize());
  const auto start = b.StartTable();
  const std::int64_t begin_us = to_us(frame.t - exposure / 2), end_us = to_us(frame.t + exposure / 2);
  for (const unsigned field : {aedat4::kStamp, aedat4::kBegin, aedat4::kExposureBegin})
    b.AddElement<std::int64_t>(slot(field), begin_us, 0);
  for (const unsigned field : {aedat4::kEnd, aedat4::kExposureEnd}) b.AddElement<std::int64_t>(slot(field), end_us, 0);
  b.AddElement<std::int8_t>(slot(aedat4::kType), static_cast<std::int8_t>(image.type()), 0);
  b.AddElement<std::int16_t>(slot(aedat4::kWidth), static_cast<std::int16_t>(image.cols), 0);
  b.AddElement<std::int16_t>(slot(aedat4::kHeight), static_cast<std::int16_t>(image.rows), 0);
  b.AddOffset(slot(aedat4::kPixels), pixels);
  return packet({0, stream_of(Modality::Frames, camera), 0, 1, begin_us, end_us}, finished(b, start, "FRME"));
}

std::string Aedat4Encoder::imu(std::span<const ImuSample> samples) {
  FlatBufferBuilder b;
  std::vector<flatbuffers::Offset<void>> tables;
  for (const ImuSample& s : samples) {
    const auto start = b.StartTable();
    b.AddElement<std::int64_t>(slot(aedat4::kImuStamp), to_us(s.t), 0);
    for (unsigned i = 0; i < 3; ++i) {
      b.AddElement<float>(slot(aedat4::kAccel + i), static_cast<float>(s.accel_B[i] / kStandardGravity), 0);
      b.AddElement<float>(slot(aedat4::kGyro + i), static_cast<float>(s.gyro_B[i] * 180 / std::numbers::pi), 0);
    }
    tables.emplace_back(b.EndTable(start));
  }
  return packet({0, 2, 0, static_cast<std::int64_t>(samples.size()), to_us(samples.front().t), to_us(samples.back().t)},
                finished_list(b, b.CreateVector(tables), "IMUS"));
}

std::string Aedat4Encoder::table() const {
  struct alignas(4) WirePacket {
    std::int32_t stream, bytes;
  };
  FlatBufferBuilder b;
  std::vector<flatbuffers::Offset<void>> tables;
  for (const PacketEntry& p : packets_) {
    const WirePacket info{p.stream, p.bytes};
    const auto start = b.StartTable();
    b.AddElement<std::int64_t>(slot(aedat4::kBodyAt), p.at, 0);
    b.AddStruct(slot(aedat4::kStreamAndBytes), &info);
    b.AddElement<std::int64_t>(slot(aedat4::kCount), p.count, 0);
    b.AddElement<std::int64_t>(slot(aedat4::kFirstStamp), p.first_us, 0);
    b.AddElement<std::int64_t>(slot(aedat4::kLastStamp), p.last_us, 0);
    tables.emplace_back(b.EndTable(start));
  }
  return packed(finished_list(b, b.CreateVector(tables), "FTAB"));
}

std::string Aedat4Encoder::packed(const std::string& body) const {
  return compress(kAedat4Compressions[static_cast<std::size_t>(compression_)].method, body);
}

std::string Aedat4Encoder::packet(PacketEntry entry, const std::string& body) {
  const std::string content = packed(body);
  entry.bytes = static_cast<std::int32_t>(content.size());
  std::string out;
  append_number(out, entry.stream);
  append_number(out, entry.bytes);
  entry.at = static_cast<std::int64_t>(header().size() + out.size()) + packets_bytes_;
  packets_.push_back(entry);
  out += content;
  packets_bytes_ += static_cast<std::int64_t>(out.size());
  return out;
}

namespace {

class Aedat4Writer final : public RecordingWriter {
 public:
  explicit Aedat4Writer(const WriterSetup& setup)
      : setup_(setup),
        encoder_(Aedat4Encoder::Compression::Lz4, setup.event_sensor(), pose_frame(setup)),
        file_(setup.path),
        events_(setup.cameras(Modality::Events)) {
    std::vector<cv::Size> sensors;
    for (std::size_t i = 0; i < events_.size(); ++i) sensors.push_back(setup.event_sensor(i));
    encoder_.set_cameras(sensors, setup.cameras(Modality::Frames));
    file_.write(encoder_.header());
  }

  void write(const EventBatch& batch) override {
    const std::size_t camera = setup_.place_of(batch.camera, Modality::Events);
    std::vector<Event>& held = events_[camera];
    for (const Event& event : batch.events) {
      if (event.t < Timestamp())
        throw InputError::format("{}: the format holds no stamps before 0, the recording has them",
                                 setup_.path.string());
      if (held.size() >= kMostEvents || (!held.empty() && event.t - held.front().t > kLongestPacket))
        flush_events(camera);
      held.push_back(event);
    }
  }

  void write(const Frame& frame) override {
    file_.write(encoder_.frame(frame, Duration(0), setup_.place_of(frame.camera, Modality::Frames)));
  }

  void write(const ImuSample& sample) override {
    if (!imu_.empty() && sample.t - imu_.front().t > kLongestPacket) flush_imu();
    imu_.push_back(sample);
  }

  void finish() override {
    for (std::size_t i = 0; i < events_.size(); ++i) flush_events(i);
    flush_imu();
    const auto table_at = static_cast<std::int64_t>(file_.size());
    file_.write(encoder_.table());
    file_.overwrite(0, encoder_.header(table_at));
    file_.flush();
  }

 private:
  static constexpr std::size_t kMostEvents = 10'000;
  static constexpr Duration kLongestPacket = std::chrono::milliseconds(10);

  /// The frame of poses is kept only if it is a camera.
  static std::string pose_frame(const WriterSetup& setup) {
    const std::string frame = setup.name_when_read(setup.info.pose_frame);
    return frame.starts_with("events") || frame.starts_with("frames") ? frame : "body";
  }

  void flush_events(std::size_t camera) {
    if (!events_[camera].empty()) file_.write(encoder_.events(events_[camera], camera));
    events_[camera].clear();
  }

  void flush_imu() {
    if (!imu_.empty()) file_.write(encoder_.imu(imu_));
    imu_.clear();
  }

  WriterSetup setup_;
  Aedat4Encoder encoder_;
  OutputFile file_;
  std::vector<std::vector<Event>> events_;  ///< not yet written, for each camera
  std::vector<ImuSample> imu_;
};

}  // namespace

std::unique_ptr<RecordingWriter> write_aedat4(const WriterSetup& setup) {
  return std::make_unique<Aedat4Writer>(setup);
}

}  // namespace edged
