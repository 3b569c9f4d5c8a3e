// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads and writes the fields of messages in the wire formats of ROS 1 and ROS 2; definitions of message types.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>

#include "edged/io/archive/bytes.hpp"
#include "edged/time.hpp"

namespace edged {

/// The serialization of a message. ROS 1 packs the fields; CDR begins with four bytes that name its kind and aligns
/// each number to its own size, counted from behind them.
enum class Wire { Ros1, Cdr };

/// Reads fields in the order of the definition of the message. All functions throw Damage for invalid bytes.
class WireReader {
 public:
  WireReader(Wire wire, ByteSpan message);

  template <typename T>
  T number() {
    if (wire_ == Wire::Cdr) reader_.take((sizeof(T) - reader_.at() % sizeof(T)) % sizeof(T));
    return reader_.number<T>();
  }
  /// Several numbers, one after the other.
  template <typename... T>
  void numbers(T&... values) {
    ((values = number<T>()), ...);
  }
  template <int N>
  Eigen::Matrix<double, N, 1> vector() {
    Eigen::Matrix<double, N, 1> v;
    for (double& x : v) x = number<double>();
    return v;
  }
  std::string_view text();
  ByteSpan bytes();
  Timestamp time();
  /// The stamp of a std_msgs/Header, and the name of its frame where that is wanted.
  Timestamp header(std::string_view* frame_id = nullptr);
  /// Length of a list whose items have at least that many bytes.
  std::uint32_t list(std::size_t item_bytes);

 private:
  Wire wire_;
  ByteReader reader_;
};

/// Writes what WireReader reads.
class WireWriter {
 public:
  explicit WireWriter(Wire wire);

  template <typename T>
  void number(T value) {
    if (wire_ == Wire::Cdr) out_.append((sizeof(T) - (out_.size() - kKindBytes) % sizeof(T)) % sizeof(T), '\0');
    append_number(out_, value);
  }
  void numbers(std::span<const double> values);
  template <typename... T>
  requires(sizeof...(T) > 1) void numbers(T... values) { (number(values), ...); }
  void text(std::string_view value);
  void bytes(ByteSpan value);
  /// t: from zero to latest_stamp().
  void time(Timestamp t);
  void header(Timestamp stamp, std::string_view frame_id);

  const std::string& message() const { return out_; }

 private:
  static constexpr std::size_t kKindBytes = 4;
  Wire wire_;
  std::string out_;
};

/// A message type, for writing bags and for messages to and from ROS.
struct MessageDefinition {
  std::string text;  ///< its fields, then those of each contained message, in the form of ROS 1 or 2
  std::string md5;   ///< checksum by which ROS 1 identifies the version of a message; empty for CDR
};

/// type: "dvs_msgs/EventArray" or another one of the table. Throws CheckError for other types.
MessageDefinition definition_of(std::string_view type, Wire wire);

/// The md5 by which ROS 1 identifies the type. Empty for a type that is not in the table.
std::string_view ros1_md5_of(std::string_view type);

/// The latest stamp that the format holds. The earliest is zero.
Timestamp latest_stamp(Wire wire);

}  // namespace edged
