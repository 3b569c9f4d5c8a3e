// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The fields of each message and their types, from Foxglove's documentation.
#include <map>

#include "edged/core/check.hpp"
#include "outputs/foxglove.hpp"

namespace edged::foxglove {
namespace {

using Fields = std::vector<std::pair<std::string, Json>>;

Json of_type(const char* type) { return {{"type", type}}; }
Json text() { return of_type("string"); }
Json flag() { return of_type("boolean"); }
Json number() { return of_type("number"); }
Json count() { return {{"type", "integer"}, {"minimum", 0}}; }
Json bytes() { return {{"type", "string"}, {"contentEncoding", "base64"}}; }
Json list(const Json& items) { return {{"type", "array"}, {"items", items}}; }

Json list(const Json& items, int length) {
  Json json = list(items);
  json["minItems"] = json["maxItems"] = length;
  return json;
}

/// All fields are required, except the others.
Json object(const std::string& title, const Fields& fields, const Fields& others = {}) {
  Json json = {{"title", title}, {"type", "object"}, {"properties", Json::object()}, {"required", Json::array()}};
  for (const auto& [name, field] : fields) {
    json["properties"][name] = field;
    json["required"].push_back(name);
  }
  for (const auto& [name, field] : others) json["properties"][name] = field;
  return json;
}

Json choice(const char* title, const std::vector<const char*>& names) {
  Json json = {{"title", title}, {"oneOf", Json::array()}};
  for (std::size_t i = 0; i < names.size(); ++i) json["oneOf"].push_back({{"title", names[i]}, {"const", i}});
  return json;
}

Json span_of_time(const char* title) {
  const Json nsec = {{"type", "integer"}, {"minimum", 0}, {"maximum", 999'999'999}};
  return {{"type", "object"}, {"title", title}, {"properties", {{"sec", of_type("integer")}, {"nsec", nsec}}}};
}
Json time_type() { return span_of_time("time"); }

Json numbers(const std::string& title, const std::vector<std::string>& names) {
  Fields fields;
  for (const std::string& name : names) fields.emplace_back(name, number());
  return object("foxglove." + title, fields);
}
Json vector_type() { return numbers("Vector3", {"x", "y", "z"}); }
Json colour_type() { return numbers("Color", {"r", "g", "b", "a"}); }

Json pose_type() {
  return object("foxglove.Pose",
                {{"position", vector_type()}, {"orientation", numbers("Quaternion", {"x", "y", "z", "w"})}});
}

Json frame_transforms_type() {
  return object("foxglove.FrameTransforms",
                {{"transforms", list(object("foxglove.FrameTransform",
                                            {{"timestamp", time_type()},
                                             {"parent_frame_id", text()},
                                             {"child_frame_id", text()},
                                             {"translation", vector_type()},
                                             {"rotation", numbers("Quaternion", {"x", "y", "z", "w"})}}))}});
}

/// Messages that begin with a time and a frame.
Json in_frame(const std::string& title, const Fields& fields) {
  Fields all = {{"timestamp", time_type()}, {"frame_id", text()}};
  all.insert(all.end(), fields.begin(), fields.end());
  return object(title, all);
}

Json point_cloud_type() {
  const Json type = choice("foxglove.NumericType",
                           {"UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64"});
  return in_frame(
      "foxglove.PointCloud",
      {{"pose", pose_type()},
       {"point_stride", count()},
       {"fields", list(object("foxglove.PackedElementField", {{"name", text()}, {"offset", count()}, {"type", type}}))},
       {"data", bytes()}});
}

/// Unused kinds of entities are lists of anything.
Json scene_update_type() {
  const Json anything = list(of_type("object"));
  const Json line =
      object("foxglove.LinePrimitive", {{"type", choice("foxglove.LineType", {"LINE_STRIP", "LINE_LOOP", "LINE_LIST"})},
                                        {"pose", pose_type()},
                                        {"thickness", number()},
                                        {"scale_invariant", flag()},
                                        {"points", list(numbers("Point3", {"x", "y", "z"}))},
                                        {"color", colour_type()},
                                        {"colors", list(colour_type())},
                                        {"indices", list(count())}});
  Fields fields = {{"id", text()},
                   {"lifetime", span_of_time("duration")},
                   {"frame_locked", flag()},
                   {"metadata", list(object("foxglove.KeyValuePair", {{"key", text()}, {"value", text()}}))}};
  for (const char* kind : {"arrows", "cubes", "spheres", "cylinders"}) fields.emplace_back(kind, anything);
  fields.emplace_back("lines", list(line));
  for (const char* kind : {"triangles", "texts", "models"}) fields.emplace_back(kind, anything);
  return object("foxglove.SceneUpdate",
                {{"deletions", anything}, {"entities", list(in_frame("foxglove.SceneEntity", fields))}});
}

Json camera_calibration_type() {
  return in_frame("foxglove.CameraCalibration", {{"width", count()},
                                                 {"height", count()},
                                                 {"distortion_model", text()},
                                                 {"D", list(number())},
                                                 {"K", list(number(), 9)},
                                                 {"R", list(number(), 9)},
                                                 {"P", list(number(), 12)}});
}

Json log_type() {
  const Json level = choice("foxglove.LogLevel", {"UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"});
  return object("foxglove.Log", {{"timestamp", time_type()},
                                 {"level", level},
                                 {"message", text()},
                                 {"name", text()},
                                 {"file", text()},
                                 {"line", count()}});
}

Json stats_type() {
  return object("edged.Stats",
                {{"timestamp", time_type()},
                 {"status", text()},
                 {"status_code", count()},
                 {"reason", text()},
                 {"keyframe", flag()},
                 {"relocalized", flag()},
                 {"event_tracks", count()},
                 {"frame_tracks", count()},
                 {"landmarks", count()},
                 {"event_rate_hz", number()},
                 {"scene_depth_m", number()}},
                {{"velocity_mps", vector_type()},
                 {"bias_gyro_radps", vector_type()},
                 {"bias_accel_mps2", vector_type()},
                 {"position_sigma_m", vector_type()},
                 {"rotation_sigma_deg", vector_type()},
                 {"depth_scale", number()},
                 {"depth_scale_sigma_ln", number()}});
}

Json type_of(std::string_view name) {
  if (name == "foxglove.FrameTransforms") return frame_transforms_type();
  if (name == "foxglove.PoseInFrame") return in_frame("foxglove.PoseInFrame", {{"pose", pose_type()}});
  if (name == "foxglove.PosesInFrame") return in_frame("foxglove.PosesInFrame", {{"poses", list(pose_type())}});
  if (name == "foxglove.PointCloud") return point_cloud_type();
  if (name == "foxglove.SceneUpdate") return scene_update_type();
  if (name == "foxglove.CompressedImage")
    return in_frame("foxglove.CompressedImage", {{"data", bytes()}, {"format", text()}});
  if (name == "foxglove.CameraCalibration") return camera_calibration_type();
  if (name == "foxglove.Log") return log_type();
  if (name == "edged.Stats") return stats_type();
  EDGED_CHECK(false, "no schema of {}", name);
}

}  // namespace

std::string schema_of(std::string_view type) { return type_of(type).dump(); }

}  // namespace edged::foxglove
