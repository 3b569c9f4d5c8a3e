// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/scene/scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "edged/sim/scene/corridor_scene.hpp"
#include "edged/sim/scene/target_scene.hpp"

namespace edged {
namespace {

constexpr int kTextures = 6;
constexpr int kTextureSize = 1024;           // of the walls: 4 m
const Eigen::Vector3d kHall(6.0, 6.0, 3.0);  // [m]

Eigen::Quaterniond random_rotation(Random& random) {
  const Eigen::Vector3d vector = random.normal3();
  return Eigen::Quaterniond(random.normal(), vector.x(), vector.y(), vector.z()).normalized();
}

/// The six faces of a cuboid of these half sizes, visible from outside, or from inside for a room.
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

/// Adds moved copies of the faces from `first` on.
void add_moved(Scene& scene, std::size_t first, const Eigen::Vector3d& by_W) {
  for (std::size_t i = first, end = scene.faces.size(); i < end; ++i) {
    scene.faces.push_back(Face(scene.faces[i]));
    scene.faces.back().centre_W += by_W;
  }
}

bool keeps_clear(const Cuboid& cuboid, double clearance, std::span<const SE3> path_W_C) {
  const SE3 T_O_W = cuboid.T_W_O.inverse();
  return std::all_of(path_W_C.begin(), path_W_C.end(), [&](const SE3& T_W_C) {
    const Eigen::Vector3d p_O = T_O_W * T_W_C.translation();
    return (p_O.cwiseAbs() - cuboid.half).cwiseMax(0.0).norm() > clearance;
  });
}

/// The blank half of the room at -x: uniform walls directly in front of the walls of the room, whose edges are hidden,
/// too.
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

/// Attaches the faces from `first` on to the newest dynamic_object. They have their own light, as their initial
/// position may have no light map.
void set_moving(Scene& scene, std::size_t first) {
  for (std::size_t i = first; i < scene.faces.size(); ++i) {
    Face& face = scene.faces[i];
    face.dynamic_object = static_cast<int>(scene.dynamic_objects.size()) - 1;
    face.texture %= scene.textures.size();
    face.glows = true;
  }
}

/// A person 1 m in front of a camera at T_W_C, who walks to its left at 0.65 m/s.
void add_person(Scene& scene, const SE3& T_W_C, double at_s, double light, Random random) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d left = up.cross(T_W_C.rotation() * Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R_W_P;
  R_W_P << left, up.cross(left), up;
  scene.dynamic_objects.push_back({.velocity_W = 0.65 * left});
  const Eigen::Vector3d met_by_s = at_s * scene.dynamic_objects.back().velocity_W;
  const Eigen::Vector3d met_W = T_W_C.translation() + left.cross(up) - 0.35 * up;
  const std::size_t first = scene.faces.size();
  add_cuboid(scene, {SE3(Eigen::Quaterniond(R_W_P), met_W - met_by_s), {0.3, 0.15, 0.85}}, light, random);
  set_moving(scene, first);
}

/// Mean position and axis of a camera.
struct Outlook {
  Eigen::Vector3d mean_W = Eigen::Vector3d::Zero(), left_W;
  Eigen::Vector3d ahead_W = Eigen::Vector3d::Zero();  // level
  double slope = 0.0;                                 // of its axis, upwards
  double foremost_m = 0.0;                            // largest displacement ahead of the mean position
};

Outlook outlook(std::span<const SE3> path_W_C) {
  Outlook out;
  for (const SE3& T_W_C : path_W_C) {
    out.mean_W += T_W_C.translation() / static_cast<double>(path_W_C.size());
    out.ahead_W += T_W_C.rotation() * Eigen::Vector3d::UnitZ();
  }
  out.slope = out.ahead_W.z() / out.ahead_W.head<2>().norm();
  out.ahead_W.z() = 0.0;
  out.ahead_W.normalize();
  out.left_W = Eigen::Vector3d::UnitZ().cross(out.ahead_W);
  for (const SE3& T_W_C : path_W_C)
    out.foremost_m = std::max(out.foremost_m, out.ahead_W.dot(T_W_C.translation() - out.mean_W));
  return out;
}

/// Head, trunk of the given width, and two moving legs.
void add_walker(Scene& scene, const SE3& T_W_P, double breadth_m, const DynamicObject& walk, double light,
                Random& random) {
  struct Part {
    double z, half_breadth, half_height, stride_m;
  };
  constexpr double kStep_rad_s = 2.0 * std::numbers::pi * 0.9;
  const double half = 0.5 * breadth_m;
  for (const Part& part : {Part{0.0, std::clamp(half, 0.07, 0.11), 0.13, 0.0}, Part{-0.45, half, 0.32, 0.0},
                           Part{-1.19, 0.4 * half, 0.42, 0.2}, Part{-1.19, 0.4 * half, 0.42, -0.2}}) {
    DynamicObject dynamic_object = walk;
    if (part.stride_m != 0.0)
      dynamic_object.swings.push_back({part.stride_m * T_W_P.R().col(0), kStep_rad_s, walk.swings[0].phase});
    scene.dynamic_objects.push_back(dynamic_object);
    const std::size_t first = scene.faces.size();
    const SE3 T_W_part(T_W_P.rotation(), T_W_P * Eigen::Vector3d(0.0, 0.0, part.z));
    add_cuboid(scene, {T_W_part, {part.half_breadth, 0.06, part.half_height}}, light, random);
    set_moving(scene, first);
    // Clothes: coarser than the walls, and lighter or darker.
    const float brightness = static_cast<float>(light * random.uniform(0.3, 1.3));
    for (std::size_t i = first; i < scene.faces.size(); ++i)
      scene.faces[i].texels_per_m = 180.0F, scene.faces[i].brightness = brightness;
  }
}

/// Two people who cross the view again and again, one behind the other, from the moment the disturbance begins.
/// With both in view, they cover a share of the view of about the strength of the disturbance.
void add_walkers(Scene& scene, std::span<const SE3> path_W_C, const Disturbance& disturbance, double light,
                 Random random) {
  constexpr double kClearance_m = 0.9, kBehind_m = 0.35, kReach_m = 1.1, kAway_m_s = 2.0;
  constexpr double kViewPerDepth = 1.2;    // width of the view of a common camera at 1 m
  constexpr double kHeightCovered = 0.85;  // by a person in front of the camera
  const Outlook view = outlook(path_W_C);
  Eigen::Matrix3d R_W_P;
  R_W_P << view.left_W, -view.ahead_W, Eigen::Vector3d::UnitZ();
  for (int i = 0; i < 2; ++i) {
    const double depth = view.foremost_m + kClearance_m + i * kBehind_m;
    const double omega = 2.0 * std::numbers::pi / random.uniform(4.2, 5.6);
    // They move towards each other, so that the middle of the view is rarely empty.
    const double phase = (i == 0 ? 0.0 : std::numbers::pi) + random.uniform(-0.4, 0.4) - omega * disturbance.at_s;
    const DynamicObject walk{.swings = {{kReach_m * view.left_W, omega, phase}},
                             .from_s = disturbance.at_s,
                             .to_s = disturbance.end_s(),
                             .away_W = (i == 0 ? -kAway_m_s : kAway_m_s) * view.left_W};
    const Eigen::Vector3d head_W =
        view.mean_W + depth * view.ahead_W + (0.45 + view.slope * depth) * Eigen::Vector3d::UnitZ();
    add_walker(scene, SE3(Eigen::Quaterniond(R_W_P), head_W),
               0.5 * disturbance.strength / kHeightCovered * kViewPerDepth * depth, walk, light, random);
  }
}

/// A spotlight beside the mean position of the camera, along its mean axis.
/// unit: radiance that corresponds to light 1 of the faces.
Spotlight make_spotlight(std::span<const SE3> path_W_C, const Disturbance& disturbance, double unit, Random random) {
  const Outlook view = outlook(path_W_C);
  Spotlight spot;
  spot.centre_W = view.mean_W + 0.7 * view.left_W + 0.4 * Eigen::Vector3d::UnitZ();
  spot.axis_W = (view.mean_W + 1.8 * view.ahead_W - spot.centre_W).normalized();
  spot.power = disturbance.strength / unit;
  spot.begin_s = disturbance.at_s, spot.end_s = disturbance.end_s();
  spot.phase_yaw = random.uniform(-0.5, 0.5), spot.phase_pitch = random.uniform(0.0, 2.0 * std::numbers::pi);
  if (disturbance.kind == DisturbanceKind::SwitchingLamp)
    for (double t = spot.begin_s; t < spot.end_s; t += random.uniform(0.25, 1.2)) spot.switch_s.push_back(t);
  return spot;
}

/// Where the one lamp hangs that flickers: before the camera, left above the middle of its view.
Eigen::Vector3d lamp_place(std::span<const SE3> path_W_C) {
  const Outlook view = outlook(path_W_C);
  return view.mean_W + 1.2 * view.ahead_W + 0.4 * view.left_W + 0.4 * Eigen::Vector3d::UnitZ();
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
  const bool twins = config.twin_m > 0.0;
  const Eigen::Vector3d to_twin = config.twin_m * Eigen::Vector3d::UnitX();
  int placed = 0;
  // If there is no space for another box, no further ones are added.
  for (int tries = 0; placed < config.objects && tries < 200 * config.objects; ++tries) {
    Cuboid box;
    for (int i = 0; i < 3; ++i) box.half[i] = random.uniform(0.12, 0.4);
    Eigen::Vector3d p;
    for (int i = 0; i < 3; ++i) p[i] = random.uniform(low[i] + 0.3, high[i] - 0.3 - to_twin[i]);
    const bool standing = random.uniform() < 0.6;
    if (standing) p.z() = low.z() + box.half.z();
    const double yaw = random.uniform(0.0, std::numbers::pi);
    const Eigen::Quaterniond tumbled = random_rotation(random);
    const Eigen::Quaterniond upright(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
    box.T_W_O = SE3(standing ? upright : tumbled, p);
    if (half_blank && p.x() - box.half.norm() < room.T_W_O.translation().x()) continue;
    if (!keeps_clear(box, config.clearance_m, path_W_C)) continue;
    const Cuboid twin{SE3(box.T_W_O.rotation(), p + to_twin), box.half};
    if (twins && !keeps_clear(twin, config.clearance_m, path_W_C)) continue;
    const std::size_t first = scene.faces.size();
    add_cuboid(scene, box, config.light, random);
    if (twins) add_moved(scene, first, to_twin);
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

/// The visible lamps and window.
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
  if (!scene.lighting) return;
  scene.lighting->gloss = config.gloss;
  add_light_sources(scene);
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
       {"hall", SceneKind::Hall},
       {"corridors", SceneKind::Corridors},
       {"target", SceneKind::Target}},
      {.effect = "a room with boxes, one rich wall, a white wall with dark shapes, a furnished hall of 6 x 6 x 3 m, "
                 "corridors along the path, or a calibration target before a wall"});
  fields.add("objects", objects, {"", 0, 200, "boxes in the room"});
  fields.add("twin_m", twin_m,
             {"m", 0, 100, "boxes once more this far along x; 4, as the walls repeat: two equal rooms; 0: none"});
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
  fields.add(
      "gloss", gloss,
      {"", 0, 1, "of the hall: share of the light of its lamps that surfaces reflect like varnish; 0.04: varnish"});
  fields.group("target", target);
}

Scene make_scene(const SceneConfig& config, std::span<const SE3> path_W_C, std::uint64_t seed,
                 const Disturbance& disturbance, const SE3& T_W_C_meeting, const FlickerConfig& flicker) {
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
    case SceneKind::Corridors:
      for (int i = 0; i < kTextures; ++i) scene.textures.push_back(make_rich_texture(kTextureSize, random));
      add_corridors(scene, config, path_W_C, random);
      break;
    case SceneKind::Poster:
      scene.textures.push_back(make_rich_texture(2 * kTextureSize, random));
      add_wall(scene, config, path_W_C);
      break;
    case SceneKind::Shapes:
      scene.textures.push_back(make_shapes_texture(2 * kTextureSize, random));
      add_wall(scene, config, path_W_C);
      break;
    case SceneKind::Target:
      scene.textures.push_back(make_plain_texture(kTextureSize, random));
      add_target(scene, config);
      break;
  }
  if (disturbance.kind == DisturbanceKind::Person)
    add_person(scene, T_W_C_meeting, disturbance.middle_s(), config.light, Random(seed, 10));
  if (disturbance.kind == DisturbanceKind::Walkers)
    add_walkers(scene, path_W_C, disturbance, config.light, Random(seed, 11));
  if (disturbance.kind == DisturbanceKind::WanderingLamp || disturbance.kind == DisturbanceKind::SwitchingLamp)
    scene.spotlight = make_spotlight(path_W_C, disturbance, scene.lighting ? 1.0 : config.light, Random(seed, 12));
  if (disturbance.kind == DisturbanceKind::Flicker) scene.flicker = Flicker(flicker, disturbance, lamp_place(path_W_C));
  return scene;
}

}  // namespace edged
