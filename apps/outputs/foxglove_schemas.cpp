// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The fields of each message and their types, from Foxglove's documentation, as json schemas.
#include <map>

#include "common/text.hpp"
#include "edged/core/check.hpp"
#include "outputs/foxglove.hpp"

namespace edged::foxglove {
namespace {

/// Fields as "name type", a field that may be missing as "name? type", lists as "[type]" and those of a fixed length as
/// "[type]length"; values of an enumeration after "=".
const std::map<std::string_view, const char*> kTypes = {
    {"foxglove.Vector3", "x number, y number, z number"},
    {"foxglove.Point3", "x number, y number, z number"},
    {"foxglove.Quaternion", "x number, y number, z number, w number"},
    {"foxglove.Color", "r number, g number, b number, a number"},
    {"foxglove.Pose", "position foxglove.Vector3, orientation foxglove.Quaternion"},
    {"foxglove.FrameTransform",
     "timestamp time, parent_frame_id string, child_frame_id string, translation foxglove.Vector3, rotation "
     "foxglove.Quaternion"},
    {"foxglove.FrameTransforms", "transforms [foxglove.FrameTransform]"},
    {"foxglove.PoseInFrame", "timestamp time, frame_id string, pose foxglove.Pose"},
    {"foxglove.PosesInFrame", "timestamp time, frame_id string, poses [foxglove.Pose]"},
    {"foxglove.NumericType", "=UNKNOWN, UINT8, INT8, UINT16, INT16, UINT32, INT32, FLOAT32, FLOAT64"},
    {"foxglove.PackedElementField", "name string, offset count, type foxglove.NumericType"},
    {"foxglove.PointCloud",
     "timestamp time, frame_id string, pose foxglove.Pose, point_stride count, fields [foxglove.PackedElementField], "
     "data bytes"},
    {"foxglove.LineType", "=LINE_STRIP, LINE_LOOP, LINE_LIST"},
    {"foxglove.LinePrimitive",
     "type foxglove.LineType, pose foxglove.Pose, thickness number, scale_invariant boolean, points [foxglove.Point3], "
     "color foxglove.Color, colors [foxglove.Color], indices [count]"},
    {"foxglove.KeyValuePair", "key string, value string"},
    {"foxglove.SceneEntity",
     "timestamp time, frame_id string, id string, lifetime duration, frame_locked boolean, metadata "
     "[foxglove.KeyValuePair], arrows [object], cubes [object], spheres [object], cylinders [object], lines "
     "[foxglove.LinePrimitive], triangles [object], texts [object], models [object]"},
    {"foxglove.SceneUpdate", "deletions [object], entities [foxglove.SceneEntity]"},
    {"foxglove.CompressedImage", "timestamp time, frame_id string, data bytes, format string"},
    {"foxglove.CameraCalibration",
     "timestamp time, frame_id string, width count, height count, distortion_model string, D [number], K [number]9, R "
     "[number]9, P [number]12"},
    {"foxglove.LogLevel", "=UNKNOWN, DEBUG, INFO, WARNING, ERROR, FATAL"},
    {"foxglove.Log", "timestamp time, level foxglove.LogLevel, message string, name string, file string, line count"},
    {"edged.Stats",
     "timestamp time, status string, status_code count, reason string, keyframe boolean, relocalized boolean, "
     "event_tracks count, frame_tracks count, landmarks count, event_rate_hz number, scene_depth_m number, "
     "velocity_mps? foxglove.Vector3, bias_gyro_radps? foxglove.Vector3, bias_accel_mps2? foxglove.Vector3, "
     "position_sigma_m? foxglove.Vector3, rotation_sigma_deg? foxglove.Vector3, depth_scale? number, "
     "depth_scale_sigma_ln? number"},
};

Json type_of(const std::string& type);

Json span_of_time(const std::string& title) {
  const Json nsec = {{"type", "integer"}, {"minimum", 0}, {"maximum", 999'999'999}};
  return {{"type", "object"}, {"title", title}, {"properties", {{"sec", {{"type", "integer"}}}, {"nsec", nsec}}}};
}

Json list_of(const std::string& type) {
  const std::size_t end = type.find(']');
  Json json = {{"type", "array"}, {"items", type_of(type.substr(1, end - 1))}};
  if (end + 1 < type.size()) json["minItems"] = json["maxItems"] = std::stoi(type.substr(end + 1));
  return json;
}

Json enumeration(const std::string& title, const std::vector<std::string>& names) {
  Json json = {{"title", title}, {"oneOf", Json::array()}};
  for (std::size_t i = 0; i < names.size(); ++i) json["oneOf"].push_back({{"title", names[i]}, {"const", i}});
  return json;
}

Json object(const std::string& title, const std::vector<std::string>& fields) {
  Json json = {{"title", title}, {"type", "object"}, {"properties", Json::object()}, {"required", Json::array()}};
  for (const std::string& field : fields) {
    const std::size_t blank = field.find(' ');
    std::string name = field.substr(0, blank);
    const bool optional = name.back() == '?';
    if (optional) name.pop_back();
    json["properties"][name] = type_of(field.substr(blank + 1));
    if (!optional) json["required"].push_back(name);
  }
  return json;
}

Json type_of(const std::string& type) {
  if (type.front() == '[') return list_of(type);
  if (type == "time" || type == "duration") return span_of_time(type);
  if (type == "count") return {{"type", "integer"}, {"minimum", 0}};
  if (type == "bytes") return {{"type", "string"}, {"contentEncoding", "base64"}};
  const auto known = kTypes.find(type);
  if (known == kTypes.end()) return {{"type", type}};
  const std::string text = known->second;
  return text.front() == '=' ? enumeration(type, split(text.substr(1), ", ")) : object(type, split(text, ", "));
}

}  // namespace

std::string schema_of(const std::string& type) {
  EDGED_CHECK(kTypes.contains(type), "no schema of {}", type);
  return type_of(type).dump();
}

}  // namespace edged::foxglove
