// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Messages of Foxglove in json, with their json schemas.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "edged/rig.hpp"
#include "edged/step.hpp"

namespace edged::foxglove {

using Json = nlohmann::ordered_json;
using Point = std::array<float, 3>;

/// The json schema of a message by its name: "foxglove.PoseInFrame", or "edged.Stats", which is ours.
std::string schema_of(const std::string& type);

// A time before zero becomes zero; lengths in metres.

struct Transform {
  const char* parent;
  std::string child;
  SE3 T_parent_child;
};
Json frame_transforms(Timestamp t, const std::vector<Transform>& transforms);
Json pose_in_frame(Timestamp t, const char* frame, const SE3& T);
Json poses_in_frame(Timestamp t, const char* frame, std::span<const StampedPose> poses);
Json point_cloud(Timestamp t, const char* frame, std::span<const Point> points);

struct Lines {
  std::string id;  ///< replaces the entity with the same id
  std::vector<Point> points;
  std::vector<unsigned> pairs;  ///< pairs of joined points; empty: all in a row
  std::array<double, 4> colour;
};
Json scene_update(Timestamp t, const char* frame, const Lines& lines);

Json compressed_image(Timestamp t, const std::string& camera, const std::vector<unsigned char>& jpeg);
/// For images reduced by `scale`.
Json camera_calibration(Timestamp t, const RigCamera& camera, double scale);

enum class Level { Info = 2, Warning = 3, Error = 4 };
Json log(Timestamp t, Level level, const std::string& message);

/// The figures of a step.
Json stats(const Step& step);

}  // namespace edged::foxglove
