// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/rig_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "edged/calibrate/imu_start.hpp"
#include "edged/calibrate/rig_problem.hpp"
#include "edged/core/check.hpp"
#include "edged/state.hpp"

namespace edged {
namespace {

using Eigen::Vector3d;

constexpr Duration kTogether = std::chrono::milliseconds(1);  // views that share a state
constexpr int kMostRounds = 5, kMostSteps = 25;
constexpr double kClockSettled_s = 2e-5;
constexpr std::size_t kFewestStates = 30;

/// The views of all cameras with a pose, in the order of their times.
struct PlacedView {
  Timestamp t;
  std::size_t camera, index;
};

std::vector<PlacedView> placed_views(const std::vector<TargetCamera>& cameras,
                                     const std::vector<CameraBlocks>& blocks) {
  std::vector<PlacedView> out;
  for (std::size_t c = 0; c < cameras.size(); ++c)
    for (std::size_t i = 0; i < cameras[c].views.views.size(); ++i)
      if (cameras[c].lens.T_C_T[i])
        out.push_back({cameras[c].views.views[i].t + duration_from_seconds(blocks[c].time_offset_s), c, i});
  std::ranges::stable_sort(out, {}, &PlacedView::t);
  return out;
}

Vector3d gyro_at(std::span<const ImuSample> imu, Timestamp t) {
  const auto next = std::ranges::upper_bound(imu, t, {}, &ImuSample::t);
  if (next == imu.begin() || next == imu.end()) return Vector3d::Zero();
  const ImuSample &a = *(next - 1), &b = *next;
  const double share = to_seconds(t - a.t) / to_seconds(b.t - a.t);
  return a.gyro_B + share * (b.gyro_B - a.gyro_B);
}

/// States at the times of the views, evenly thinned; with an IMU, only where it has samples.
std::vector<RigState> states_at(const std::vector<PlacedView>& views, std::span<const ImuSample> imu,
                                std::size_t most) {
  constexpr Duration kMargin = std::chrono::milliseconds(20);
  std::vector<RigState> all;
  for (const PlacedView& view : views) {
    if (!imu.empty() && (view.t < imu.front().t + kMargin || view.t > imu.back().t - kMargin)) continue;
    if (all.empty() || view.t - all.back().t > kTogether) {
      all.emplace_back();
      all.back().t = view.t;
    }
    all.back().views.emplace_back(view.camera, view.index);
  }
  std::vector<RigState> out = evenly(all, most);
  for (RigState& state : out) state.gyro_B = gyro_at(imu, state.t);
  return out;
}

/// Poses of the states by the first of their views, in the frame of the target; velocities by differences.
void place_states(RigUnknowns& unknowns, const std::vector<TargetCamera>& cameras) {
  for (RigState& state : unknowns.states) {
    const auto& [camera, view] = state.views.front();
    const SE3 T_T_C = cameras[camera].lens.T_C_T[view]->inverse();
    state.T_W_B = to_block(SE3(unknowns.R_W_T, Vector3d::Zero()) * T_T_C *
                           pose_of(unknowns.cameras[camera].T_B_C.data()).inverse());
  }
}

void differentiate(std::vector<RigState>& states) {
  for (std::size_t i = 0; i < states.size(); ++i) {
    const RigState &a = states[i > 0 ? i - 1 : 0], &b = states[std::min(i + 1, states.size() - 1)];
    const Vector3d v = (pose_of(b.T_W_B.data()).translation() - pose_of(a.T_W_B.data()).translation()) /
                       std::max(1e-3, to_seconds(b.t - a.t));
    for (int k = 0; k < 3; ++k) states[i].motion[static_cast<std::size_t>(k)] = v[k];
  }
}

/// The mean specific force points upwards, but for the change of velocity over the recording.
void level(RigUnknowns& unknowns, std::span<const ImuSample> imu) {
  Vector3d sum = Vector3d::Zero();
  std::size_t next = 0;
  for (const ImuSample& sample : imu) {
    while (next + 1 < unknowns.states.size() && unknowns.states[next].t < sample.t) ++next;
    sum += pose_of(unknowns.states[next].T_W_B.data()).rotation() * sample.accel_B;
  }
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(sum, Vector3d::UnitZ());
  unknowns.R_W_T = turn * unknowns.R_W_T;
  for (RigState& state : unknowns.states) {
    state.T_W_B = to_block(SE3(turn, Vector3d::Zero()) * pose_of(state.T_W_B.data()));
    Eigen::Map<Vector3d>{state.motion.data()} = turn * Eigen::Map<const Vector3d>(state.motion.data());
  }
}

/// T_C0_C of a camera: the one of many from pairs of views that is nearest to all others.
SE3 relative_pose(const std::vector<TargetCamera>& cameras, const std::vector<RigState>& states, std::size_t camera) {
  std::vector<SE3> found;
  for (const RigState& state : states) {
    const SE3 *first = nullptr, *own = nullptr;
    for (const auto& [c, view] : state.views) {
      if (c == 0) first = &*cameras[c].lens.T_C_T[view];
      if (c == camera) own = &*cameras[c].lens.T_C_T[view];
    }
    if (first != nullptr && own != nullptr) found.push_back(*first * own->inverse());
    if (found.size() == 60) break;
  }
  if (found.size() < 5)
    throw InputError::format(
        "cameras {} and {}: {} views of the target at the same time (within 1 ms), 5 are needed without an IMU; keep "
        "it "
        "in view of both, synchronise them, or record the IMU",
        cameras[0].views.name, cameras[camera].views.name, found.size());
  const auto apart = [&](const SE3& T) {
    double sum = 0.0;
    for (const SE3& other : found) sum += std::min(0.3, (T.inverse() * other).log().norm());
    return sum;
  };
  return *std::ranges::min_element(found, {}, apart);
}

RigUnknowns start_with_imu(const std::vector<TargetCamera>& cameras, std::span<const ImuSample> imu,
                           std::size_t most_states) {
  RigUnknowns out;
  Vector3d bias_gyro = Vector3d::Zero();
  for (const TargetCamera& camera : cameras) {
    const ImuStart start = align_imu(camera.views, camera.lens.T_C_T, imu);
    out.cameras.push_back(
        {to_block(SE3(start.R_B_C, Vector3d::Zero())), start.time_offset_s, 0.0, camera.lens.lens.values});
    bias_gyro += start.bias_gyro / static_cast<double>(cameras.size());
  }
  out.states = states_at(placed_views(cameras, out.cameras), imu, most_states);
  if (out.states.size() < kFewestStates)
    throw InputError::format("{} views of the target lie within the samples of the IMU, {} are needed; record longer",
                             out.states.size(), kFewestStates);
  place_states(out, cameras);
  differentiate(out.states);
  level(out, imu);
  for (RigState& state : out.states) Eigen::Map<Vector3d>(state.motion.data() + 3) = bias_gyro;
  return out;
}

RigUnknowns start_without_imu(const std::vector<TargetCamera>& cameras, std::size_t most_states) {
  RigUnknowns out;
  for (const TargetCamera& camera : cameras)
    out.cameras.push_back({to_block(SE3()), 0.0, 0.0, camera.lens.lens.values});
  out.states = states_at(placed_views(cameras, out.cameras), {}, most_states);
  for (std::size_t c = 1; c < cameras.size(); ++c)
    out.cameras[c].T_B_C = to_block(relative_pose(cameras, out.states, c));
  place_states(out, cameras);
  return out;
}

/// The states at the new times of their views: they keep pose and motion. Those that leave the samples of the IMU go.
void retime(RigUnknowns& unknowns, const std::vector<TargetCamera>& cameras, std::span<const ImuSample> imu) {
  for (RigState& state : unknowns.states) {
    const auto& [camera, view] = state.views.front();
    state.t = cameras[camera].views.views[view].t + duration_from_seconds(unknowns.cameras[camera].time_offset_s);
    state.gyro_B = gyro_at(imu, state.t);
  }
  std::erase_if(unknowns.states, [&](const RigState& s) { return s.t < imu.front().t || s.t > imu.back().t; });
  if (unknowns.states.size() < kFewestStates)
    throw InputError(
        "the clocks of cameras and IMU do not fit: with the estimated offset their recordings hardly overlap");
  std::ranges::stable_sort(unknowns.states, {}, &RigState::t);
  // Two cameras whose clocks turn out to be the same share no state; too short an interval has no information.
  const auto close = [](const RigState& a, const RigState& b) { return b.t - a.t < std::chrono::microseconds(50); };
  unknowns.states.erase(std::unique(unknowns.states.begin(), unknowns.states.end(), close), unknowns.states.end());
}

std::vector<CornerResidual> residuals_of(const RigUnknowns& unknowns, const std::vector<TargetCamera>& cameras,
                                         const TargetLayout& layout, std::size_t camera) {
  std::vector<CornerResidual> out;
  const CameraBlocks& blocks = unknowns.cameras[camera];
  const FreeLens lens{cameras[camera].lens.lens.distortion, blocks.lens};
  for (const RigState& state : unknowns.states)
    for (const auto& [c, index] : state.views) {
      if (c != camera) continue;
      const TargetView& view = cameras[c].views.views[index];
      const double after_s = to_seconds(view.t + duration_from_seconds(blocks.time_offset_s) - state.t);
      const SE3 T_W_B = pose_of(state.T_W_B.data());
      const Eigen::Map<const Vector3d> v(state.motion.data()), bias(state.motion.data() + 3);
      const SE3 moved(T_W_B.rotation() * so3::exp(after_s * (state.gyro_B - bias)), T_W_B.translation() + after_s * v);
      const SE3 T_C_T = (moved * pose_of(blocks.T_B_C.data())).inverse() * SE3(unknowns.R_W_T, Vector3d::Zero());
      for (const CornerPair& corner : pairs_of(view, layout))
        if (const auto pixel = project_free(lens, T_C_T * corner.p_T, nullptr, nullptr))
          out.push_back({view.t, corner.pixel, *pixel - corner.pixel});
    }
  return out;
}

/// variances: as RigProblem::calibration_variances() has them.
RigFit result_of(const RigUnknowns& unknowns, const Eigen::VectorXd& variances,
                 const std::vector<TargetCamera>& cameras, const TargetLayout& layout) {
  RigFit out;
  out.states = unknowns.states.size();
  const Eigen::VectorXd sigmas = variances.cwiseMax(0.0).cwiseSqrt();
  const double n = static_cast<double>(out.states);
  for (const RigState& state : unknowns.states) {
    out.bias_gyro += Eigen::Map<const Vector3d>(state.motion.data() + 3) / n;
    out.bias_accel += Eigen::Map<const Vector3d>(state.motion.data() + 6) / n;
  }
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const CameraBlocks& blocks = unknowns.cameras[c];
    const auto own = sigmas.segment<7 + kLensParameters>(static_cast<Eigen::Index>(c) * (7 + kLensParameters));
    CalibratedCamera camera;
    camera.lens = {cameras[c].lens.lens.distortion, blocks.lens};
    camera.sigma_px = cameras[c].lens.sigma_px;
    camera.T_B_C = pose_of(blocks.T_B_C.data());
    camera.pose_sigmas = own.head<6>();
    camera.time_offset_s = blocks.time_offset_s;
    camera.time_offset_sigma_s = own[6];
    for (int i = 0; i < kLensParameters; ++i) camera.lens_sigmas.at(static_cast<std::size_t>(i)) = own[7 + i];
    camera.residuals = residuals_of(unknowns, cameras, layout, c);
    out.cameras.push_back(std::move(camera));
  }
  return out;
}

}  // namespace

