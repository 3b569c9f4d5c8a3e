// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/warp.hpp"

#include <algorithm>
#include <cmath>

#include "edged/core/check.hpp"
#include "edged/events/tuning.hpp"

namespace edged {
namespace {

constexpr int kMaxBins = 4096;  // a very long packet gets longer bins instead of more memory

/// The pose along a motion, with the logarithm of each segment taken once.
class MotionCurve {
 public:
  MotionCurve(const CameraMotion& motion, WarpInterpolation interpolation) {
    const auto& knots = motion.knots;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
      EDGED_CHECK(knots[i].t < knots[i + 1].t, "motion knots {} and {} are not in time order", i, i + 1);
    }
    if (interpolation == WarpInterpolation::None || knots.empty()) return;
    if (knots.size() == 1) {
      segments_.push_back({knots.front().t, 0.0, knots.front().T_ref_t, Vector6d::Zero()});
      return;
    }
    if (interpolation == WarpInterpolation::SingleTwist) {
      add_segment(knots.front(), knots.back());
      return;
    }
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) add_segment(knots[i], knots[i + 1]);
  }

  SE3 at(Timestamp t) const {
    if (segments_.empty()) return SE3();
    const auto after = std::upper_bound(segments_.begin() + 1, segments_.end(), t,
                                        [](Timestamp value, const Segment& s) { return value < s.begin; });
    const Segment& s = *(after - 1);
    return s.T_begin * SE3::exp(to_seconds(t - s.begin) * s.per_s * s.twist);  // Eq. 1
  }

  /// Instants where the twist changes.
  std::vector<Timestamp> corners() const {
    std::vector<Timestamp> stamps;
    for (std::size_t i = 1; i < segments_.size(); ++i) stamps.push_back(segments_[i].begin);
    return stamps;
  }

  bool at_rest() const { return segments_.empty(); }

 private:
  struct Segment {
    Timestamp begin;
    double per_s;  // 1 / length
    SE3 T_begin;
    Vector6d twist;  // over the whole segment
  };

  void add_segment(const MotionKnot& a, const MotionKnot& b) {
    segments_.push_back({a.t, 1.0 / to_seconds(b.t - a.t), a.T_ref_t, (a.T_ref_t.inverse() * b.T_ref_t).log()});
  }

  std::vector<Segment> segments_;
};

/// From first to last: the knots in between, and steps of at most the bin length. At least two stamps.
std::vector<Timestamp> bin_edges(const MotionCurve& curve, Timestamp first, Timestamp last) {
  last = std::max(last, first + Duration(1));
  if (curve.at_rest()) return {first, last};
  std::vector<Timestamp> corners{first};
  for (const Timestamp t : curve.corners()) {
    if (t > first && t < last) corners.push_back(t);
  }
  corners.push_back(last);

  const Duration step = std::max(kEventsTuning.warp_step, (last - first) / kMaxBins);
  std::vector<Timestamp> edges{first};
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Duration length = corners[i + 1] - corners[i];
    const auto n = (length + step - Duration(1)) / step;
    for (std::int64_t k = 1; k <= n; ++k) edges.push_back(corners[i] + length * k / n);
  }
  return edges;
}

Eigen::Matrix3d camera_matrix(const CameraModel& camera) {
  Eigen::Matrix3d K;
  K << camera.fx(), 0, camera.cx(), 0, camera.fy(), camera.cy(), 0, 0, 1;
  return K;
}

}  // namespace

SE3 CameraMotion::at(Timestamp t, WarpInterpolation interpolation) const {
  return MotionCurve(*this, interpolation).at(t);
}

CameraMotion camera_motion(std::span<const StampedPose> T_O_B, const SE3& T_O_Bref, const SE3& T_B_C,
                           Duration time_offset) {
  const SE3 T_Cref_O = (T_O_Bref * T_B_C).inverse();
  CameraMotion motion;
  motion.knots.reserve(T_O_B.size());
  for (const StampedPose& pose : T_O_B) {
    motion.knots.push_back({pose.t - time_offset, T_Cref_O * pose.T * T_B_C});
  }
  return motion;
}

EventWarp::EventWarp(const CameraModel& ideal, const CameraMotion& motion, const WarpSettings& settings,
                     Timestamp first, Timestamp last)
    : inverse_depth_(static_cast<float>(1.0 / settings.depth)) {
  EDGED_CHECK(std::isfinite(settings.depth) && settings.depth > 0.0, "depth is {}", settings.depth);
  using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const Eigen::Matrix3d K = camera_matrix(ideal);
  const Eigen::Matrix3d K_inverse = K.inverse();
  const MotionCurve curve(motion, settings.interpolation);
  const auto homography = [&](const SE3& T_ref_t) -> RowMajor3 {  // Eq. 2
    Eigen::Matrix3d M = T_ref_t.R();
    M.col(2) += T_ref_t.translation() / settings.depth;
    return K * M * K_inverse;
  };
  const auto store = [](float* to, const Eigen::Vector3d& v) { Eigen::Vector3f::Map(to) = v.cast<float>(); };

  const std::vector<Timestamp> edges = bin_edges(curve, first, last);
  bins_.resize(edges.size() - 1);
  SE3 T_ref_begin = curve.at(edges.front());
  RowMajor3 H = homography(T_ref_begin);
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    Bin& bin = bins_[i];
    bin.begin = edges[i];
    bin.end = edges[i + 1];
    bin.per_ns = 1.0F / static_cast<float>((bin.end - bin.begin).count());
    const SE3 T_ref_end = curve.at(bin.end);
    const RowMajor3 H_end = homography(T_ref_end);
    Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(bin.h) = H.cast<float>();
    Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(bin.dh) = (H_end - H).cast<float>();
    store(bin.shift_begin, K * T_ref_begin.translation());
    store(bin.shift_change, K * (T_ref_end.translation() - T_ref_begin.translation()));
    H = H_end;
    T_ref_begin = T_ref_end;
  }
  bins_.back().end = Timestamp::max();
}

void EventWarp::warp(const Bin& bin, Block& block) {
  const Bin b = bin;  // restrict: no aliasing, so the loop is vectorized
  for (std::size_t k = 0; k < block.count; ++k) {
    const float x = block.x[k], y = block.y[k], a = block.a[k], nearer = block.nearer[k];
    const auto row = [&](int r) {
      const float* f = b.h + 3 * r;
      const float* d = b.dh + 3 * r;
      return f[0] * x + f[1] * y + f[2] + a * (d[0] * x + d[1] * y + d[2]) +
             nearer * (b.shift_begin[r] + a * b.shift_change[r]);
    };
    const float w = row(2), inverse = 1.0F / w;
    block.x[k] = row(0) * inverse;
    block.y[k] = row(1) * inverse;
    block.w[k] = w;
  }
}

}  // namespace edged
