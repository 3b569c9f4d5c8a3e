// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Ray casting of a scene into a camera with distortion, and the speed of the image.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "edged/rig.hpp"
#include "edged/sim/scene/light_field.hpp"
#include "edged/sim/scene/scene.hpp"
#include "edged/sim/sensors/lens_residual.hpp"

namespace edged {

/// A picture, row by row.
struct Rendering {
  std::vector<float> radiance;  ///< linear, 1 is a white spot in good light
  /// 1 / z-depth [1/m], or 1 / distance for a lens with a view_limit; 0 without a surface
  std::vector<float> inverse_depth;
};

class Renderer {
 public:
  /// residual: of the lens over its model. flare: share of the light of glowing faces that the lens scatters evenly,
  /// and as much that it mirrors about the centre of the image.
  Renderer(const CameraModel& camera, Scene scene, const LensResidual& residual = {}, double flare = 0.0);

  /// The picture from T_W_C in the light of t_s seconds after the start. The reference is valid until the next call.
  const Rendering& render(const SE3& T_W_C, double t_s = 0.0);

  const Rendering& last() const { return out_; }
  const Scene& scene() const { return scene_; }

  /// Fastest image motion [px/s] in the last picture, for a camera that moves with v_C [m/s] and turns with omega_C
  /// [rad/s], both in the camera frame. Includes surfaces and the edge of a moving light. Evaluated at every fourth
  /// pixel.
  double max_image_speed(const Eigen::Vector3d& v_C, const Eigen::Vector3d& omega_C) const;

  int width() const { return width_; }
  int height() const { return height_; }

 private:
  /// A face in the camera frame as three linear forms of the bearing b (pixel_to_ray): inverse depth w = a.b and plane
  /// coordinates times w. Visibility needs no division.
  struct View {
    Eigen::Vector3f inverse_depth, u, v;
    Eigen::Vector3f velocity;  // [m/s]
    Eigen::Vector3f normal;
    float half_u, half_v;
    float distance;  // of the camera from the plane [m]
  };
  struct PixelBox {
    int x_0, x_1, y_0, y_1;  // inclusive; empty when x_1 < x_0
  };

  /// A part of the picture of a wide lens.
  struct Block {
    PixelBox pixels;
    Eigen::AlignedBox3f bearings;  // extent of theirs
  };

  void make_blocks();
  /// A pixel sees a face where five linear forms of its bearing are positive: inverse depth, and the distances from
  /// the four sides. Bearings of a wide lens are unit vectors: the margin `least` is far beyond rounding errors.
  struct Condition {
    Eigen::Vector3f form;
    float least;
  };
  using Conditions = std::array<Condition, 5>;
  static Conditions conditions_of(const View& view);
  /// Whether any pixel of the block may see the face.
  static bool may_see(const Block& block, const Conditions& conditions);
  PixelBox bounds(const Face& face, const SE3& T_C_W) const;
  void cast(const View& view, const PixelBox& box, int index);
  void shade();
  /// n pixels from `first` on, all of which see the face `index`.
  void shade_run(std::size_t index, std::size_t first, std::size_t n);
  /// Of the lamps on a surface, in the camera frame.
  float highlight(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) const;
  void flare();
  /// Largest squared speed of the edge of the light [px^2/s^2].
  float squared_beam_speed(const Eigen::Vector3f& bearing, float inverse_depth) const;
  void blur();

  int width_, height_;
  float focal_;
  bool wide_;  // bearings are unit vectors in all directions
  Scene scene_;
  float flare_;
  LightField light_;
  std::vector<float> bearing_x_, bearing_y_, bearing_z_, bearing_norm_;
  std::vector<float> row_min_y_, row_max_y_, column_min_x_, column_max_x_;
  std::vector<Block> blocks_;                     // of a wide lens, else none
  std::vector<Eigen::Matrix2f> pixel_per_point_;  // every fourth pixel of every fourth row, unless wide_
  std::vector<View> views_;
  Beam beam_;                     // of the spotlight in the camera frame; dark without one
  FlickerNow flicker_;            // in the camera frame; none without flicker
  std::vector<Lamp> highlights_;  // what the varnish reflects of each lamp, in the camera frame; none without gloss
  std::vector<int> seen_;         // face at each pixel, -1 for none
  std::vector<float> scratch_;
  Rendering out_;
};

}  // namespace edged