RigFit fit_rig(const std::vector<TargetCamera>& cameras, const TargetLayout& layout, std::span<const ImuSample> imu,
               const ImuNoise& noise, const RigFitOptions& options) {
  EDGED_CHECK(!cameras.empty(), "no camera");
  const bool has_imu = !imu.empty();
  RigUnknowns unknowns =
      has_imu ? start_with_imu(cameras, imu, options.most_states) : start_without_imu(cameras, options.most_states);
  for (int round = 0;; ++round) {
    if (options.progress) options.progress(round);
    RigProblem problem(unknowns, cameras, layout, imu, noise);
    problem.solve(kMostSteps);
    double moved_s = 0.0;
    for (const CameraBlocks& camera : unknowns.cameras) moved_s = std::max(moved_s, std::abs(camera.correction_s));
    const bool settled = !has_imu || moved_s < kClockSettled_s || round + 1 == kMostRounds;
    const Eigen::VectorXd variances = settled ? problem.calibration_variances() : Eigen::VectorXd();
    problem.apply_corrections();
    if (settled) {
      RigFit out = result_of(unknowns, variances, cameras, layout);
      out.has_imu = has_imu;
      out.imu_misfit = problem.imu_misfit();
      return out;
    }
    retime(unknowns, cameras, imu);
  }
}

}  // namespace edged
