// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Ray casting of a scene into a camera with distortion, and the speed of the image.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "edged/sim/scene/light_field.hpp"
#include "edged/sim/scene/scene.hpp"
#include "edged/sim/sensors/pixel_rays.hpp"

namespace edged {

/// A picture, row by row.
struct Rendering {
  std::vector<float> radiance;  ///< linear, 1 is a white spot in good light
  /// 1 / z-depth [1/m], or 1 / distance for a lens with a view_limit; 0 without a surface
  std::vector<float> inverse_depth;
};

/// A face in the camera frame as three linear forms of the bearing b (pixel_to_ray): inverse depth w = a.b and plane
/// coordinates times w. Visibility needs no division.
struct FaceView {
  Eigen::Vector3f inverse_depth, u, v;
  Eigen::Vector3f velocity;  ///< [m/s]
  Eigen::Vector3f normal;
  float half_u, half_v;
  float distance;  ///< from the camera to the plane [m]
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

  int width() const { return rays_.width; }
  int height() const { return rays_.height; }

 private:
  /// What lights the scene beside its light maps, in the camera frame.
  struct LightNow {
    Beam beam;                     ///< beam of the spotlight; dark without one
    FlickerNow flicker;            ///< none without flicker
    std::vector<Lamp> highlights;  ///< what the varnish reflects of each lamp; none without gloss
  };

  void cast(const FaceView& view, PixelBox box, int index);
  void shade();
  /// n pixels from `first` on, all of which see the face `index`.
  void shade_run(std::size_t index, std::size_t first, std::size_t n);
  /// Light of the lamps that the surface at p reflects like a mirror.
  float highlight(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) const;
  void flare();
  /// Largest squared speed of the edge of the light [px^2/s^2].
  float squared_beam_speed(const Eigen::Vector3f& bearing, float inverse_depth) const;
  void blur();

  PixelRays rays_;
  Scene scene_;
  float flare_;
  LightField light_;
  LightNow now_;
  std::vector<FaceView> views_;
  std::vector<int> seen_;  // face at each pixel, -1 for none
  std::vector<float> scratch_;
  Rendering out_;
};

}  // namespace edged
