// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/sensors/renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace edged {
namespace {

constexpr float kBackground = 0.5F;

/// The lamps with the power that varnish reflects, in the camera frame.
std::vector<Lamp> highlights_at(const Lighting& lighting, const SE3& T_C_W, double t_s) {
  if (lighting.gloss == 0.0) return {};
  std::vector<Lamp> highlights = lighting.lamps;
  for (Lamp& lamp : highlights) {
    lamp.power *= lighting.gloss * lamp_level(lamp, t_s);
    lamp.centre_W = T_C_W * lamp.centre_W;
    lamp.axis_W = T_C_W.rotation() * lamp.axis_W;
  }
  return highlights;
}

/// A pixel sees a face where five linear forms of its bearing are positive: inverse depth, and the distances from
/// the four sides. Bearings of a wide lens are unit vectors: the margin `least` is far beyond rounding errors.
struct Condition {
  Eigen::Vector3f form;
  float least;
};
using Conditions = std::array<Condition, 5>;

Conditions conditions_of(const FaceView& view) {
  const auto condition = [](const Eigen::Vector3f& form, float length) { return Condition{form, -1e-5F * length}; };
  const Eigen::Vector3f &a = view.inverse_depth, edge_u = view.half_u * a, edge_v = view.half_v * a;
  const float length_u = edge_u.norm() + view.u.norm(), length_v = edge_v.norm() + view.v.norm();
  return {condition(a, a.norm()), condition(edge_u - view.u, length_u), condition(edge_u + view.u, length_u),
          condition(edge_v - view.v, length_v), condition(edge_v + view.v, length_v)};
}

/// Whether any pixel of the block may see the face.
bool may_see(const PixelBlock& block, const Conditions& conditions) {
  const Eigen::Array3f low = block.bearings.min(), high = block.bearings.max();
  return std::ranges::all_of(conditions, [&](const Condition& each) {
    return (each.form.array() * low).max(each.form.array() * high).sum() > each.least;
  });
}

}  // namespace

Renderer::Renderer(const CameraModel& camera, Scene scene, const LensResidual& residual, double flare)
    : rays_(camera, residual),
      scene_(std::move(scene)),
      flare_(static_cast<float>(flare)),
      light_(scene_),
      views_(scene_.faces.size()),
      seen_(rays_.count()),
      scratch_(rays_.count()) {
  out_.radiance.resize(rays_.count()), out_.inverse_depth.resize(rays_.count());
}

const Rendering& Renderer::render(const SE3& T_W_C, double t_s) {
  light_.update(t_s);
  std::fill(seen_.begin(), seen_.end(), -1);
  std::fill(out_.inverse_depth.begin(), out_.inverse_depth.end(), 0.0F);
  const SE3 T_C_W = T_W_C.inverse();
  const Eigen::Matrix3d R_C_W = T_C_W.R();
  if (scene_.spotlight) {
    now_.beam = beam_at(*scene_.spotlight, t_s);
    now_.beam.centre = T_C_W * now_.beam.centre;
    now_.beam.axis = R_C_W * now_.beam.axis;
  }
  if (scene_.flicker) now_.flicker = scene_.flicker->at(t_s, T_C_W);
  if (scene_.lighting) now_.highlights = highlights_at(*scene_.lighting, T_C_W, t_s);
  for (std::size_t i = 0; i < scene_.faces.size(); ++i) {
    Face face = scene_.faces[i];
    Eigen::Vector3d velocity_W = Eigen::Vector3d::Zero();
    if (face.dynamic_object >= 0) {
      const DynamicObject& dynamic_object = scene_.dynamic_objects[static_cast<std::size_t>(face.dynamic_object)];
      face.centre_W += dynamic_object.displacement(t_s);
      velocity_W = dynamic_object.velocity(t_s);
    }
    const double distance = face.normal_W.dot(T_W_C.translation() - face.centre_W);
    if (distance <= 1e-6) continue;
    const PixelBox box = rays_.bounds(face, T_C_W);
    if (box.x_1 < box.x_0 || box.y_1 < box.y_0) continue;
    const Eigen::Vector3d c_C = T_C_W * face.centre_W;
    const Eigen::Vector3d a = R_C_W * face.normal_W / -distance;  // 1/z = n.b / n.c
    const Eigen::Vector3d u_C = R_C_W * face.u_W, v_C = R_C_W * face.v_W;
    views_[i] = {a.cast<float>(),
                 (u_C - u_C.dot(c_C) * a).cast<float>(),
                 (v_C - v_C.dot(c_C) * a).cast<float>(),
                 (R_C_W * velocity_W).cast<float>(),
                 (R_C_W * face.normal_W).cast<float>(),
                 static_cast<float>(face.half_u),
                 static_cast<float>(face.half_v),
                 static_cast<float>(distance)};
    if (!rays_.wide) {
      cast(views_[i], box, static_cast<int>(i));
      continue;
    }
    const Conditions conditions = conditions_of(views_[i]);
    for (const PixelBlock& block : rays_.blocks)
      if (may_see(block, conditions)) cast(views_[i], block.pixels, static_cast<int>(i));
  }
  shade();
  if (flare_ > 0.0F) flare();
  blur();
  return out_;
}

