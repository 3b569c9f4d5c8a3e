// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// AEDAT4 files written with the FlatBuffers library, for tests.
#pragma once

#include <flatbuffers/flatbuffers.h>
#include <lz4frame.h>
#include <spdlog/fmt/fmt.h>
#include <zstd.h>

#include <string>
#include <utility>
#include <vector>

#include "edged/core/types.hpp"

namespace edged {

class Aedat4Writer {
 public:
  /// compression: the number in the header, 0 to 4.
  Aedat4Writer(int compression, int width, int height) : compression_(compression) {
    std::string streams;
    for (const auto& [number, type] : {std::pair(0, "EVTS"), std::pair(1, "FRME"), std::pair(2, "IMUS")})
      streams += fmt::format(
          R"(<node name="{}"><attr key="typeIdentifier">{}</attr><node name="info"><attr key="sizeX">{}</attr>)"
          R"(<attr key="sizeY">{}</attr></node></node>)",
          number, type, width, height);
    flatbuffers::FlatBufferBuilder b;
    const auto xml = b.CreateString(R"(<dv version="2.0"><node name="outInfo">)" + streams + "</node></dv>");
    const auto start = b.StartTable();
    b.AddElement<std::int32_t>(slot(0), compression, 0);
    b.AddOffset(slot(2), xml);
    text_ = "#!AER-DAT4.0\r\n" + finished(b, start, "IOHE");
  }

  void events(const std::vector<Event>& events) {
    struct alignas(8) WireEvent {
      std::int64_t t;
      std::int16_t x, y;
      std::uint8_t on, none[3];
    };
    std::vector<WireEvent> wire;
    for (const Event& e : events)
      wire.push_back(
          {to_ns(e.t) / 1000, static_cast<std::int16_t>(e.x), static_cast<std::int16_t>(e.y), e.positive, {}});
    flatbuffers::FlatBufferBuilder b;
    const auto list = b.CreateVectorOfStructs(wire);
    const auto start = b.StartTable();
    b.AddOffset(slot(0), list);
    packet(0, finished(b, start, "EVTS"));
  }

  /// type: OpenCV's number. Stamped with the ends of an exposure of 2 ms around t.
  void frame(Timestamp t, int width, int height, int type, const std::vector<std::uint8_t>& pixels) {
    flatbuffers::FlatBufferBuilder b;
    const auto data = b.CreateVector(pixels);
    const auto start = b.StartTable();
    b.AddElement<std::int64_t>(slot(0), to_ns(t) / 1000 - 1000, 0);
    b.AddElement<std::int64_t>(slot(3), to_ns(t) / 1000 - 1000, 0);
    b.AddElement<std::int64_t>(slot(4), to_ns(t) / 1000 + 1000, 0);
    b.AddElement<std::int8_t>(slot(5), static_cast<std::int8_t>(type), 0);
    b.AddElement<std::int16_t>(slot(6), static_cast<std::int16_t>(width), 0);
    b.AddElement<std::int16_t>(slot(7), static_cast<std::int16_t>(height), 0);
    b.AddOffset(slot(10), data);
    packet(1, finished(b, start, "FRME"));
  }

  /// In g and deg/s.
  void imu(Timestamp t, const std::vector<float>& accel_g, const std::vector<float>& gyro_deg) {
    flatbuffers::FlatBufferBuilder b;
    const auto sample = b.StartTable();
    b.AddElement<std::int64_t>(slot(0), to_ns(t) / 1000, 0);
    for (unsigned i = 0; i < 3; ++i) {
      b.AddElement<float>(slot(2 + i), accel_g[i], 0);
      b.AddElement<float>(slot(5 + i), gyro_deg[i], 0);
    }
    const std::vector<flatbuffers::Offset<void>> samples{flatbuffers::Offset<void>(b.EndTable(sample))};
    const auto list = b.CreateVector(samples);
    const auto start = b.StartTable();
    b.AddOffset(slot(0), list);
    packet(2, finished(b, start, "IMUS"));
  }

  /// As an interrupted recording leaves it: without a table at the end.
  const std::string& text() const { return text_; }

 private:
  static flatbuffers::voffset_t slot(unsigned field) { return static_cast<flatbuffers::voffset_t>(4 + 2 * field); }

  static std::string finished(flatbuffers::FlatBufferBuilder& b, flatbuffers::uoffset_t start, const char* type) {
    b.FinishSizePrefixed(flatbuffers::Offset<void>(b.EndTable(start)), type);
    return {reinterpret_cast<const char*>(b.GetBufferPointer()), b.GetSize()};
  }

  void packet(std::int32_t stream, const std::string& body) {
    std::string packed = body;
    if (compression_ == 1 || compression_ == 2) {
      packed.resize(LZ4F_compressFrameBound(body.size(), nullptr));
      packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), body.data(), body.size(), nullptr));
    } else if (compression_ >= 3) {
      packed.resize(ZSTD_compressBound(body.size()));
      packed.resize(ZSTD_compress(packed.data(), packed.size(), body.data(), body.size(), 1));
    }
    for (const std::int32_t number : {stream, static_cast<std::int32_t>(packed.size())})
      text_.append(reinterpret_cast<const char*>(&number), sizeof number);
    text_ += packed;
  }

  int compression_;
  std::string text_;
};

}  // namespace edged
