// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A DDS type of which Cyclone DDS knows no more than the name: its messages stay bytes of CDR.
#pragma once

#include <dds/dds.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "edged/io/archive/bytes.hpp"

struct ddsi_serdata;
struct ddsi_sertype;

namespace edged::ros2 {

/// Cyclone is not to decode what the readers of ROS 2 bags decode anyway, and there is nothing to generate. Keyless, as
/// all types of ROS 2. Belongs to the caller until a topic takes it.
ddsi_sertype* make_raw_type(const std::string& name);

/// cdr: with its header of four bytes. For dds_writecdr, which takes it.
ddsi_serdata* make_raw_message(const ddsi_sertype* type, std::string_view cdr);

/// Who sent a message, and as which of his: numbers rise by one.
struct Origin {
  std::array<std::uint8_t, 16> writer{};  ///< its guid
  std::uint64_t number = 0;               ///< from 1; 0 of a message that came over no network
};

/// What a reader of a raw type took; the bytes live as long as it.
class RawMessage {
 public:
  explicit RawMessage(ddsi_serdata* message) : message_(message) {}
  ~RawMessage();
  RawMessage(const RawMessage&) = delete;
  RawMessage& operator=(const RawMessage&) = delete;

  ByteSpan cdr() const;
  Origin origin() const;

 private:
  ddsi_serdata* message_;
};

}  // namespace edged::ros2
