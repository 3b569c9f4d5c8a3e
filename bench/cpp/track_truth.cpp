// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "track_truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "edged/camera/output_frame.hpp"
#include "edged/camera/two_view.hpp"
#include "edged/core/check.hpp"
#include "edged/sim/sensors/renderer.hpp"

namespace edged {
namespace {

constexpr double kMaxGap_s = 0.1;  // between poses that are interpolated
constexpr std::size_t kFewestObservations = 4;
constexpr double kLeastParallax = 0.02;  // [rad]
constexpr int kEdgeReach_px = 2;
constexpr float kEdgeStep = 1.1F;  // ratio of depths

class SimulatedTruth final : public TrackTruth {
 public:
  explicit SimulatedTruth(const SimulatorConfig& config)
      : simulator_(config), offset_(simulator_.calibration().rig.cameras.front().time_offset) {
    if (!simulator_.scene().dynamic_objects.empty())
      throw InputError::format("sim:{}: things move in it, and corners on them have no place; choose another preset",
                               config.name);
  }

  std::optional<SE3> T_W_B(Timestamp t) const override {
    return simulator_.trajectory().at(to_seconds(t - offset_)).T_W_B;
  }

  void locate(CameraTrails& seen) const override {
    std::map<Timestamp, std::vector<Trail*>> born;
    for (Trail& trail : seen.trails) born[trail.observations.front().t].push_back(&trail);
    Renderer renderer(seen.image, simulator_.scene());
    for (const auto& [t, trails] : born) {
      const SE3 T_W_C = *this->T_W_C(seen.camera, t);
      const Rendering& picture = renderer.render(T_W_C, to_seconds(t - offset_));
      for (Trail* trail : trails) {
        const auto [w, at_edge] = scene_point(picture, seen.image, trail->observations.front().pixel);
        trail->at_edge = at_edge;
        if (w > 0.0) trail->p_W = T_W_C * (trail->observations.front().point.homogeneous() / w);
      }
    }
  }

 private:
  Simulator simulator_;
  Duration offset_;
};

class RecordedTruth final : public TrackTruth {
 public:
  RecordedTruth(const GroundTruth& truth, const Rig& rig) {
    const OutputFrame frame(rig, truth.frame);
    for (const StampedPose& pose : truth.trajectory) T_W_B_.push_back(frame.to_body(pose));
  }

  std::optional<SE3> T_W_B(Timestamp t) const override {
    const auto after = std::lower_bound(T_W_B_.begin(), T_W_B_.end(), t,
                                        [](const StampedPose& pose, Timestamp at) { return pose.t < at; });
    if (after == T_W_B_.begin() || after == T_W_B_.end()) return std::nullopt;
    const StampedPose& before = *(after - 1);
    const double gap_s = to_seconds(after->t - before.t);
    if (gap_s > kMaxGap_s) return std::nullopt;
    return interpolate(before.T, after->T, to_seconds(t - before.t) / gap_s);
  }

  void locate(CameraTrails& seen) const override {
    for (Trail& trail : seen.trails) {
      std::vector<View> views;
      for (const Observation& observation : trail.observations) {
        if (const auto pose = T_W_C(seen.camera, observation.t)) views.push_back({*pose, observation.point});
      }
      if (views.size() < kFewestObservations) continue;
      if (const auto found = triangulate(views, kLeastParallax)) trail.p_W = found->p_A;
    }
  }

 private:
  Trajectory T_W_B_;
};

}  // namespace

ScenePoint scene_point(const Rendering& picture, const CameraModel& image, const Eigen::Vector2d& pixel) {
  const int x_0 = static_cast<int>(std::floor(pixel.x())), y_0 = static_cast<int>(std::floor(pixel.y()));
  const auto at = [&](int x, int y) {
    x = std::clamp(x, 0, image.width() - 1), y = std::clamp(y, 0, image.height() - 1);
    return picture.inverse_depth[static_cast<std::size_t>(y * image.width() + x)];
  };
  float nearest = 0.0F, farthest = std::numeric_limits<float>::max();
  for (int y = y_0 - kEdgeReach_px + 1; y <= y_0 + kEdgeReach_px; ++y) {
    for (int x = x_0 - kEdgeReach_px + 1; x <= x_0 + kEdgeReach_px; ++x)
      nearest = std::max(nearest, at(x, y)), farthest = std::min(farthest, at(x, y));
  }
  if (nearest > kEdgeStep * farthest) return {nearest, true};
  const double fx = pixel.x() - x_0, fy = pixel.y() - y_0;
  return {(1.0 - fy) * ((1.0 - fx) * at(x_0, y_0) + fx * at(x_0 + 1, y_0)) +
              fy * ((1.0 - fx) * at(x_0, y_0 + 1) + fx * at(x_0 + 1, y_0 + 1)),
          false};
}

std::unique_ptr<TrackTruth> simulated_truth(const SimulatorConfig& config) {
  return std::make_unique<SimulatedTruth>(config);
}

std::unique_ptr<TrackTruth> recorded_truth(const GroundTruth& truth, const Rig& rig) {
  return std::make_unique<RecordedTruth>(truth, rig);
}

}  // namespace edged
