// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Pictures of a still target of two shades from events alone: the brightness of each pixel at one instant.
#pragma once

#include <deque>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "edged/measurement.hpp"

namespace edged {

/// Each event is a step of the logarithm of the brightness. Added up from the past, the steps are the brightness at an
/// instant, and added up backwards from the future they are it as well. A sum stops at black and at white, so that it
/// does not drift. The mean of both has no delay: an edge is where it is at that instant, whichever way it moves.
class TargetPictures {
 public:
  /// Receives the instant and a picture (CV_8UC1).
  using Receiver = std::function<void(Timestamp t, const cv::Mat& picture)>;

  TargetPictures(int width, int height, Receiver receiver);

  /// In the order of time; an instant is to be added before events half a second later.
  void add_instant(Timestamp t) { instants_.push_back(t); }
  void add(std::span<const Event> events);
  /// The pictures that wait for later events.
  void finish();

 private:
  void pass(Timestamp now);
  void find_range();
  void take_until(Timestamp t);
  void make(Timestamp t);
  std::size_t index(const Event& event) const {
    return static_cast<std::size_t>(event.y) * static_cast<std::size_t>(width_) + event.x;
  }
  float stepped(float sum, bool up) const;

  int width_, height_;
  Receiver receiver_;
  std::deque<Timestamp> instants_;
  std::deque<Event> waiting_;  // not yet in the past of the next instant
  float range_ = 0.0F;         // steps from grey to black or white; 0: not yet known
  /// A pixel on one side of the instant: its brightness by the steps there, and the step next to the instant.
  struct Side {
    float sum = 0.0F;
    bool up = false, known = false;
    Timestamp t = Timestamp();
  };
  float brightness(const Side& past, const Side& future, Timestamp t) const;

  std::vector<Side> past_, future_;
};

}  // namespace edged
