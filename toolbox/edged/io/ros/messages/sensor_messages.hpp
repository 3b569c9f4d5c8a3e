// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Events and frames of messages, by the type of the message.
#pragma once

#include "edged/io/ros/messages/event_packets.hpp"
#include "edged/io/ros/messages/messages.hpp"

namespace edged {

/// Decodes all types of event messages. The messages must be those of one stream, in order.
class EventMessageDecoder {
 public:
  /// type: one with the role Events. Throws Damage.
  EventArray decode(std::string_view type, WireReader message);
  /// Events of packets that could not be decoded, most of them after missing packets.
  std::size_t left_out() const { return packets_.left_out(); }

 private:
  EventPacketDecoder packets_;
};

/// Decodes all types of images. type: one with the role Frames. Throws Damage.
GrayImage read_frame(std::string_view type, WireReader message);

}  // namespace edged
