// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// AEDAT4 files: header, packets and the table at the end. Reading continues after damage.
#include "edged/io/aedat/aedat4.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/io/aedat/aedat4_dataset.hpp"
#include "edged/io/aedat/flat_table.hpp"
#include "edged/io/archive/compression.hpp"
#include "edged/io/core/geometry.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr std::size_t kPacketHeadBytes = 8;

/// The buffer of the header. It follows the version line and the length.
Bytes read_header_buffer(BinaryFile& file) {
  const auto bytes = number_at<std::uint32_t>(file.read(kAedat4Magic.size(), 4), 0);
  if (bytes > kMostPacketBytes) throw Damage("ends too early");
  Bytes buffer = file.read(kAedat4Magic.size() + 4, bytes);
  if (buffer.size() < bytes) throw Damage("ends too early");
  return buffer;
}

class Aedat4File final : public Aedat4Dataset {
 public:
  Aedat4File(const std::filesystem::path& file, BinaryFile bytes, const Aedat4Header& header, std::uint64_t packets_at,
             const Rig* rig, const RecordingOptions& options)
      : Aedat4Dataset(file, "aedat4"),
        file_(std::move(bytes)),
        header_(header),
        at_(packets_at),
        last_at_(packets_at),
        end_(file_.size()) {
    choose(header_.streams, rig, options);
    set_pose_frame(header_.pose_frame);
    read_table();
    begin_chosen();
  }

 private:
  /// Reads the end of the recording and the offsets of its packets. An interrupted recording has no table and is read
  /// to its end.
  void read_table() try {
    if (header_.table_at < 0 || static_cast<std::uint64_t>(header_.table_at) >= file_.size())
      throw Damage("is missing: the recording was interrupted");
    const auto table_at = static_cast<std::uint64_t>(header_.table_at);
    if (file_.size() - table_at > kMostPacketBytes) throw Damage("is too long");
    const Bytes packed = file_.read(table_at, static_cast<std::size_t>(file_.size() - table_at));
    const Decompressed table = decompress(header_.compression, packed, kMostPacketBytes);
    const FlatTable root(flat_buffer(table.bytes, "FTAB"));
    const FlatVector packets = root.vector(0, 4);
    std::int64_t last_us = 0;
    for (std::size_t i = 0; i < packets.count; ++i) {
      const FlatTable packet = root.table(packets, i);
      last_us = std::max(last_us, packet.number<std::int64_t>(4));
      const auto body_at = packet.number<std::int64_t>(0);
      if (body_at >= static_cast<std::int64_t>(kPacketHeadBytes))
        packets_at_.push_back(static_cast<std::uint64_t>(body_at) - kPacketHeadBytes);
    }
    std::ranges::sort(packets_at_);
    end_ = table_at;
    if (last_us > 0 && last_us <= kMaxStampNs / 1000) info_.end = timestamp_from_ns(last_us * 1000);
  } catch (const Damage& damage) {
    repairs_.add("file: no table", fmt::format("{}: the table at its end {}; read without it", name_, damage.what()));
  }

  struct PacketHead {
    std::size_t stream = 0;  ///< its place in the header
    std::size_t bytes = 0;
  };

  /// Nothing for a header that no packet has.
  std::optional<PacketHead> packet_head(ByteSpan head, std::uint64_t at) const {
    if (head.size() < kPacketHeadBytes) return std::nullopt;
    const auto stream = number_at<std::int32_t>(head, 0), bytes = number_at<std::int32_t>(head, 4);
    const auto known = std::ranges::find(header_.streams, stream, &Aedat4Stream::number);
    if (known == header_.streams.end() || bytes <= 0 ||
        static_cast<std::uint64_t>(bytes) > end_ - at - kPacketHeadBytes)
      return std::nullopt;
    return PacketHead{static_cast<std::size_t>(known - header_.streams.begin()), static_cast<std::size_t>(bytes)};
  }

  /// False at the end of the file, or where no further packet is found.
  bool read_on() override {
    if (at_ >= end_) return false;
    const auto head = packet_head(file_.read(at_, kPacketHeadBytes), at_);
    if (!head) return go_on_behind_damage();
    const std::uint64_t body_at = at_ + kPacketHeadBytes;
    last_at_ = at_;
    at_ = body_at + head->bytes;
    if (reads(head->stream))
      take_packet(head->stream, header_.compression, file_.read(body_at, head->bytes),
                  fmt::format("at byte {}", body_at));
    return true;
  }

  /// Goes to the next packet after the last readable one, whose length may be damaged.
  bool go_on_behind_damage() {
    auto listed = std::ranges::upper_bound(packets_at_, last_at_);
    if (listed != packets_at_.end() && *listed == at_) ++listed;
    std::optional<std::uint64_t> next;
    if (packets_at_.empty()) {
      next = search_packet(std::max(last_at_ + 1, searched_to_));
    } else if (listed != packets_at_.end()) {
      next = *listed;
    }
    repairs_.add("file: cut", fmt::format("{}: no whole packet at byte {}; {}", name_, at_,
                                          next ? fmt::format("continues at byte {}", *next) : "the rest is not read"));
    if (!next) return false;
    at_ = last_at_ = *next;
    searched_to_ = *next + 1;
    return true;
  }

  /// Searches for the beginning of a packet of a known stream: its body begins with the magic bytes of the compression
  /// or with a FlatBuffers header.
  std::optional<std::uint64_t> search_packet(std::uint64_t from) {
    constexpr std::size_t kStep = 1 << 20, kLookAhead = 20;
    for (; from < end_; from += kStep) {
      const Bytes block = file_.read(from, kStep + kLookAhead);
      for (std::size_t i = 0; i < kStep && i + kLookAhead <= block.size(); ++i) {
        const ByteSpan rest = ByteSpan(block).subspan(i);
        if (begins_body(rest.subspan(kPacketHeadBytes)) && packet_head(rest, from + i)) return from + i;
      }
    }
    return std::nullopt;
  }

  bool begins_body(ByteSpan body) const {
    const std::string_view text = as_text(body);
    if (header_.compression == "lz4") return text.starts_with("\x04\x22\x4d\x18");
    if (header_.compression == "zstd") return text.starts_with("\x28\xb5\x2f\xfd");
    const std::string_view type = text.substr(8, 4);
    return type == "EVTS" || type == "FRME" || type == "IMUS" || type == "TRIG";
  }

  BinaryFile file_;
  Aedat4Header header_;
  std::uint64_t at_, last_at_, end_;       ///< of the next and the previous packet; end of the packets
  std::uint64_t searched_to_ = 0;          ///< the search for a packet begins here
  std::vector<std::uint64_t> packets_at_;  ///< from the table, sorted
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
