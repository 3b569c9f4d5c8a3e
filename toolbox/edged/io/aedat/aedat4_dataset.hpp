// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The content of AEDAT4 packets, from a file or a server. Internal to io.
#pragma once

#include "edged/io/aedat/aedat4_header.hpp"
#include "edged/io/streamed_dataset.hpp"

namespace edged {

/// The buffer after its length. Throws Damage if it is not of this type.
ByteSpan flat_buffer(const Bytes& bytes, std::string_view type);

class Aedat4Dataset : public StreamedDataset {
 protected:
  using StreamedDataset::StreamedDataset;

  /// One packet of the stream with this role. place: its position, for messages. Damage is counted.
  void take_packet(Role role, std::string_view compression, ByteSpan packed, const std::string& place);

 private:
  void take_events(ByteSpan buffer);
  void take_frame(ByteSpan buffer);
  void take_imu(ByteSpan buffer);
};

}  // namespace edged
