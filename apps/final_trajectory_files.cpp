// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "final_trajectory_files.hpp"

#include <spdlog/fmt/fmt.h>

#include <array>

#include "edged/io/text.hpp"
#include "edged/io/trajectory_io.hpp"
#include "run_folder.hpp"

namespace edged {
namespace {

std::string keyframes_csv(const std::vector<MappedKeyframe>& keyframes) {
  std::string text =
      "# keyframes of the map as known in the end: the body (IMU) in the world (z up), stamps on the IMU clock\n"
      "t_ns,px_m,py_m,pz_m,qx,qy,qz,qw,camera,points,times_found,found_at_ns\n";
  for (const MappedKeyframe& keyframe : keyframes) {
    const Eigen::Vector3d& p = keyframe.T_W_B.translation();
    const Eigen::Quaterniond& q = keyframe.T_W_B.rotation();
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", to_ns(keyframe.t), p.x(), p.y(), p.z(), q.x(), q.y(),
                        q.z(), q.w(), keyframe.camera, keyframe.points.size(), keyframe.times_found,
                        to_ns(keyframe.found_at));
  }
  return text;
}

}  // namespace

std::string map_ply(const std::vector<MappedKeyframe>& keyframes) {
  std::size_t count = 0;
  std::string vertices;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    for (const MappedKeyframe::Point& point : keyframes[k].points) {
      if (!point.p_W.allFinite()) continue;
      vertices += fmt::format("{:.5f} {:.5f} {:.5f} {} {} {} {} {} {}\n", point.p_W.x(), point.p_W.y(), point.p_W.z(),
                              point.grey, point.grey, point.grey, k, point.tried, point.found);
      ++count;
    }
  }
  return fmt::format(
             "ply\nformat ascii 1.0\ncomment points of the map in the world (z up) [m], as known in the end\n"
             "comment keyframe: row of keyframes.csv; tried, found: images in which the point was looked for, found\n"
             "element vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
             "property uchar green\nproperty uchar blue\nproperty int keyframe\nproperty int tried\n"
             "property int found\nend_header\n",
             count) +
         vertices;
}

void write_final_trajectory(const std::filesystem::path& folder, const OutputFrame& frame, const FinalTrajectory& known,
                            const std::vector<std::string>& comments) {
  TrajectoryWriter tum(folder / "trajectory_final.tum", TrajectoryFormat::Tum, comments);
  for (const StampedPose& pose : known.poses) tum.add(frame(pose));
  tum.flush();
  write_file(folder / "keyframes.csv", keyframes_csv(known.keyframes));
  write_file(folder / "map.ply", map_ply(known.keyframes));
}

std::vector<MappedKeyframe> read_keyframes(const std::filesystem::path& folder) {
  std::vector<MappedKeyframe> keyframes;
  if (!std::filesystem::exists(folder / "keyframes.csv")) return keyframes;
  LineReader lines(folder / "keyframes.csv");
  while (const auto line = lines.next()) {
    FieldReader fields(line->text);
    const auto t = parse_nanoseconds(fields.next());
    if (!t) continue;  // the heading
    std::array<double, 7> v;
    for (double& number : v) number = parse_number(fields.next()).value_or(0.0);
    MappedKeyframe& keyframe = keyframes.emplace_back();
    keyframe.t = *t;
    keyframe.T_W_B = SE3(Eigen::Quaterniond(v.data() + 3), Eigen::Vector3d(v.data()));
    keyframe.camera = fields.next();
    fields.next();  // how many points it has
    keyframe.times_found = static_cast<int>(parse_number(fields.next()).value_or(0.0));
  }
  return keyframes;
}

}  // namespace edged
