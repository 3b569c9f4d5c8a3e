// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The content of AEDAT4 packets, from a file or a server. Internal to io.
#pragma once

#include "edged/io/aedat/aedat4_header.hpp"
#include "edged/io/core/streamed_dataset.hpp"

namespace edged {

/// The streams of a file or server: which are read, and their packets as measurements.
class Aedat4Dataset : public StreamedDataset {
 protected:
  using StreamedDataset::StreamedDataset;

  /// Chooses the streams: the only one of its type, those that the user names, or several cameras. The sizes of event
  /// sensors are those of the rig, else options.geometry, else those of the streams. Throws InputError.
  void choose(const std::vector<Aedat4Stream>& streams, const Rig* rig, const RecordingOptions& options);
  /// The frame of poses that the header names.
  void set_pose_frame(const std::string& name);
  void begin_chosen() { begin(cameras_, choice_.of(Role::Imu).has_value()); }

  /// Whether the packets of that stream, by its place in choose(), are needed.
  bool reads(std::size_t stream) const;
  /// One packet of a stream that is read. place: its position, for messages. Damage is counted.
  void take_packet(std::size_t stream, std::string_view compression, ByteSpan packed, const std::string& place);

 private:
  void take_events(std::size_t camera, ByteSpan buffer);
  void take_frame(std::size_t camera, ByteSpan buffer);
  void take_imu(ByteSpan buffer);

  TopicChoice choice_;
  std::vector<RecordedCamera> cameras_;
};

}  // namespace edged
