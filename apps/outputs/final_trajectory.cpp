// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "outputs/final_trajectory.hpp"

#include <spdlog/fmt/fmt.h>

#include "common/files.hpp"
#include "edged/io/parse/trajectory_io.hpp"
#include "report/point_cloud.hpp"
#include "run/run_context.hpp"

namespace edged {
namespace {

std::string keyframes_csv(const std::vector<MappedKeyframe>& keyframes) {
  std::string text =
      "# keyframes of the map as estimated at the end: the body (IMU) in the world (z up), stamps on the IMU clock\n"
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

class FinalTrajectoryFiles : public RunObserver {
 public:
  explicit FinalTrajectoryFiles(const RunContext& run) : run_(run) {}
  void on_summary(RunEnd& end) override {
    const FinalTrajectory& known = end.final_trajectory;
    Figures& figures = end.summary.outputs;
    figures.json["final_cost"] = {{"before", known.initial_cost}, {"after", known.final_cost}};
    if (known.initial_cost > 0.0)
      figures.line("final trajectory", fmt::format("{:.4g}", known.final_cost),
                   fmt::format("cost of all measurements, {:.4g} before the joint optimization", known.initial_cost));
  }
  void on_end(const RunEnd& end) override {
    const OutputFrame frame = run_.estimated_frame();
    write_final_trajectory(run_.folder, frame, end.final_trajectory,
                           run_.heading(frame, "final: by all measurements together, not causal"));
  }

 private:
  const RunContext& run_;
};

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
  const std::vector<std::string> comments = {
      "points of the map in the world (z up) [m], as estimated at the end",
      "keyframe: row of keyframes.csv; tried, found: images in which the point was searched for, found"};
  return ply_header(
             false, comments, count,
             "float x, float y, float z, uchar red, uchar green, uchar blue, int keyframe, int tried, int found") +
         vertices;
}

void write_final_trajectory(const std::filesystem::path& folder, const OutputFrame& frame, const FinalTrajectory& known,
                            const std::vector<std::string>& comments) {
  write_tum(folder / "trajectory_final.tum", frame(known.poses), comments);
  write_file(folder / "keyframes.csv", keyframes_csv(known.keyframes));
  write_file(folder / "map.ply", map_ply(known.keyframes));
}

RunOutput final_trajectory_output() {
  return always<FinalTrajectoryFiles>({"trajectory_final.tum", "keyframes.csv", "map.ply"});
}

}  // namespace edged
