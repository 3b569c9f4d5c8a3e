// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Further data for the report of a run: thumbnails, map points, and reasons of status changes (album.json).
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/step_facts.hpp"
#include "edged/dataset.hpp"
#include "edged/io/calibration.hpp"
#include "edged/live/seen_points.hpp"
#include "edged/odometry.hpp"

namespace edged {

/// Bytes as text of 64 letters (RFC 4648).
std::string base64(const std::vector<unsigned char>& bytes);

/// Observes the steps. It keeps a bounded number of images and points, spread evenly over the run.
class RunAlbum {
 public:
  static constexpr std::size_t kMostPictures = 60;
  static constexpr std::size_t kMostPoints = 4000;

  void add(const Step& step);

  /// x, y, z [m] in the world of the estimate, by landmark.
  const std::map<FeatureId, std::array<float, 3>>& points() const { return points_.all(); }

  const std::vector<StatusChange>& changes() const { return changes_.all(); }
  Timestamp last() const { return last_; }  ///< step

  /// truth_frame: whose pose the ground truth is; "" where there is none.
  nlohmann::ordered_json to_json(const std::string& truth_frame, std::optional<Timestamp> in_map_since) const;

  /// album.json, groundtruth.tum where there is a truth, and calibration_found.yaml: `given` with the cameras of
  /// `found`.
  void write(const std::filesystem::path& folder, const Calibration& given, const Rig& found,
             const std::optional<GroundTruth>& truth, std::optional<Timestamp> in_map_since = std::nullopt) const;

 private:
  /// JPEG, empty if the step has none.
  struct Picture {
    Timestamp t;
    std::vector<unsigned char> events, frame;                       ///< of the first camera of each kind
    std::map<std::string, std::vector<unsigned char>> others = {};  ///< by camera
  };

  void take_picture(const Step& step);

  std::vector<Picture> pictures_;
  std::optional<Timestamp> due_;  ///< of the next picture
  Duration spacing_ = std::chrono::milliseconds(200);
  bool events_come_ = false, frames_come_ = false;
  StatusChanges changes_;
  Timestamp last_{};
  SeenPoints points_{kMostPoints};
};

}  // namespace edged
