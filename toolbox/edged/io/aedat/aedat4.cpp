// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// AEDAT4 files: header, packets and the table at the end. Reading continues after damage.
#include "edged/io/aedat/aedat.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/io/aedat/aedat4_dataset.hpp"
#include "edged/io/archive/compression.hpp"
#include "edged/io/archive/record_file.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

/// The buffer of the header. It follows the version line and the length.
Bytes read_header_buffer(BinaryFile& file) {
  const auto bytes = number_at<std::uint32_t>(file.read(kAedat4Magic.size(), 4), 0);
  if (bytes > kMostPacketBytes) throw Damage("ends too early");
  Bytes buffer = file.read(kAedat4Magic.size() + 4, bytes);
  if (buffer.size() < bytes) throw Damage("ends too early");
  return buffer;
}

/// Packets are records of the stream that their head names. The table at the end of the file is their index.
class Aedat4File final : public Aedat4Dataset, private RecordFile {
 public:
  Aedat4File(const std::filesystem::path& file, BinaryFile bytes, const Aedat4Header& header, std::uint64_t packets_at,
             const Rig* rig, const RecordingOptions& options)
      : Aedat4Dataset(file, "aedat4"), RecordFile(std::move(bytes), packets_at), header_(header) {
    choose(header_.streams, rig, options);
    set_pose_frame(header_.pose_frame);
    read_table();
    begin_chosen();
  }

 private:
  /// Reads the end of the recording and the offsets of its packets. An interrupted recording has no table and is read
  /// to its end.
  void read_table() try {
    if (header_.table_at < 0 || static_cast<std::uint64_t>(header_.table_at) >= file().size())
      throw Damage("is missing: the recording was interrupted");
    const auto table_at = static_cast<std::uint64_t>(header_.table_at);
    if (file().size() - table_at > kMostPacketBytes) throw Damage("is too long");
    const Bytes packed = file().read(table_at, static_cast<std::size_t>(file().size() - table_at));
    const Decompressed table = decompress(header_.compression, packed, kMostPacketBytes);
    const FlatTable root(flat_buffer(table.bytes, "FTAB"));
    const FlatVector packets = root.vector(aedat4::kItems, 4);
    std::int64_t last_us = 0;
    for (std::size_t i = 0; i < packets.count; ++i) {
      const FlatTable packet = root.table(packets, i);
      last_us = std::max(last_us, packet.number<std::int64_t>(aedat4::kLastStamp));
      const auto body_at = packet.number<std::int64_t>(aedat4::kBodyAt);
      if (body_at >= static_cast<std::int64_t>(kPacketHeadBytes))
        index_[static_cast<std::uint64_t>(body_at) - kPacketHeadBytes];
    }
    set_end(table_at);
    if (last_us > 0 && last_us <= kMaxStampNs / 1000) info_.end = timestamp_from_ns(last_us * 1000);
  } catch (const Damage& damage) {
    repairs_.add("file: no table", fmt::format("{}: the table at its end {}; read without it", name_, damage.what()));
  }

  RecordPlace locate(std::uint64_t at) override {
    const Aedat4PacketHead packet = parse_packet_head(file().read(at, kPacketHeadBytes), header_.streams);
    const std::uint64_t data = at + kPacketHeadBytes, bytes = static_cast<std::uint64_t>(packet.bytes);
    if (!packet.stream || data + bytes > end()) throw Damage("no whole packet");
    return {at, data, bytes, static_cast<std::uint32_t>(*packet.stream)};
  }

  /// The body of a packet begins with the magic bytes of the compression or with a FlatBuffers header.
  bool begins_record(ByteSpan bytes) const override {
    constexpr std::size_t kTypeEnd = 12;
    if (bytes.size() < kPacketHeadBytes + kTypeEnd) return false;
    const std::string_view text = as_text(bytes.subspan(kPacketHeadBytes));
    if (header_.compression == "lz4") return text.starts_with("\x04\x22\x4d\x18");
    if (header_.compression == "zstd") return text.starts_with("\x28\xb5\x2f\xfd");
    const std::string_view type = text.substr(8, 4);
    return type == "EVTS" || type == "FRME" || type == "IMUS" || type == "TRIG";
  }

  void count_damage(std::uint64_t at, const std::string& reason, std::optional<std::uint64_t> next) override {
    repairs_.add("file: cut", fmt::format("{}: {} at byte {}; {}", name_, reason, at,
                                          next ? fmt::format("continues at byte {}", *next) : "the rest is not read"));
  }

  bool read_on() override {
    const auto packet = next_place();
    if (packet && reads(packet->kind))
      take_packet(packet->kind, header_.compression, file().read(packet->data, static_cast<std::size_t>(packet->bytes)),
                  fmt::format("at byte {}", packet->data));
    return packet.has_value();
  }

  Aedat4Header header_;
};

}  // namespace

bool is_aedat4(ByteSpan head) { return as_text(head).starts_with(kAedat4Magic); }

Recording open_aedat4(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options) try {
  BinaryFile bytes(file);
  const Bytes buffer = read_header_buffer(bytes);
  const Aedat4Header header = parse_aedat4_header(buffer);
  const std::uint64_t packets_at = kAedat4Magic.size() + 4 + buffer.size();
  return {std::make_unique<Aedat4File>(file, std::move(bytes), header, packets_at, rig, options), std::nullopt};
} catch (const Damage& damage) {
  throw InputError::format("{}: the header is damaged: {}", file.string(), damage.what());
}

}  // namespace edged
