// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Training samples of the depth network: random simulated scenes, voxel grids of a central region, and its true
// z-depth.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/events/voxel_grid.hpp"
#include "edged/sim/disturbance.hpp"
#include "edged/sim/motion/motion.hpp"
#include "edged/sim/random.hpp"
#include "edged/sim/scene/scene.hpp"
#include "edged/sim/sensors/event_camera.hpp"
#include "edged/sim/sensors/renderer.hpp"
#include "edged/sim/simulator.hpp"

namespace edged {
namespace {

constexpr int kSide = 128;  // of the region [px]
constexpr int kBins = 5;
constexpr int kDepthStride = 4;  // the depth map is that much smaller
constexpr Duration kWindow = std::chrono::milliseconds(50);
constexpr int kMinEvents = kSide * kSide / 20;
constexpr double kMaxMotionPx = 0.7;  // between renders
constexpr double kLongestStep_s = 3e-3;
constexpr float kVoxelScale = 16.0F;  // int8 voxels are 1/16 of a standard deviation

/// Before the samples in the file; all little endian. tools/depth/train.py reads it.
struct FileHeader {
  char magic[8] = {'E', 'D', 'G', 'E', 'D', 'V', 'X', '1'};
  std::int32_t bins = kBins, side = kSide, depth_side = kSide / kDepthStride, sample_bytes = 0;
};

/// Before the voxels (int8, bins x side x side) and the depths (uint16 mm, 0: none, depth_side x depth_side).
struct SampleHeader {
  std::int32_t scene = 0, window = 0, events = 0;
  float speed = 0.0F;  // of the camera [m/s], at the end of the window; for analysis only
};

struct Options {
  std::string out;
  int scenes = 10, first = 0, windows = 24;
};

double log_uniform(Random& random, double low, double high) { return low * std::pow(high / low, random.uniform()); }

/// A room or wall of random size, seen on a random path; scale multiplies all lengths of both.
struct World {
  SimulatorConfig config;
  double scale = 1.0;
  double texture_pitch = 1.0;  ///< texels per metre, against those of the simulator
};

World random_world(int seed, double duration_s) {
  Random random(static_cast<std::uint64_t>(seed), 77);
  World world;
  world.scale = log_uniform(random, 0.5, 2.0);
  world.texture_pitch = log_uniform(random, 0.25, 4.0);
  SimulatorConfig& c = world.config;
  c.seed = seed;
  c.duration_s = duration_s;
  c.motion.rest_s = c.motion.blend_s = 0.0;
  // Long enough ways that the depth changes within a scene.
  c.motion.extent_m = log_uniform(random, 0.2, 1.6);
  c.motion.max_angle_deg = random.uniform(3.0, 50.0);
  c.motion.max_speed = log_uniform(random, 0.15, 2.5) / world.scale;
  c.motion.max_rate_deg_s = log_uniform(random, 2.0, 150.0);
  const double kind = random.uniform();
  c.scene.kind = kind < 0.6 ? SceneKind::Boxes : kind < 0.92 ? SceneKind::Poster : SceneKind::Shapes;
  c.scene.objects = random.index(28);
  c.scene.wall_m = log_uniform(random, 0.6, 4.5);
  c.scene.clearance_m = log_uniform(random, 0.25, 0.8);
  c.scene.poster_distance_m = log_uniform(random, 0.4, 8.0) / world.scale;
  c.scene.light = log_uniform(random, 0.1, 1.0);
  c.events.threshold_on = random.uniform(0.15, 0.5);
  c.events.threshold_off = c.events.threshold_on * random.uniform(0.8, 1.25);
  c.events.threshold_sigma = random.uniform(0.0, 0.06);
  c.events.refractory_us = log_uniform(random, 50.0, 1000.0);
  c.events.bandwidth_hz = random.uniform() < 0.5 ? 0.0 : log_uniform(random, 30.0, 300.0);
  c.events.leak_hz = random.uniform(0.0, 0.2);
  c.events.shot_hz = log_uniform(random, 0.01, 1.0);
  return world;
}

/// The DAVIS240C, of which only the region exists.
CameraModel region_camera(const SimulatedCameraConfig& camera) {
  const cv::Rect region((camera.width - kSide) / 2, (camera.height - kSide) / 2, kSide, kSide);
  return {kSide,
          kSide,
          camera.fx,
          camera.fy,
          camera.cx - region.x,
          camera.cy - region.y,
          DistortionModel::RadTan,
          {camera.k1, camera.k2, camera.p1, camera.p2, 0.0}};
}

/// One scene, rendered window by window.
class SceneRun {
 public:
  SceneRun(const World& world, double duration_s)
      : world_(world),
        trajectory_(make_motion(world.config.motion, duration_s, world.config.T_B_C, seed())),
        renderer_(region_camera(world.config.camera), scaled_scene(duration_s)),
        camera_(world.config.events, kSide, kSide, seed()) {
    render();
  }

  /// The events until the end of the next window.
  std::vector<Event> next_window() {
    std::vector<Event> window;
    const Timestamp end = t_ + kWindow;
    while (t_ < end) {
      const double step_s = std::min(kLongestStep_s, kMaxMotionPx / std::max(1e-3, image_speed()));
      t_ = std::min(end, t_ + std::chrono::microseconds(std::max<std::int64_t>(1, std::llround(step_s * 1e6))));
      const std::vector<Event> events = render();
      window.insert(window.end(), events.begin(), events.end());
    }
    return window;
  }

  const std::vector<float>& inverse_depth() const { return renderer_.last().inverse_depth; }
  double speed() const { return world_.scale * truth().v_W.norm(); }

