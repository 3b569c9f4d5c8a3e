// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Motion compensation of events (paper Eq. 1 and 2, corrected): every event moves to where its scene point, at one
// common depth or at one of its own, appears in the camera at the reference time.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>
#include <vector>

#include "edged/camera/undistort.hpp"
#include "edged/events/depth_grid.hpp"
#include "edged/events/events_config.hpp"
#include "edged/measurement.hpp"
#include "edged/se3.hpp"
#include "edged/state.hpp"

namespace edged {

struct MotionKnot {
  Timestamp t;  ///< same clock as the events
  SE3 T_ref_t;  ///< camera at t to camera at the reference time: p_ref = T_ref_t * p_t
};

/// The motion of the event camera relative to its pose at the reference time, sampled for instance at the IMU's rate.
/// No knots: at rest. One knot: a constant pose. Before the first and after the last knot the nearest segment's twist
/// goes on. Stamps increase strictly.
struct CameraMotion {
  std::vector<MotionKnot> knots;

  /// T_ref_t, exact. CheckError when the knots are out of order.
  SE3 at(Timestamp t, WarpInterpolation interpolation) const;
};

/// The motion of body poses T_W_B as seen by a camera: T_ref_t = T_C_B * T_W_B(ref)^-1 * T_W_B(t) * T_B_C, with the
/// poses' stamps on the clock of its events: t_pose = t_event + time_offset.
CameraMotion camera_motion(std::span<const StampedPose> T_W_B, const SE3& T_W_Bref, const SE3& T_B_C,
                           Duration time_offset = Duration(0));

struct WarpSettings {
  WarpInterpolation interpolation = WarpInterpolation::Piecewise;
  double depth = 1.0;  ///< Z [m]: z-depth of the scene in the camera at the time of each event
};

/// Eq. 2 for one event: x' = pi(K', T_ref_t * (Z * K'^-1 x)). With the one depth Z it is the homography
/// H(t) = K' (R + t e_z^T / Z) K'^-1 of undistorted pixels. H is computed exactly on a grid in time (the knots, and
/// between them steps of at most 0.5 ms) and linear in between: below 0.02 px off at 20 rad/s. With a depth Z_i per
/// event, K' t (1/Z_i - 1/Z) is added to what H gives.
class EventWarp {
 public:
  /// Serves events with stamps in [first, last]. `ideal` is the undistorted camera K'. CheckError when depth is not
  /// positive and finite.
  EventWarp(const CameraModel& ideal, const CameraMotion& motion, const WarpSettings& settings, Timestamp first,
            Timestamp last);

  /// Calls sink(float x, float y) with the warped position [px] of each event, in order. Events in time order. Left
  /// out: events outside the table or what is used of the lens, and points that come to lie behind the camera.
  template <typename Sink>
  void for_each(std::span<const Event> events, const UndistortTable& table, Sink&& sink) const {
    visit(events, table, [&sink](const Bin& bin, const Eigen::Vector2f& p, float a) {
      const float w = bin.row(2, p, a);
      if (w < kMinDepthRatio) return;
      const float inverse = 1.0F / w;
      sink(bin.row(0, p, a) * inverse, bin.row(1, p, a) * inverse);
    });
  }

  /// The same with the depth that the grid holds where the event is; the grid belongs to the reference time, and
  /// motion within its cells is neglected.
  template <typename Sink>
  void for_each(std::span<const Event> events, const UndistortTable& table, const DepthGrid& depths,
                Sink&& sink) const {
    visit(events, table, [&](const Bin& bin, const Eigen::Vector2f& p, float a) {
      const float nearer = depths.inverse_depth(p.x(), p.y()) - inverse_depth_;
      const float w = bin.row(2, p, a) + nearer * bin.shift(2, a);
      if (w < kMinDepthRatio) return;
      const float inverse = 1.0F / w;
      sink((bin.row(0, p, a) + nearer * bin.shift(0, a)) * inverse,
           (bin.row(1, p, a) + nearer * bin.shift(1, a)) * inverse);
    });
  }

 private:
  static constexpr float kMinDepthRatio = 1e-3F;  ///< depth after the warp over depth before it

  /// H(t) = h + a * dh and K' t = shift_begin + a * shift_change, with a from 0 at begin to 1 at end; h row-major.
  struct Bin {
    Timestamp begin, end;
    float per_ns = 0.0F;  ///< 1 / (end - begin)
    float h[9], dh[9];
    float shift_begin[3], shift_change[3];

    float row(int r, const Eigen::Vector2f& p, float a) const {
      const float* f = h + 3 * r;
      const float* d = dh + 3 * r;
      return f[0] * p.x() + f[1] * p.y() + f[2] + a * (d[0] * p.x() + d[1] * p.y() + d[2]);
    }
    float shift(int r, float a) const { return shift_begin[r] + a * shift_change[r]; }
  };

  /// Calls use(bin, undistorted pixel, a) for every event inside the table.
  template <typename Use>
  void visit(std::span<const Event> events, const UndistortTable& table, Use&& use) const {
    const auto width = static_cast<unsigned>(table.width());
    const auto height = static_cast<unsigned>(table.height());
    std::size_t i = 0;
    for (const Bin& bin : bins_) {
      for (; i < events.size() && events[i].t < bin.end; ++i) {
        const Event& event = events[i];
        if (event.x >= width || event.y >= height) continue;
        const Eigen::Vector2f& p = table.at(event.x, event.y);
        if (std::isnan(p.x())) continue;
        const float a = static_cast<float>((event.t - bin.begin).count()) * bin.per_ns;
        use(bin, p, a);
      }
    }
  }

  float inverse_depth_;    ///< 1/Z, of the depth that H holds
  std::vector<Bin> bins_;  ///< in time order without holes; the last ends never
};

}  // namespace edged
