// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Runs the odometry over a recording whose truth is known, and writes how far every corner was from its true place.
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>

#include "common/config_source.hpp"
#include "common/source.hpp"
#include "edged/camera/undistort.hpp"
#include "edged/core/check.hpp"
#include "edged/odometry.hpp"
#include "program/commands.hpp"
#include "program/program.hpp"
#include "track_truth.hpp"

namespace edged {
namespace {

constexpr Duration kVelocityStep = std::chrono::milliseconds(5);  // to either side

struct ErrorOptions {
  SourceOptions source;
  ConfigSource config;
  std::vector<std::string> simulator;  ///< "key=value"
  std::string mode = "auto";
  std::filesystem::path out;
};

/// The trails of one camera while they grow.
struct GrowingTrails {
  CameraTrails seen;
  std::map<FeatureId, std::size_t> index;

  void add(std::span<const Track> tracks, Timestamp t, bool tracking) {
    for (const Track& track : tracks) {
      const auto [place, is_new] = index.try_emplace(track.id, seen.trails.size());
      if (is_new) seen.trails.push_back({track.id, {}, {}, false});
      seen.trails[place->second].observations.push_back({t, track.pixel, track.point, tracking});
    }
  }
};

std::vector<GrowingTrails> cameras_of(const Rig& rig, Mode mode) {
  std::vector<GrowingTrails> cameras;
  const auto add = [&](Modality modality) {
    const RigCamera* camera = rig.find(modality);
    EDGED_CHECK(camera != nullptr, "rig {} without a camera that the odometry has taken", rig.name);
    const bool events = modality == Modality::Events;
    cameras.push_back({{*camera, events ? ideal_pinhole(camera->model) : camera->model, {}}, {}});
  };
  if (mode != Mode::Frames) add(Modality::Events);
  if (mode != Mode::Events) add(Modality::Frames);
  return cameras;
}

std::vector<GrowingTrails> follow_corners(Source& source, Mode mode, const OdometryConfig& config) {
  Odometry odometry(source.calibration.rig, source.calibration.imu, mode, config, {kInOrder});
  std::vector<GrowingTrails> cameras = cameras_of(source.calibration.rig, mode);
  drive(
      odometry, [&] { return source.dataset->next(); },
      [&](const Step& step) {
        for (GrowingTrails& camera : cameras) {
          const CameraStep& seen = *step.find(camera.seen.camera.name);
          if (!seen.image.empty()) camera.add(seen.tracks, step.t, is_tracking(step.status));
        }
        return true;
      });
  return cameras;
}

/// True pixel of a trail at t, without noise; nothing where it cannot be known.
std::optional<Eigen::Vector2d> true_pixel(const TrackTruth& truth, const CameraTrails& camera, const Trail& trail,
                                          Timestamp t) {
  const std::optional<SE3> T_W_C = truth.T_W_C(camera.camera, t);
  return T_W_C ? camera.image.project(T_W_C->inverse() * *trail.p_W) : std::nullopt;
}

std::string row(const TrackTruth& truth, const CameraTrails& camera, const Trail& trail,
                const Observation& observation) {
  const Observation& first = trail.observations.front();
  const auto pixel = true_pixel(truth, camera, trail, observation.t);
  const auto before = true_pixel(truth, camera, trail, observation.t - kVelocityStep);
  const auto after = true_pixel(truth, camera, trail, observation.t + kVelocityStep);
  const auto T_W_C0 = truth.T_W_C(camera.camera, first.t);
  if (!pixel || !before || !after || !T_W_C0) return "";
  const SE3 T_C_W = truth.T_W_C(camera.camera, observation.t)->inverse();
  const Eigen::Vector3d p_C = T_C_W * *trail.p_W;
  const Eigen::Vector2d error = observation.pixel - *pixel;
  const Eigen::Vector2d velocity = (*after - *before) / to_seconds(2 * kVelocityStep);
  const Eigen::Vector3d turned = so3::log(T_C_W.rotation() * T_W_C0->rotation());
  return fmt::format(
      "{},{},{},{:.6f},{:.4f},{:.4f},{:.3f},{:.3f},{:.2f},{:.2f},{:.5f},{:.5f},{:.4f},{:.3f},{:.6f},{:.6f},{:.6f},{:d},"
      "{:d}\n",
      camera.camera.name, trail.id, to_ns(observation.t), to_seconds(observation.t - first.t), error.x(), error.y(),
      pixel->x(), pixel->y(), velocity.x(), velocity.y(), p_C.x() / p_C.z(), p_C.y() / p_C.z(), p_C.z(),
      camera.image.mean_focal(), turned.x(), turned.y(), turned.z(), trail.at_edge, observation.tracking);
}

void write(const std::filesystem::path& file, const TrackTruth& truth, const std::vector<GrowingTrails>& cameras) {
  std::ofstream out(file);
  out << "# error: seen minus true pixel; x, y, velocity, bearing and depth are the true ones; turned: rotation vector "
         "R_now_first of the camera since the first observation [rad]; edge: near the rim of what hides something\n"
         "camera,track,t_ns,age_s,error_x_px,error_y_px,x_px,y_px,velocity_x_px_s,velocity_y_px_s,bearing_x,bearing_y,"
         "depth_m,focal_px,turned_x,turned_y,turned_z,edge,tracking\n";
  for (const GrowingTrails& camera : cameras) {
    for (const Trail& trail : camera.seen.trails) {
      if (!trail.p_W) continue;
      for (const Observation& observation : trail.observations) out << row(truth, camera.seen, trail, observation);
    }
  }
  out.close();
  if (!out) throw InputError::format("{}: cannot be written; choose another --out", file.string());
}

int run(const ErrorOptions& options) {
  const OdometryConfig config = load_config(options.config).odometry;
  std::unique_ptr<TrackTruth> truth;
  Source source;
  if (auto simulated = simulator_config(options.source)) {
    if (options.source.dim_frames || options.source.piece.from_s > 0.0)
      throw InputError("--dim-frames, --from: not for simulations; set --sim frames.electrons_per_ms=... instead");
    if (options.source.piece.to_s) simulated->duration_s = *options.source.piece.to_s;
    assign(*simulated, options.simulator);
    truth = simulated_truth(*simulated);
    auto simulator = std::make_unique<Simulator>(*simulated);
    source.calibration = simulator->calibration();
    source.dataset = std::move(simulator);
  } else {
    source = open_source(options.source);
  }
  const Mode mode = choose_mode(options.mode, source.dataset->info());
  match_cameras(source, mode);
  std::vector<GrowingTrails> cameras = follow_corners(source, mode, config);
  if (!truth) {
    const std::optional<GroundTruth> poses = source.dataset->ground_truth();
    if (!poses) throw InputError::format("{}: has no true poses", options.source.recording);
    truth = recorded_truth(*poses, source.calibration.rig);
  }
  for (GrowingTrails& camera : cameras) truth->locate(camera.seen);
  write(options.out, *truth, cameras);
  return kExitOk;
}

}  // namespace
}  // namespace edged

int main(int argc, char** argv) {
  using namespace edged;
  CLI::App app{"How far the tracker's corners are from their true places: one line an observation", "edged_tracks"};
  ErrorOptions options;
  add_source_options(app, options.source);
  add_config_options(app, options.config);
  add_assignments(app, "--sim", "One option of the simulator", options.simulator);
  app.add_option("--mode", options.mode, "Sensors beside the IMU; auto: all there are")
      ->check(CLI::IsMember({"auto", "events", "frames", "fused"}));
  app.add_option("--out", options.out, "Table to write (csv)")->required();
  return run_program(app, argc, argv, [&] { return run(options); });
}