 private:
  std::uint64_t seed() const { return static_cast<std::uint64_t>(world_.config.seed); }
  Kinematics truth() const { return trajectory_.at(to_seconds(t_)); }

  SE3 scaled(const SE3& T) const { return {T.rotation(), world_.scale * T.translation()}; }

  Scene scaled_scene(double duration_s) const {
    std::vector<SE3> path;
    for (double t = 0.0; t <= duration_s; t += 0.02) path.push_back(trajectory_.at(t).T_W_B * world_.config.T_B_C);
    Scene scene = make_scene(world_.config.scene, path, seed());
    Random random(seed(), 78);
    for (Face& face : scene.faces) {
      face.centre_W *= world_.scale;
      face.half_u *= world_.scale, face.half_v *= world_.scale;
      const double pitch = world_.texture_pitch * log_uniform(random, 0.7, 1.4) / world_.scale;
      face.texels_per_m = static_cast<float>(face.texels_per_m * pitch);
    }
    return scene;
  }

  std::vector<Event> render() {
    return camera_.update(t_, renderer_.render(scaled(truth().T_W_B * world_.config.T_B_C)).radiance);
  }

  double image_speed() const {
    const Kinematics k = truth();
    const SE3& T_B_C = world_.config.T_B_C;
    const Eigen::Vector3d v_B = k.T_W_B.rotation().conjugate() * k.v_W + k.omega_B.cross(T_B_C.translation());
    const Eigen::Quaterniond R_C_B = T_B_C.rotation().conjugate();
    return renderer_.max_image_speed(world_.scale * (R_C_B * v_B), R_C_B * k.omega_B);
  }

  World world_;
  ContinuousTrajectory trajectory_;
  Renderer renderer_;
  EventCamera camera_;
  Timestamp t_;
};

std::vector<std::int8_t> quantised_grid(const std::vector<Event>& events) {
  cv::Mat grid = voxel_grid(events, cv::Rect(0, 0, kSide, kSide), kBins);
  normalise_voxels(grid);
  std::vector<std::int8_t> out(grid.total());
  const float* v = grid.ptr<float>();
  for (std::size_t i = 0; i < out.size(); ++i) {
    const float q = std::round(std::clamp(kVoxelScale * v[i], -127.0F, 127.0F));
    // A voxel near the mean stays apart from one without events, as in the grid itself.
    out[i] = static_cast<std::int8_t>(q == 0.0F && v[i] != 0.0F ? 1.0F : q);
  }
  return out;
}

/// Geometric mean of each block [mm]; 0 where a pixel of the block sees nothing.
std::vector<std::uint16_t> block_depths(const std::vector<float>& inverse_depth) {
  constexpr int kBlocks = kSide / kDepthStride;
  std::vector<std::uint16_t> out;
  for (int by = 0; by < kBlocks; ++by) {
    for (int bx = 0; bx < kBlocks; ++bx) {
      double log_sum = 0.0;
      for (int y = 0; y < kDepthStride; ++y)
        for (int x = 0; x < kDepthStride; ++x)
          log_sum -= std::log(
              inverse_depth[static_cast<std::size_t>((by * kDepthStride + y) * kSide + bx * kDepthStride + x)]);
      const double depth = std::exp(log_sum / (kDepthStride * kDepthStride));
      out.push_back(std::isfinite(depth) && depth < 65.0 ? static_cast<std::uint16_t>(std::lround(1e3 * depth)) : 0);
    }
  }
  return out;
}

template <typename T>
void write(std::ofstream& file, const T* data, std::size_t count) {
  file.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(count * sizeof(T)));
}

int write_scene(std::ofstream& file, int seed, int windows) {
  const double duration_s = to_seconds(kWindow) * windows;
  SceneRun run(random_world(seed, duration_s), duration_s);
  int written = 0;
  for (int i = 0; i < windows; ++i) {
    const std::vector<Event> events = run.next_window();
    if (static_cast<int>(events.size()) < kMinEvents) continue;
    const SampleHeader header{seed, i, static_cast<std::int32_t>(events.size()), static_cast<float>(run.speed())};
    const std::vector<std::int8_t> voxels = quantised_grid(events);
    const std::vector<std::uint16_t> depths = block_depths(run.inverse_depth());
    write(file, &header, 1), write(file, voxels.data(), voxels.size()), write(file, depths.data(), depths.size());
    ++written;
  }
  return written;
}

void write_samples(const Options& options) {
  std::ofstream file(options.out, std::ios::binary);
  if (!file) throw InputError::format("{}: cannot be written; choose another --out", options.out);
  constexpr int kDepths = (kSide / kDepthStride) * (kSide / kDepthStride);
  FileHeader header;
  header.sample_bytes = sizeof(SampleHeader) + kBins * kSide * kSide + kDepths * 2;
  write(file, &header, 1);
  int samples = 0;
  for (int i = 0; i < options.scenes; ++i) samples += write_scene(file, options.first + i, options.windows);
  std::printf("%s: %d samples of %d scenes\n", options.out.c_str(), samples, options.scenes);
}

}  // namespace
}  // namespace edged

int main(int argc, char** argv) {
  CLI::App app{"Simulates scenes and writes training samples for the depth network", "edged_depth_samples"};
  edged::Options options;
  app.add_option("--out", options.out, "File to write")->required();
  app.add_option("--scenes", options.scenes, "How many")->capture_default_str();
  app.add_option("--first", options.first, "Seed of the first scene; the others follow")->capture_default_str();
  app.add_option("--windows", options.windows, "Windows of 50 ms a scene")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    edged::write_samples(options);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "edged_depth_samples: %s\n", e.what());
    return 1;
  }
  return 0;
}
