// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace edged {
namespace {

constexpr int kTextures = 6;
constexpr int kTextureSize = 1024;
const Eigen::Vector3d kHall(6.0, 6.0, 3.0);  // [m]

Eigen::Quaterniond random_rotation(Random& random) {
  const Eigen::Vector3d vector = random.normal3();
  return Eigen::Quaterniond(random.normal(), vector.x(), vector.y(), vector.z()).normalized();
}

/// The six faces of a cuboid of these half sizes, seen from outside, or from inside for a room.
struct Cuboid {
  SE3 T_W_O;
  Eigen::Vector3d half;
  bool inside = false;
};

void add_cuboid(Scene& scene, const Cuboid& cuboid, double light, Random& random) {
  const Eigen::Matrix3d R = cuboid.T_W_O.R();
  const std::size_t first = static_cast<std::size_t>(random.index(kTextures));
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    for (const double side : {-1.0, 1.0}) {
      Face face;
      face.normal_W = R.col(axis) * (cuboid.inside ? -side : side);
      face.u_W = R.col(next);
      face.v_W = face.u_W.cross(face.normal_W);
      face.centre_W = cuboid.T_W_O.translation() + side * cuboid.half[axis] * R.col(axis);
      face.half_u = cuboid.half[next];
      face.half_v = cuboid.half[last];
      face.texture = cuboid.inside ? scene.faces.size() % kTextures : first;
      face.texels_per_m = cuboid.inside ? 256.0F : 420.0F;
      face.offset_u = static_cast<float>(random.index(kTextureSize));
      face.offset_v = static_cast<float>(random.index(kTextureSize));
      face.brightness = static_cast<float>(light * random.uniform(0.6, 1.0));
      scene.faces.push_back(face);
    }
  }
}

bool keeps_clear(const Cuboid& cuboid, double clearance, std::span<const SE3> path_W_C) {
  const SE3 T_O_W = cuboid.T_W_O.inverse();
  return std::all_of(path_W_C.begin(), path_W_C.end(), [&](const SE3& T_W_C) {
    const Eigen::Vector3d p_O = T_O_W * T_W_C.translation();
    return (p_O.cwiseAbs() - cuboid.half).cwiseMax(0.0).norm() > clearance;
  });
}

/// The half of the room at -x, without a trace on it: its walls right before the room's own, all alike, so that not
/// even their edges are seen.
void paint_half(Scene& scene, const Cuboid& room, double light, Random random) {
  Cuboid half = room;
  half.half -= Eigen::Vector3d::Constant(1e-3);
  half.half.x() *= 0.5;
  half.T_W_O.translation().x() -= half.half.x();
  const std::size_t first = scene.faces.size();
  add_cuboid(scene, half, light, random);
  // Open to the rest of the room.
  const auto begin = scene.faces.begin() + static_cast<std::ptrdiff_t>(first);
  const auto open = [](const Face& face) { return face.normal_W.x() < -0.5; };
  scene.faces.erase(std::remove_if(begin, scene.faces.end(), open), scene.faces.end());
  for (std::size_t i = first; i < scene.faces.size(); ++i) {
    scene.faces[i].texture = scene.textures.size();
    scene.faces[i].brightness = static_cast<float>(0.8 * light);
  }
  scene.textures.emplace_back(cv::Mat(1, 1, CV_8UC1, cv::Scalar(180)));
}

/// Upright and 1 m ahead when the camera is at T_W_C, walking to its left, 0.65 m/s.
void add_person(Scene& scene, const SE3& T_W_C, double at_s, double light, Random random) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d left = up.cross(T_W_C.rotation() * Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R_W_P;
  R_W_P << left, up.cross(left), up;
  const Eigen::Vector3d velocity_W = 0.65 * left;
  const Eigen::Vector3d met_W = T_W_C.translation() + left.cross(up) - 0.35 * up;
  const std::size_t first = scene.faces.size();
  add_cuboid(scene, {SE3(Eigen::Quaterniond(R_W_P), met_W - at_s * velocity_W), {0.3, 0.15, 0.85}}, light, random);
  for (std::size_t i = first; i < scene.faces.size(); ++i) {
    Face& face = scene.faces[i];
    face.velocity_W = velocity_W;
    face.texture %= scene.textures.size();
    face.glows = true;  // where it comes from there may be no light
  }
}

