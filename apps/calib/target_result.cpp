// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "calib/target_result.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/json_text.hpp"
#include "common/text.hpp"
#include "edged/camera/lens_table.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/statistics.hpp"
#include "report/report_page.hpp"

namespace edged {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kMostShown = 20000;  // residuals of a camera in the page

/// "fx", "fy", "cx", "cy" and the coefficients.
std::vector<std::string> parameter_names(const FreeLens& lens) {
  std::vector<std::string> out{"fx", "fy", "cx", "cy"};
  for (const std::string_view name : coefficient_names(lens_model(lens.distortion))) out.emplace_back(name);
  out.resize(static_cast<std::size_t>(lens.count()));
  return out;
}

double rms_px(const CalibratedCamera& camera) {
  double squares = 0.0;
  for (const CornerResidual& r : camera.residuals) squares += r.error_px.squaredNorm();
  return std::sqrt(squares / std::max<double>(1.0, static_cast<double>(camera.residuals.size())));
}

double median_px(const CalibratedCamera& camera) {
  std::vector<double> lengths;
  for (const CornerResidual& r : camera.residuals) lengths.push_back(r.error_px.norm());
  return median(std::move(lengths));
}

bool has_pose(const TargetCalibration& result, std::size_t camera) { return result.fit.has_imu || camera > 0; }

std::string camera_text(const TargetCalibration& result, std::size_t i) {
  const CalibratedCamera& camera = result.fit.cameras[i];
  const TargetViews& views = result.cameras[i].views;
  std::string out =
      fmt::format("camera {}: {} x {} px, {}, target in {} of {}, corners in {:.0f} % of the image\n", views.name,
                  views.width, views.height, to_string(camera.lens.distortion), views.views.size(),
                  quantity(views.pictures, "picture"), 100.0 * result.coverage[i].cells.share());
  const auto names = parameter_names(camera.lens);
  for (std::size_t k = 0; k < names.size(); ++k)
    out += fmt::format("  {:<12} {:>12.{}f} +- {:.{}f}{}\n", names[k], camera.lens.values[k], k < 4 ? 3 : 6,
                       camera.lens_sigmas[k], k < 4 ? 3 : 6, k < 4 ? " px" : "");
  out += fmt::format("  {:<12} {:>12.3f} px median, {:.3f} px rms, {}\n", "reprojection", median_px(camera),
                     rms_px(camera), quantity(camera.residuals.size(), "corner"));
  if (!has_pose(result, i)) return out;
  const Eigen::Vector3d turn = so3::log(camera.T_B_C.rotation()) / kDegree, p = 1e3 * camera.T_B_C.translation();
  out += fmt::format("  {:<12} [{:.3f}, {:.3f}, {:.3f}] +- {:.3f} deg (rotation vector)\n",
                     result.fit.has_imu ? "T_imu_cam" : "T_first_cam", turn.x(), turn.y(), turn.z(),
                     camera.pose_sigmas.tail<3>().norm() / kDegree);
  out += fmt::format("  {:<12} [{:.2f}, {:.2f}, {:.2f}] +- {:.2f} mm\n", "", p.x(), p.y(), p.z(),
                     1e3 * camera.pose_sigmas.head<3>().norm());
  if (result.fit.has_imu)
    out += fmt::format("  {:<12} {:>12.3f} +- {:.3f} ms (t_imu = t_cam + time_offset)\n", "time_offset",
                       1e3 * camera.time_offset_s, 1e3 * camera.time_offset_sigma_s);
  return out;
}

ordered_json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

ordered_json camera_json(const TargetCalibration& result, std::size_t i) {
  const CalibratedCamera& camera = result.fit.cameras[i];
  const TargetViews& views = result.cameras[i].views;
  ordered_json out = {{"name", views.name},
                      {"modality", views.modality == Modality::Events ? "events" : "frames"},
                      {"resolution_px", {views.width, views.height}},
                      {"lens", to_string(camera.lens.distortion)},
                      {"pictures", views.pictures},
                      {"views", views.views.size()},
                      {"corners", camera.residuals.size()},
                      {"coverage", result.coverage[i].cells.share()},
                      {"tilt_deg", {result.coverage[i].tilt_x / kDegree, result.coverage[i].tilt_y / kDegree}},
                      {"distance_m", {result.coverage[i].nearest_m, result.coverage[i].farthest_m}},
                      {"reprojection_px", {{"median", median_px(camera)}, {"rms", rms_px(camera)}}}};
  const auto names = parameter_names(camera.lens);
  for (std::size_t k = 0; k < names.size(); ++k)
    out["parameters"].push_back(
        {{"name", names[k]}, {"value", camera.lens.values[k]}, {"sigma", camera.lens_sigmas[k]}});
  if (!has_pose(result, i)) return out;
  const Eigen::Quaterniond& q = camera.T_B_C.rotation();
  out["q_B_C"] = {q.w(), q.x(), q.y(), q.z()};
  out["p_B_C_m"] = vector_json(camera.T_B_C.translation());
  out["rotation_sigma_deg"] = vector_json(camera.pose_sigmas.tail<3>() / kDegree);
  out["position_sigma_m"] = vector_json(camera.pose_sigmas.head<3>());
  if (!result.fit.has_imu) return out;
  out["time_offset_s"] = camera.time_offset_s;
  out["time_offset_sigma_s"] = camera.time_offset_sigma_s;
  return out;
}

double rounded_to(double value, double step) { return std::round(value / step) * step; }

}  // namespace

