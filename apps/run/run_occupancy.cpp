// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// --occupancy of `edged run`: a folder with an occupancy map for planners.
#include "run/run_occupancy.hpp"

#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>

#include "common/files.hpp"
#include "edged/camera/undistort.hpp"
#include "edged/core/check.hpp"
#include "edged/occupancy/occupancy_worker.hpp"
#include "run/occupancy.hpp"
#include "run/run_observer.hpp"

namespace edged {
namespace {

constexpr double kShowPeriod_s = 5.0;

/// Observations at keyframes are kept until the final poses are known: 40 bytes each, about 2 MB a minute.
class RunOccupancy : public RunObserver {
 public:
  explicit RunOccupancy(RunContext& run) : run_(run), options_(run.options.occupancy) {
    if (!run.options.force) check_empty(options_.folder, "--occupancy");
    if (!options_.heights_m.empty() && options_.heights_m[0] >= options_.heights_m[1])
      throw InputError::format("--occupancy-heights {} {}: the second must be above the first", options_.heights_m[0],
                               options_.heights_m[1]);
    for (const RigCamera& camera : run.used.cameras)
      model_.cameras.push_back({camera.name, ideal_pinhole(camera.model), camera.modality});
    make_picture_folder(options_.folder);
    if (!run.options.serve.empty())
      so_far_ = std::make_unique<OccupancyWorker>(options_.voxel_m, kShowPeriod_s, [&run](const OccupancyMap& map) {
        run.live_points.set_voxels(occupied_voxels(map.tree), map.tree.getResolution());
      });
  }

  void on_step(const Step& step) override {
    if (so_far_) so_far_->add(step.marginalized_keyframes);
    if (is_tracking(step.status) && step.keyframe) add_images(model_, step);
  }

  void on_end(const RunEnd& end) override {
    place(model_, end.known.poses, run_.odometry.rig());
    triangulate(model_);
    const octomap::OcTree tree = occupancy_of(model_, options_.voxel_m, run_.dense);
    if (tree.size() == 0)
      throw InputError::format(
          "--occupancy {}: the depth of no feature is known; record for longer, and move sideways to the scene",
          options_.folder.string());
    if (so_far_) {
      so_far_.reset();  // what it has not mapped yet is in the final map
      run_.live_points.set_voxels(occupied_voxels(tree), tree.getResolution());
    }
    write_file(run_.folder / "voxels.ply", voxels_ply(tree));  // for the report
    write_occupancy(options_.folder, tree, heights(end.known.poses));
  }

 private:
  /// The chosen ones, or those of the path of the body.
  HeightRange heights(const Trajectory& poses) const {
    if (!options_.heights_m.empty()) return {options_.heights_m[0], options_.heights_m[1]};
    const auto [low, high] =
        std::ranges::minmax(poses, {}, [](const StampedPose& pose) { return pose.T.translation().z(); });
    return {low.T.translation().z() - options_.voxel_m, high.T.translation().z() + options_.voxel_m};
  }

  RunContext& run_;
  const OccupancyOptions& options_;
  Reconstruction model_;
  std::unique_ptr<OccupancyWorker> so_far_;  ///< for the live page
};

}  // namespace

void add_occupancy_options(CLI::App& app, OccupancyOptions& options) {
  CLI::Option* folder = app.add_option(
      "--occupancy", options.folder,
      "Also write a folder for planners: occupied and free space around the tracked features (with --dense also "
      "the dense points), as occupancy.bt and occupancy.ot of OctoMap, and as map.pgm and map.yaml of the ROS map "
      "server");
  app.add_option("--occupancy-voxel", options.voxel_m, "Edge of the voxels of --occupancy [m]")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str()
      ->needs(folder);
  app.add_option("--occupancy-heights", options.heights_m,
                 "What map.pgm shows: from which to which z in the map [m] [the heights of the path, and a voxel]")
      ->expected(2)
      ->needs(folder);
}

std::unique_ptr<RunObserver> observe_occupancy(RunContext& run) {
  return run.options.occupancy.folder.empty() ? nullptr : std::make_unique<RunOccupancy>(run);
}

}  // namespace edged
