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
#include "edged/measurement.hpp"
#include "edged/options/events.hpp"
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

/// The motion of a camera from body poses T_O_B: T_ref_t = T_C_B * T_O_B(ref)^-1 * T_O_B(t) * T_B_C, with the
/// poses' stamps on the clock of its events: t_pose = t_event + time_offset.
CameraMotion camera_motion(std::span<const StampedPose> T_O_B, const SE3& T_O_Bref, const SE3& T_B_C,
                           Duration time_offset = Duration(0));

struct WarpSettings {
  WarpInterpolation interpolation = WarpInterpolation::Piecewise;
  double depth = 1.0;  ///< Z [m]: z-depth of the scene in the camera at the time of each event
};

/// Eq. 2 for one event: x' = pi(K', T_ref_t * (Z * K'^-1 x)). With the one depth Z it is the homography
/// H(t) = K' (R + t e_z^T / Z) K'^-1 of undistorted pixels. H is computed exactly on a grid in time (the knots, and
/// between them steps of at most 0.5 ms) and linear in between: below 0.02 px off at 20 rad/s. With a depth Z_i per
/// event, K' t (1/Z_i - 1/Z) is added to the result of H.
class EventWarp {
 public:
  /// Serves events with stamps in [first, last]. `ideal` is the undistorted camera K'. CheckError when depth is not
  /// positive and finite.
  EventWarp(const CameraModel& ideal, const CameraMotion& motion, const WarpSettings& settings, Timestamp first,
            Timestamp last);

  /// Calls sink(float x, float y) with the warped position [px] of each event, in order. Events in time order. Skipped:
  /// events outside the table or the used part of the lens, and points that end up behind the camera.
  template <typename Sink>
  void for_each(std::span<const Event> events, const UndistortTable& table, Sink&& sink) const {
    visit(
        events, table, [](const Eigen::Vector2f&) { return 0.0F; }, sink);
  }

  /// As above, with the depth that the grid holds where the event is; the grid belongs to the reference time, and
  /// motion within its cells is neglected.
  template <typename Sink>
  void for_each(std::span<const Event> events, const UndistortTable& table, const DepthGrid& depths,
                Sink&& sink) const {
    visit(
        events, table, [&](const Eigen::Vector2f& p) { return depths.inverse_depth(p.x(), p.y()) - inverse_depth_; },
        sink);
  }

 private:
  static constexpr std::size_t kAhead = 24;       ///< events between the prefetch of a table entry and its use
  static constexpr float kMinDepthRatio = 1e-3F;  ///< depth after the warp over depth before it

  /// H(t) = h + a * dh and K' t = shift_begin + a * shift_change, with a from 0 at begin to 1 at end; h row-major.
  struct Bin {
    Timestamp begin, end;
    float per_ns = 0.0F;  ///< 1 / (end - begin)
    float h[9], dh[9];
    float shift_begin[3], shift_change[3];
  };

  /// Events of one bin side by side, so that several are warped at once.
  struct Block {
    static constexpr std::size_t kMost = 64;
    float x[kMost], y[kMost];  ///< undistorted pixel, then the warped one
    float a[kMost];            ///< time in the bin, from 0 to 1
    float nearer[kMost];       ///< inverse depth less the one that H holds
    float w[kMost];            ///< depth after the warp over depth before it
    bool positive[kMost];
    std::size_t count = 0;
  };
  static void warp(const Bin& bin, Block& block);

  /// Fills the block with the next events of a bin, and returns the events after these. nearer(undistorted pixel): its
  /// inverse depth less the one that H holds.
  template <typename Nearer>
  static std::span<const Event> fill(Block& block, const Bin& bin, std::span<const Event> events,
                                     const UndistortTable& table, const Nearer& nearer) {
    const auto width = static_cast<unsigned>(table.width());
    const auto height = static_cast<unsigned>(table.height());
    // Table and image of a large sensor do not fit into the L2 cache.
    const auto prefetch = [&](const Event& event) {
      if (event.x < width && event.y < height) __builtin_prefetch(&table.at(event.x, event.y));
    };
    std::size_t i = 0;
    for (block.count = 0; block.count < Block::kMost && i < events.size() && events[i].t < bin.end; ++i) {
      const Event& event = events[i];
      if (i + kAhead < events.size()) prefetch(events[i + kAhead]);
      if (event.x >= width || event.y >= height) continue;
      const Eigen::Vector2f& p = table.at(event.x, event.y);
      if (std::isnan(p.x())) continue;
      block.x[block.count] = p.x();
      block.y[block.count] = p.y();
      block.positive[block.count] = event.positive;
      block.a[block.count] = static_cast<float>((event.t - bin.begin).count()) * bin.per_ns;
      block.nearer[block.count++] = nearer(p);
    }
    return events.subspan(i);
  }

  template <typename Sink>
  static void pass_to(Sink& sink, const Block& block) {
    if constexpr (requires { sink.prefetch(0.0F, 0.0F, true); }) {
      for (std::size_t k = 0; k < block.count; ++k) sink.prefetch(block.x[k], block.y[k], block.positive[k]);
    }
    for (std::size_t k = 0; k < block.count; ++k) {
      if (!(block.w[k] < kMinDepthRatio)) sink(block.x[k], block.y[k], block.positive[k]);
    }
  }

  template <typename Nearer, typename Sink>
  void visit(std::span<const Event> events, const UndistortTable& table, Nearer&& nearer, Sink&& sink) const {
    Block block;
    for (const Bin& bin : bins_) {
      while (!events.empty() && events.front().t < bin.end) {
        events = fill(block, bin, events, table, nearer);
        warp(bin, block);
        pass_to(sink, block);
      }
    }
  }

  float inverse_depth_;    ///< 1/Z, of the depth that H holds
  std::vector<Bin> bins_;  ///< in time order without gaps; the last has no end
};

}  // namespace edged
