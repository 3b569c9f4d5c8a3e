// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Compares events with frames of the same lens: whether both have the same pixels.
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>

#include "edged/measurement.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Events lie on the edges of the frames. If they do so only when turned, mirrored or moved, their pixels are.
class EventAgreement {
 public:
  /// Compares the first camera of each kind, if they share a lens.
  explicit EventAgreement(std::span<const RigCamera> cameras);

  /// Uses a few frames, each with the events before it.
  void add(const Measurement& measurement);

  /// How the events would have to be changed to lie on the edges; nothing if they do, or if that is not certain.
  std::optional<std::string> better() const;

 private:
  void count(const EventBatch& batch);
  void compare(const Frame& frame);

  std::optional<RigCamera> events_;
  std::string frames_;  ///< the camera's name
  cv::Mat counts_;      ///< the newest events at each pixel
  std::size_t counted_ = 0;
  Timestamp due_ = Timestamp::min();  ///< of the next comparison
  int compared_ = 0;
  std::array<double, 4> correlations_{};  ///< sums: as given, and for each change
  cv::Mat shifted_;                       ///< sums: for each shift
};

}  // namespace edged