void add_room(Scene& scene, const SceneConfig& config, std::span<const SE3> path_W_C, Random& random, bool half_blank) {
  Eigen::Vector3d low = path_W_C.front().translation(), high = low;
  for (const SE3& T_W_C : path_W_C) {
    low = low.cwiseMin(T_W_C.translation());
    high = high.cwiseMax(T_W_C.translation());
  }
  const Eigen::Vector3d margin(config.wall_m, config.wall_m, 0.75 * config.wall_m);
  low -= margin, high += margin;
  const Cuboid room{SE3(Eigen::Quaterniond::Identity(), 0.5 * (low + high)), 0.5 * (high - low), true};
  add_cuboid(scene, room, config.light, random);
  int placed = 0;
  // A room too full for another box keeps the ones it has.
  for (int tries = 0; placed < config.objects && tries < 200 * config.objects; ++tries) {
    Cuboid box;
    for (int i = 0; i < 3; ++i) box.half[i] = random.uniform(0.12, 0.4);
    Eigen::Vector3d p;
    for (int i = 0; i < 3; ++i) p[i] = random.uniform(low[i] + 0.3, high[i] - 0.3);
    const bool standing = random.uniform() < 0.6;
    if (standing) p.z() = low.z() + box.half.z();
    const double yaw = random.uniform(0.0, std::numbers::pi);
    const Eigen::Quaterniond tumbled = random_rotation(random);
    const Eigen::Quaterniond upright(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
    box.T_W_O = SE3(standing ? upright : tumbled, p);
    if (half_blank && p.x() - box.half.norm() < room.T_W_O.translation().x()) continue;
    if (!keeps_clear(box, config.clearance_m, path_W_C)) continue;
    add_cuboid(scene, box, config.light, random);
    ++placed;
  }
  if (half_blank) paint_half(scene, room, config.light, random);
}

/// A square on a wall that glows.
Face glowing_face(const Eigen::Vector3d& centre_W, const Eigen::Vector3d& normal_W, double half) {
  Face face;
  face.normal_W = normal_W;
  face.centre_W = centre_W;
  face.u_W = normal_W.unitOrthogonal();
  face.v_W = face.u_W.cross(normal_W);
  face.half_u = face.half_v = half;
  face.glows = true;
  return face;
}

/// The lamps and the window, as bright as they look.
void add_light_sources(Scene& scene) {
  for (std::size_t i = 0; i < scene.lighting->lamps.size(); ++i) {
    const Lamp& lamp = scene.lighting->lamps[i];
    Face face = glowing_face(lamp.centre_W, lamp.axis_W, 0.12);
    face.lamp = static_cast<int>(i);
    face.brightness = static_cast<float>(2.0 * lamp.power);
    scene.faces.push_back(face);
  }
  if (!scene.lighting->sun) return;
  const SunWindow& sun = *scene.lighting->sun;
  Face outside = glowing_face(sun.centre_W, -Eigen::Vector3d::UnitY(), 0.0);
  outside.centre_W -= 0.01 * Eigen::Vector3d::UnitY();
  outside.u_W = sun.u_W, outside.v_W = sun.u_W.cross(outside.normal_W);
  outside.half_u = sun.half_u, outside.half_v = sun.half_v;
  outside.brightness = static_cast<float>(0.5 * sun.power);
  scene.faces.push_back(outside);
}

void add_hall(Scene& scene, const SceneConfig& config, std::span<const SE3> path_W_C, Random& random) {
  const Cuboid hall{SE3(Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.5 * kHall.z()}), 0.5 * kHall, true};
  const double light = config.lighting == LightingKind::Even ? config.light : 1.0;
  add_cuboid(scene, hall, light, random);
  int placed = 0;
  for (int tries = 0; placed < config.objects && tries < 200 * config.objects; ++tries) {
    Cuboid box;
    box.half = {random.uniform(0.15, 0.4), random.uniform(0.15, 0.4), random.uniform(0.2, 0.9)};
    const double x = random.uniform(-0.46, 0.46) * kHall.x(), y = random.uniform(-0.46, 0.46) * kHall.y();
    const double yaw = random.uniform(0.0, std::numbers::pi);
    box.T_W_O = SE3(Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), {x, y, box.half.z()});
    if (!keeps_clear(box, config.clearance_m, path_W_C)) continue;
    add_cuboid(scene, box, light, random);
    ++placed;
  }
  // Poses are 20 ms apart.
  const double duration_s = 0.02 * static_cast<double>(path_W_C.size());
  scene.lighting = make_lighting(config.lighting, kHall, config.light, duration_s, random);
  if (scene.lighting) add_light_sources(scene);
}