Calibration to_calibration(const TargetCalibration& result, const std::string& name, const ImuNoise* imu) {
  Calibration out;
  out.rig.name = name;
  out.has_extrinsics = result.fit.has_imu;
  out.has_imu_noise = imu != nullptr;
  if (imu != nullptr) out.imu = *imu;
  for (std::size_t i = 0; i < result.cameras.size(); ++i) {
    const TargetViews& views = result.cameras[i].views;
    const CalibratedCamera& camera = result.fit.cameras[i];
    out.rig.cameras.push_back({views.name, views.modality, camera.lens.model(views.width, views.height), camera.T_B_C,
                               duration_from_seconds(camera.time_offset_s)});
  }
  return out;
}

std::string to_text(const TargetCalibration& result) {
  std::string out = fmt::format("{:<11} {}\n", "target", describe(result.target));
  for (std::size_t i = 0; i < result.cameras.size(); ++i) out += camera_text(result, i);
  if (result.fit.has_imu)
    out += fmt::format(
        "{:<11} gyro bias [{:.4f}, {:.4f}, {:.4f}] rad/s, accelerometer bias [{:.3f}, {:.3f}, {:.3f}] m/s^2\n", "imu",
        result.fit.bias_gyro.x(), result.fit.bias_gyro.y(), result.fit.bias_gyro.z(), result.fit.bias_accel.x(),
        result.fit.bias_accel.y(), result.fit.bias_accel.z());
  if (result.imu_clock)
    out += fmt::format("{:<11} {} added to its stamps, {}\n", "imu clock", offset_text(*result.imu_clock),
                       offset_evidence(*result.imu_clock->found));
  for (const std::string& line : result.advice) out += fmt::format("{:<11} {}\n", "better", line);
  return out;
}

ordered_json to_json(const TargetCalibration& result) {
  ordered_json out = {{"recording", result.recording}, {"target", describe(result.target)},
                      {"has_imu", result.fit.has_imu}, {"states", result.fit.states},
                      {"seconds", result.seconds},     {"advice", result.advice}};
  for (std::size_t i = 0; i < result.cameras.size(); ++i) out["cameras"].push_back(camera_json(result, i));
  if (!result.fit.has_imu) return out;
  if (result.imu_clock) out["imu_clock"] = to_json(*result.imu_clock);
  out["gyro_bias"] = vector_json(result.fit.bias_gyro);
  out["accel_bias"] = vector_json(result.fit.bias_accel);
  out["imu_misfit"] = result.fit.imu_misfit;
  return out;
}

std::string target_page(const TargetCalibration& result) {
  ordered_json data = to_json(result);
  std::optional<Timestamp> begin;
  for (const CalibratedCamera& camera : result.fit.cameras)
    for (const CornerResidual& r : camera.residuals) begin = begin ? std::min(*begin, r.t) : r.t;
  for (std::size_t i = 0; i < result.cameras.size(); ++i) {
    ordered_json& camera = data["cameras"][i];
    camera["cells"] = {{"columns", CornerCells::kColumns},
                       {"rows", CornerCells::kRows},
                       {"corners", result.coverage[i].cells.corners}};
    const auto& residuals = result.fit.cameras[i].residuals;
    const std::size_t step = residuals.size() / kMostShown + 1;
    ordered_json list = ordered_json::array();
    for (std::size_t k = 0; k < residuals.size(); k += step) {
      const CornerResidual& r = residuals[k];
      list.push_back({rounded_to(to_seconds(r.t - *begin), 1e-3), rounded_to(r.pixel.x(), 0.1),
                      rounded_to(r.pixel.y(), 0.1), rounded_to(r.error_px.x(), 1e-3),
                      rounded_to(r.error_px.y(), 1e-3)});
    }
    camera["residuals"] = std::move(list);
  }
  return calibration_page(data);
}

}  // namespace edged
