// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/ros/messages/wire.hpp"

#include <limits>

#include "edged/core/check.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;

}  // namespace

WireReader::WireReader(Wire wire, ByteSpan message) : wire_(wire), reader_(message) {
  if (wire == Wire::Ros1) return;
  ByteReader kind(message);
  kind.take(1);
  if (kind.number<std::uint8_t>() != 1) throw Damage("not plain little-endian CDR");
  kind.take(2);
  reader_ = ByteReader(message.subspan(4));
}

std::string_view WireReader::text() {
  const std::string_view value = reader_.text(number<std::uint32_t>());
  return wire_ == Wire::Cdr && value.ends_with('\0') ? value.substr(0, value.size() - 1) : value;
}

ByteSpan WireReader::bytes() { return reader_.take(number<std::uint32_t>()); }

Timestamp WireReader::time() {
  const std::int64_t s = wire_ == Wire::Cdr ? number<std::int32_t>() : std::int64_t{number<std::uint32_t>()};
  const std::int64_t ns = s * kSecondNs + number<std::uint32_t>();
  if (ns < 0 || ns > kMaxStampNs) throw Damage("stamp out of range");
  return timestamp_from_ns(ns);
}

Timestamp WireReader::header(std::string_view* frame_id) {
  if (wire_ == Wire::Ros1) number<std::uint32_t>();  // seq
  const Timestamp stamp = time();
  const std::string_view frame = text();
  if (frame_id != nullptr) *frame_id = frame;
  return stamp;
}

std::uint32_t WireReader::list(std::size_t item_bytes) {
  const auto length = number<std::uint32_t>();
  if (length > reader_.left() / item_bytes) throw Damage("list longer than its message");
  return length;
}

WireWriter::WireWriter(Wire wire) : wire_(wire) {
  if (wire == Wire::Cdr) out_.assign({0, 1, 0, 0});  // plain, little-endian
}

void WireWriter::numbers(std::span<const double> values) {
  for (const double value : values) number(value);
}

void WireWriter::text(std::string_view value) {
  const std::size_t terminator = wire_ == Wire::Cdr ? 1 : 0;
  number(static_cast<std::uint32_t>(value.size() + terminator));
  out_ += value;
  out_.append(terminator, '\0');
}

void WireWriter::bytes(ByteSpan value) {
  number(static_cast<std::uint32_t>(value.size()));
  out_ += as_text(value);
}

Timestamp latest_stamp(Wire wire) {
  const std::int64_t s = wire == Wire::Cdr ? std::numeric_limits<std::int32_t>::max()
                                           : std::int64_t{std::numeric_limits<std::uint32_t>::max()};
  return timestamp_from_ns(s * kSecondNs + kSecondNs - 1);
}

void WireWriter::time(Timestamp t) {
  EDGED_CHECK(to_ns(t) >= 0 && t <= latest_stamp(wire_), "stamp {} ns", to_ns(t));
  number(static_cast<std::uint32_t>(to_ns(t) / kSecondNs));
  number(static_cast<std::uint32_t>(to_ns(t) % kSecondNs));
}

void WireWriter::header(Timestamp stamp, std::string_view frame_id) {
  if (wire_ == Wire::Ros1) number(std::uint32_t{0});  // seq
  time(stamp);
  text(frame_id);
}

}  // namespace edged