void Renderer::cast(const FaceView& view, PixelBox box, int index) {
  const Eigen::Vector3f a = view.inverse_depth, u = view.u, v = view.v;
  const float half_u = view.half_u, half_v = view.half_v;
  for (int y = box.y_0; y <= box.y_1; ++y) {
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * rays_.width;
    const float *bx = rays_.x.data() + row, *by = rays_.y.data() + row, *bz = rays_.z.data() + row;
    float* nearest = out_.inverse_depth.data() + row;
    int* seen = seen_.data() + row;
    for (int x = box.x_0; x <= box.x_1; ++x) {
      const float w = a.x() * bx[x] + a.y() * by[x] + a.z() * bz[x];
      const float uw = u.x() * bx[x] + u.y() * by[x] + u.z() * bz[x];
      const float vw = v.x() * bx[x] + v.y() * by[x] + v.z() * bz[x];
      // Read in any case: else the compiler makes branches, and takes one pixel at a time.
      const float nearest_before = nearest[x];
      const int seen_before = seen[x];
      const bool hit = (w > nearest_before) & (std::abs(uw) <= half_u * w) & (std::abs(vw) <= half_v * w);
      nearest[x] = hit ? w : nearest_before;
      seen[x] = hit ? index : seen_before;
    }
  }
}

void Renderer::shade() {
  // By runs of pixels of one face within a row, as their arithmetic is then the same.
  for (int y = 0; y < rays_.height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(rays_.width);
    const std::size_t end = row + static_cast<std::size_t>(rays_.width);
    for (std::size_t first = row, next = first; first < end; first = next) {
      while (next < end && next - first < kMostPixels && seen_[next] == seen_[first]) ++next;
      if (seen_[first] < 0) {
        std::fill(scratch_.begin() + first, scratch_.begin() + next, kBackground);
      } else {
        shade_run(static_cast<std::size_t>(seen_[first]), first, next - first);
      }
    }
  }
}

void Renderer::shade_run(std::size_t index, std::size_t first, std::size_t n) {
  const Face& face = scene_.faces[index];
  const FaceView& view = views_[index];
  const auto pixels = [&](const std::vector<float>& image) {
    return Eigen::Map<const Eigen::ArrayXf>(image.data() + first, static_cast<Eigen::Index>(n));
  };
  const auto bx = pixels(rays_.x), by = pixels(rays_.y), bz = pixels(rays_.z);
  const PixelValues z = 1.0F / pixels(out_.inverse_depth);
  // Area of a pixel on the surface: (z / f)^2 over the cosine of incidence, which is distance / (z |b|); z is the
  // distance where b is a unit vector.
  const PixelValues pitch = face.texels_per_m * z / rays_.focal;
  const PixelValues area = pitch * pitch * pixels(rays_.norm) * z / view.distance;
  const PixelValues u = (view.u.x() * bx + (view.u.y() * by + view.u.z() * bz)) * z;
  const PixelValues v = (view.v.x() * bx + (view.v.y() * by + view.v.z() * bz)) * z;
  PixelValues light = light_.at(index, u, v);
  const auto point = [&](Eigen::Index i) { return Eigen::Vector3f(z[i] * bx[i], z[i] * by[i], z[i] * bz[i]); };
  if (now_.beam.power > 0.0 && !face.glows)
    for (Eigen::Index i = 0; i < light.size(); ++i) light[i] += beam_light(now_.beam, point(i), view.normal);
  if (now_.flicker.deviation != 0.0F)
    for (Eigen::Index i = 0; i < light.size(); ++i) light[i] *= now_.flicker.factor(point(i));
  const PixelValues texel_u = u * face.texels_per_m + face.offset_u, texel_v = v * face.texels_per_m + face.offset_v;
  Eigen::Map<Eigen::ArrayXf> radiance(scratch_.data() + first, light.size());
  radiance = face.brightness * light * scene_.textures[face.texture].sample(texel_u, texel_v, area);
  if (!now_.highlights.empty() && !face.glows)
    for (Eigen::Index i = 0; i < light.size(); ++i) radiance[i] += highlight(point(i), view.normal);
}

