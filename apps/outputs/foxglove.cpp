// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "outputs/foxglove.hpp"

#include <algorithm>
#include <cmath>

#include "common/json_text.hpp"
#include "common/step_numbers.hpp"
#include "edged/camera/field_of_view.hpp"
#include "edged/camera/lens_table.hpp"
#include "edged/core/angles.hpp"

namespace edged::foxglove {
namespace {

constexpr int kFloat32 = 7;  // of the numeric types
constexpr int kLineStrip = 0, kLineList = 2;

Json time(Timestamp t) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t ns = std::max<std::int64_t>(to_ns(t), 0);
  return {{"sec", ns / kSecond}, {"nsec", ns % kSecond}};
}

Json vector(const Eigen::Vector3d& v, int decimals = 6) {
  return {{"x", rounded(v.x(), decimals)}, {"y", rounded(v.y(), decimals)}, {"z", rounded(v.z(), decimals)}};
}

Json quaternion(const Eigen::Quaterniond& q) {
  return {{"x", rounded(q.x(), 7)}, {"y", rounded(q.y(), 7)}, {"z", rounded(q.z(), 7)}, {"w", rounded(q.w(), 7)}};
}

Json pose(const SE3& T) { return {{"position", vector(T.translation())}, {"orientation", quaternion(T.rotation())}}; }

}  // namespace

Json frame_transforms(Timestamp t, const std::vector<Transform>& transforms) {
  Json list = Json::array();
  for (const Transform& transform : transforms)
    list.push_back({{"timestamp", time(t)},
                    {"parent_frame_id", transform.parent},
                    {"child_frame_id", transform.child},
                    {"translation", vector(transform.T_parent_child.translation())},
                    {"rotation", quaternion(transform.T_parent_child.rotation())}});
  return {{"transforms", list}};
}

Json pose_in_frame(Timestamp t, const char* frame, const SE3& T) {
  return {{"timestamp", time(t)}, {"frame_id", frame}, {"pose", pose(T)}};
}

Json poses_in_frame(Timestamp t, const char* frame, std::span<const StampedPose> poses) {
  Json list = Json::array();
  for (const StampedPose& stamped : poses) list.push_back(pose(stamped.T));
  return {{"timestamp", time(t)}, {"frame_id", frame}, {"poses", list}};
}

Json point_cloud(Timestamp t, const char* frame, std::span<const Point> points) {
  Json fields = Json::array();
  for (const char* axis : {"x", "y", "z"})
    fields.push_back({{"name", axis}, {"offset", sizeof(float) * fields.size()}, {"type", kFloat32}});
  const auto* begin = reinterpret_cast<const unsigned char*>(points.data());
  return {{"timestamp", time(t)},          {"frame_id", frame}, {"pose", pose(SE3())},
          {"point_stride", sizeof(Point)}, {"fields", fields},  {"data", base64({begin, begin + points.size_bytes()})}};
}

Json scene_update(Timestamp t, const char* frame, const Lines& lines) {
  Json points = Json::array();
  for (const auto& [x, y, z] : lines.points) points.push_back(vector(Eigen::Vector3f(x, y, z).cast<double>(), 4));
  const auto& [r, g, b, a] = lines.colour;
  const Json line = {{"type", lines.pairs.empty() ? kLineStrip : kLineList},
                     {"pose", pose(SE3())},
                     {"thickness", 1.5},
                     {"scale_invariant", true},  // the thickness is in pixels
                     {"points", points},
                     {"color", {{"r", r}, {"g", g}, {"b", b}, {"a", a}}},
                     {"colors", Json::array()},
                     {"indices", lines.pairs}};
  Json entity = {{"timestamp", time(t)}, {"frame_id", frame}, {"id", lines.id}, {"lifetime", time({})}};
  entity["frame_locked"] = true;
  for (const char* none : {"metadata", "arrows", "cubes", "spheres", "cylinders", "triangles", "texts", "models"})
    entity[none] = Json::array();
  entity["lines"] = Json::array({line});
  return {{"deletions", Json::array()}, {"entities", Json::array({entity})}};
}

Json compressed_image(Timestamp t, const std::string& camera, const std::vector<unsigned char>& jpeg) {
  return {{"timestamp", time(t)}, {"frame_id", camera}, {"data", base64(jpeg)}, {"format", "jpeg"}};
}

Json camera_calibration(Timestamp t, const RigCamera& camera, double scale) {
  const CameraModel& m = camera.model;
  const LensModel& lens = lens_model(m.distortion());
  // Of a model without a name there: a pinhole with the focal length near the axis.
  const auto k = std::span(m.coefficients()).first(lens.foxglove.empty() ? 0 : lens.max_coefficients);
  const std::vector<double> D(k.begin(), k.end());
  const double on_axis = axis_slope(m), fx = scale * m.fx() * on_axis, fy = scale * m.fy() * on_axis;
  // The centre of the first pixel is at zero, whatever its size.
  const double cx = scale * (m.cx() + 0.5) - 0.5, cy = scale * (m.cy() + 0.5) - 0.5;
  return {{"timestamp", time(t)},
          {"frame_id", camera.name},
          {"width", std::lround(scale * m.width())},
          {"height", std::lround(scale * m.height())},
          {"distortion_model", lens.foxglove},
          {"D", D},
          {"K", {fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0}},
          {"R", {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}},
          {"P", {fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0}}};
}

Json log(Timestamp t, Level level, const std::string& message) {
  return {{"timestamp", time(t)}, {"level", static_cast<int>(level)},
          {"message", message},   {"name", "edged"},
          {"file", ""},           {"line", 0}};
}

Json stats(const Step& step) {
  const ModalityNumbers events = modality_numbers(step, Modality::Events),
                        frames = modality_numbers(step, Modality::Frames);
  Json json = {{"timestamp", time(step.t)},
               {"status", to_string(step.status)},
               {"status_code", static_cast<int>(step.status)},
               {"reason", reason_of(step)},
               {"keyframe", step.keyframe},
               {"relocalized", step.relocalized},
               {"event_tracks", events.tracks},
               {"frame_tracks", frames.tracks},
               {"landmarks", step.landmarks.size()},
               {"event_rate_hz", rounded(events.event_rate_hz, 0)},
               {"scene_depth_m", rounded(step.scene_depth, 4)}};
  if (step.status != TrackingStatus::Initializing) {
    json["velocity_mps"] = vector(step.state.v_W);
    json["bias_gyro_radps"] = vector(step.state.bias_gyro, 7);
    json["bias_accel_mps2"] = vector(step.state.bias_accel);
  }
  if (step.covariance) {
    json["position_sigma_m"] = vector(step.covariance->position.diagonal().cwiseSqrt());
    json["rotation_sigma_deg"] = vector(kDegreesPerRadian * step.covariance->rotation.diagonal().cwiseSqrt());
  }
  if (step.ln_depth_scale) {
    json["depth_scale"] = rounded(std::exp(step.ln_depth_scale->value), 5);
    json["depth_scale_sigma_ln"] = rounded(step.ln_depth_scale->sigma, 5);
  }
  return json;
}

}  // namespace edged::foxglove
