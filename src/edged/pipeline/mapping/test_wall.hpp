// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A mapper in front of a wall, for its tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "edged/frontend/test_scene.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/mapping/mapper.hpp"

namespace edged {

inline const double kLostAfter_s = StatusConfig().lost_after_s;

inline Timestamp second(double t_s) { return timestamp_from_seconds(t_s); }

class MapperBeforeAWall : public testing::Test {
 protected:
  /// The camera axis is x of the body, towards the wall; z is up.
  const SE3 T_B_C_{Eigen::Quaterniond(Eigen::Matrix3d{{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}}), Eigen::Vector3d::Zero()};

  static SE3 shift(double x, double y, double z) { return {Eigen::Quaterniond::Identity(), {x, y, z}}; }
  static OdomState now(double t_s, const SE3& T_O_B) {
    OdomState state;
    state.t = second(t_s);
    state.T_O_B = T_O_B;
    return state;
  }

  /// The wall lies 2 m before the origin of M. Features lie in a grid, not necessarily on the same points of the wall.
  TrackedImage image(const SE3& T_M_B) const { return image_at(T_M_B * T_B_C_, "cam"); }
  TrackedImage image_at(const SE3& T_M_C, const std::string& camera) const {
    TrackedImage image{camera, scene_.camera(), scene_.image(T_B_C_.inverse() * T_M_C), {}};
    for (int x = 24; x < 220; x += 16) {
      for (int y = 24; y < 160; y += 16) {
        Track track;
        track.id = image.tracks.size() + 1;
        track.pixel = {x, y};
        track.point = scene_.camera().pixel_to_point(track.pixel);
        image.tracks.push_back(track);
      }
    }
    return image;
  }

  /// A keyframe at the origin of M, that has left the window.
  void add_keyframe(Mapper& mapper, double t_s, const SE3& T_O_B, bool last_chance = false) const {
    add_keyframe(mapper, t_s, T_O_B, image(SE3()), last_chance);
  }
  void add_keyframe(Mapper& mapper, double t_s, const SE3& T_O_B, const TrackedImage& seen,
                    bool last_chance = false) const {
    mapper.predict(now(t_s, T_O_B));
    mapper.keyframe(second(t_s), std::vector{PosedImage{seen, T_O_B * T_B_C_}});
    MarginalizedKeyframe record{second(t_s), T_O_B, {{"cam", T_B_C_, {}}}};
    for (const Track& track : seen.tracks) record.views.front().points.push_back({track.id, track.point, 0.5, 0.005});
    mapper.add_keyframe(record, last_chance);
  }

  bool localize(Mapper& mapper, double t_s, const SE3& T_O_B, const SE3& T_M_B, double place_sigma = 0.0) const {
    mapper.predict(now(t_s, T_O_B));
    return mapper.localize(second(t_s), std::vector{PosedImage{image(T_M_B), T_O_B * T_B_C_}}, place_sigma);
  }

  PlaneScene scene_{davis_like_pinhole(), 2.0};
};

}  // namespace edged