float Renderer::highlight(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) const {
  double sum = 0.0;
  for (const Lamp& lamp : now_.highlights) sum += lamp_highlight(lamp, p.cast<double>(), normal.cast<double>());
  return static_cast<float>(sum);
}

void Renderer::flare() {
  const std::size_t n = seen_.size();
  std::vector<float> glow(n, 0.0F);
  for (std::size_t i = 0; i < n; ++i)
    if (seen_[i] >= 0 && scene_.faces[static_cast<std::size_t>(seen_[i])].glows) glow[i] = scratch_[i];
  const float veil = std::accumulate(glow.begin(), glow.end(), 0.0F) / static_cast<float>(n);
  for (std::size_t i = 0; i < n; ++i) scratch_[i] += flare_ * (veil + glow[n - 1 - i]);
}

float Renderer::squared_beam_speed(const Eigen::Vector3f& bearing, float inverse_depth) const {
  if (now_.beam.rate == 0.0 || inverse_depth == 0.0F) return 0.0F;
  const float from_lamp = (bearing / inverse_depth - now_.beam.centre.cast<float>()).norm();
  const float speed = static_cast<float>(now_.beam.rate) * from_lamp * inverse_depth * rays_.focal;
  return speed * speed;
}

void Renderer::blur() {
  // Blur of the lens and the size of a pixel: standard deviation sqrt(0.4) = 0.63 px.
  constexpr float kSide = 0.2F, kMiddle = 0.6F;
  std::vector<float>& out = out_.radiance;
  const std::size_t w = static_cast<std::size_t>(rays_.width), h = static_cast<std::size_t>(rays_.height);
  for (std::size_t y = 0; y < h; ++y) {
    const float* above = scratch_.data() + w * (y > 0 ? y - 1 : 0);
    const float* here = scratch_.data() + w * y;
    const float* below = scratch_.data() + w * std::min(y + 1, h - 1);
    float* row = out.data() + w * y;
    for (std::size_t x = 0; x < w; ++x) row[x] = kMiddle * here[x] + kSide * (above[x] + below[x]);
  }
  for (std::size_t y = 0; y < h; ++y) {
    float* row = out.data() + w * y;
    float* copy = scratch_.data() + w * y;
    std::copy(row, row + w, copy);
    for (std::size_t x = 1; x + 1 < w; ++x) row[x] = kMiddle * copy[x] + kSide * (copy[x - 1] + copy[x + 1]);
  }
}

double Renderer::max_image_speed(const Eigen::Vector3d& v_C, const Eigen::Vector3d& omega_C) const {
  const Eigen::Vector3f v = v_C.cast<float>(), omega = omega_C.cast<float>();
  float fastest = 0.0F;
  std::size_t k = 0;
  for (int y = 0; y < rays_.height; y += PixelRays::kMotionStride) {
    for (int x = 0; x < rays_.width; x += PixelRays::kMotionStride) {
      const std::size_t i = static_cast<std::size_t>(y * rays_.width + x);
      const Eigen::Vector3f b = rays_.bearing(i);
      const Eigen::Vector3f own = seen_[i] < 0 ? -v : (views_[static_cast<std::size_t>(seen_[i])].velocity - v).eval();
      const Eigen::Vector3f moved = own * out_.inverse_depth[i] - omega.cross(b);  // velocity of the point / depth
      if (rays_.wide) {
        fastest = std::max(fastest, rays_.focal * rays_.focal * b.cross(moved).squaredNorm());
      } else {
        const Eigen::Vector2f slide = moved.head<2>() - b.head<2>() * moved.z();
        fastest = std::max(fastest, (rays_.per_point[k++] * slide).squaredNorm());
      }
      fastest = std::max(fastest, squared_beam_speed(b, out_.inverse_depth[i]));
    }
  }
  return std::sqrt(static_cast<double>(fastest));
}

}  // namespace edged