void add_wall(Scene& scene, const SceneConfig& config, std::span<const SE3> path_W_C) {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero(), mean = Eigen::Vector3d::Zero();
  for (const SE3& T_W_C : path_W_C) {
    axis += T_W_C.rotation() * Eigen::Vector3d::UnitZ();
    mean += T_W_C.translation() / static_cast<double>(path_W_C.size());
  }
  axis.normalize();
  double nearest = -std::numeric_limits<double>::infinity();
  for (const SE3& T_W_C : path_W_C) nearest = std::max(nearest, axis.dot(T_W_C.translation() - mean));
  Face wall;
  wall.centre_W = mean + (nearest + config.poster_distance_m) * axis;
  wall.normal_W = -axis;
  wall.u_W = axis.unitOrthogonal();
  wall.v_W = wall.u_W.cross(wall.normal_W);
  wall.half_u = wall.half_v = 40.0;
  wall.brightness = static_cast<float>(config.light);
  scene.faces.push_back(wall);
}

}  // namespace

void SceneConfig::visit(ConfigFields& fields) {
  fields.choice(
      "kind", kind,
      {{"boxes", SceneKind::Boxes},
       {"poster", SceneKind::Poster},
       {"shapes", SceneKind::Shapes},
       {"hall", SceneKind::Hall}},
      {.effect =
           "a room with boxes, one rich wall, a white wall with dark shapes, or a furnished hall of 6 x 6 x 3 m"});
  fields.add("objects", objects, {"", 0, 200, "boxes in the room"});
  fields.add("clearance_m", clearance_m, {"m", 0.05, 10, "distance of the boxes from the camera's path"});
  fields.add("wall_m", wall_m,
             {"m", 0.2, 100, "distance of the room's walls from the camera's path; floor and ceiling 3/4"});
  fields.add("poster_distance_m", poster_distance_m,
             {"m", 0.1, 30, "distance of a single wall from the nearest camera"});
  fields.add("light", light, {"", 1e-4, 10, "1: a well lit room; 0.03: frames nearly black"});
  fields.choice("lighting", lighting,
                {{"even", LightingKind::Even},
                 {"lamps", LightingKind::Lamps},
                 {"switched", LightingKind::Switched},
                 {"sun", LightingKind::Sun}},
                {.effect = "of the hall: the same everywhere, panels at the ceiling, lamps on the walls that go on and "
                           "off, or the sun through a window"});
}

Scene make_scene(const SceneConfig& config, std::span<const SE3> path_W_C, std::uint64_t seed,
                 const Disturbance& disturbance, const SE3& T_W_C_meeting) {
  Random random(seed, 2);
  Scene scene;
  switch (config.kind) {
    case SceneKind::Boxes:
      for (int i = 0; i < kTextures; ++i) scene.textures.push_back(make_rich_texture(kTextureSize, random));
      add_room(scene, config, path_W_C, random, disturbance.kind == DisturbanceKind::BlankWall);
      break;
    case SceneKind::Hall:
      for (int i = 0; i < kTextures; ++i) scene.textures.push_back(make_plain_texture(kTextureSize, random));
      add_hall(scene, config, path_W_C, random);
      break;
    case SceneKind::Poster:
      scene.textures.push_back(make_rich_texture(2 * kTextureSize, random));
      add_wall(scene, config, path_W_C);
      break;
    case SceneKind::Shapes:
      scene.textures.push_back(make_shapes_texture(2 * kTextureSize, random));
      add_wall(scene, config, path_W_C);
      break;
  }
  if (disturbance.kind == DisturbanceKind::Person)
    add_person(scene, T_W_C_meeting, disturbance.middle_s(), config.light, Random(seed, 10));
  return scene;
}

}  // namespace edged
