// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The order of measurements of several streams: by stamp, ties broken external samples, IMU, events, frame.
#pragma once

#include <algorithm>

#include "edged/time.hpp"

namespace edged {

/// The next stream, and the end of its batch if it is the stream of events.
struct NextStream {
  enum class Stream { None, External, Imu, Events, Frame } stream = Stream::None;
  Timestamp events_end = Timestamp::max();  ///< the batch holds events before this stamp
};

/// By the next stamp of each stream (Timestamp::max() for one that has ended).
constexpr NextStream next_stream(Timestamp imu, Timestamp events, Timestamp frame,
                                 Timestamp external = Timestamp::max()) {
  using enum NextStream::Stream;
  constexpr Timestamp never = Timestamp::max();
  if (imu == never && events == never && frame == never && external == never) return {};
  if (external <= std::min({imu, events, frame})) return {External};
  if (imu <= events && imu <= frame) return {Imu};
  if (events > frame) return {Frame};
  // Events at the stamp of a frame come before it, those at the stamp of a sample after it.
  return {Events, std::min({imu, external, frame == never ? never : frame + Duration(1)})};
}

}  // namespace edged
