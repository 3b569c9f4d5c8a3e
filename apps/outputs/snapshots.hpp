// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Thumbnails, map points, and reasons of status changes over a run, for its report (album.json).
#pragma once

#include <array>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/step_numbers.hpp"
#include "edged/live/seen_points.hpp"
#include "edged/state.hpp"
#include "edged/step.hpp"

namespace edged {

/// Keeps a bounded number of images and points, spread evenly over the run.
class Snapshots {
 public:
  static constexpr std::size_t kMostPictures = 60;
  static constexpr std::size_t kMostPoints = 4000;

  void add(const Step& step);

  /// x, y, z [m] in the world of the estimate, by landmark.
  const std::map<FeatureId, std::array<float, 3>>& points() const { return points_.all(); }

  /// album.json. truth_frame: whose pose the ground truth is; "" where there is none.
  nlohmann::ordered_json to_json(const std::string& truth_frame, std::optional<Timestamp> in_map_since) const;

  /// The ground truth while the run lasted.
  Trajectory part_of_run(const Trajectory& truth) const;

 private:
  /// JPEG, empty if the step has none.
  struct Picture {
    Timestamp t;
    std::vector<unsigned char> events, frame;                       ///< of the first camera of each kind
    std::map<std::string, std::vector<unsigned char>> others = {};  ///< by camera
  };

  void take_picture(const Step& step);
  /// Whether a picture is to be taken of a step with images of these cameras.
  bool is_due(Timestamp t, bool events, bool frame);

  std::vector<Picture> pictures_;
  std::optional<Timestamp> due_;  ///< of the next picture
  Duration spacing_ = std::chrono::milliseconds(200);
  bool events_come_ = false, frames_come_ = false;
  StatusChanges changes_;
  Timestamp last_{};
  SeenPoints points_{kMostPoints};
};

}  // namespace edged
