// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The frames that have not cut a packet yet, and when the next ones are due.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "edged/measurement.hpp"
#include "edged/pipeline/input/packet.hpp"
#include "edged/rig.hpp"

namespace edged {

/// All stamps are on the IMU clock.
class FrameQueue {
 public:
  /// cameras: those of the run.
  explicit FrameQueue(const Rig& cameras);

  std::size_t cameras() const { return cameras_.size(); }
  /// The time offset of a camera; nothing if it is no frame camera of the run.
  std::optional<Duration> offset(const std::string& camera) const;
  /// False, without effect, if the frame is not after the last cut and the camera's frame before. Of such a camera
  /// only.
  bool add(Frame frame, Timestamp last_cut);

  bool empty() const { return frames_.empty(); }
  Timestamp first() const { return frames_.front().t; }
  Timestamp last() const { return frames_.back().t; }
  /// Time that a frame waits for those of other cameras.
  Duration wait() const { return wait_; }

  /// When events may cut a packet that they complete at t: cuts are that spacing apart, and yield to a frame that is
  /// present or, by the period of its camera, due.
  Timestamp yield(Timestamp t, Duration spacing) const;
  /// Moves the frame that cuts the packet into it, and those of other cameras that belong to it.
  void take(Packet& packet);

 private:
  struct Camera {
    std::string name;
    Duration offset{0};
    std::optional<Timestamp> newest = {}, cut = {};  ///< stamps of the last frame received, and of the last in a packet
    std::optional<Timestamp> expected = {};
    Duration period{0};
  };

  std::vector<Camera> cameras_;  // in the order of the rig
  Duration wait_{0};
  std::deque<Frame> frames_;  // in the order of their stamps
};

}  // namespace edged
