// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// --occupancy of `edged run`: a folder with an occupancy map for planners.
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>

#include "common/files.hpp"
#include "edged/camera/undistort.hpp"
#include "edged/core/check.hpp"
#include "edged/occupancy/occupancy_worker.hpp"
#include "run/run_context.hpp"
#include "scene/live_points.hpp"
#include "scene/occupancy.hpp"

namespace edged {
namespace {

constexpr double kShowPeriod_s = 5.0;

struct OccupancyOptions {
  std::filesystem::path folder;   ///< "": none
  double voxel_m = 0.05;          ///< edge of its voxels
  std::vector<double> heights_m;  ///< of its slice: from, to; empty: those of the path
};

/// Observations at keyframes are kept until the final poses are known: 40 bytes each, about 2 MB a minute.
class RunOccupancy : public RunObserver {
 public:
  explicit RunOccupancy(RunContext& run)
      : run_(run),
        options_(run.options.outputs.get<OccupancyOptions>()),
        dense_(run.products.get<DenseScans>()),
        viewed_(run.products.get<LivePoints>()) {
    if (!run.options.force) check_empty(options_.folder, "--occupancy");
    if (!options_.heights_m.empty() && options_.heights_m[0] >= options_.heights_m[1])
      throw InputError::format("--occupancy-heights {} {}: the second must be above the first", options_.heights_m[0],
                               options_.heights_m[1]);
    for (const RigCamera& camera : run.used.cameras)
      model_.cameras.push_back({camera.name, ideal_pinhole(camera.model), camera.modality});
    make_picture_folder(options_.folder);
    viewed_.has_voxels = true;
  }

  void on_begin() override {
    if (viewed_.watched)
      so_far_ = std::make_unique<OccupancyWorker>(options_.voxel_m, kShowPeriod_s, [this](const OccupancyMap& map) {
        viewed_.set_voxels(occupied_voxels(map.tree), map.tree.getResolution());
      });
  }

  void on_step(const Step& step) override {
    if (so_far_) so_far_->add(step.marginalized_keyframes);
    if (is_tracking(step.status) && step.keyframe) add_images(model_, step);
  }

  void on_summary(RunEnd& end) override {
    end.summary.outputs.line("occupancy", (options_.folder / "").string(),
                             "occupancy.bt, occupancy.ot, map.pgm, map.yaml");
  }

  void on_end(const RunEnd& end) override {
    place(model_, end.final_trajectory.poses, run_.rig);
    triangulate(model_);
    const octomap::OcTree tree = occupancy_of(model_, options_.voxel_m, dense_);
    if (tree.size() == 0)
      throw InputError::format(
          "--occupancy {}: the depth of no feature is known; record for longer, and move sideways to the scene",
          options_.folder.string());
    if (so_far_) {
      so_far_.reset();  // what it has not mapped yet is in the final map
      viewed_.set_voxels(occupied_voxels(tree), tree.getResolution());
    }
    write_file(run_.folder / "voxels.ply", voxels_ply(tree));  // for the report
    write_occupancy(options_.folder, tree, heights(end.final_trajectory.poses));
  }

 private:
  /// The chosen ones, or those of the path of the body.
  HeightRange heights(const Trajectory& poses) const {
    if (!options_.heights_m.empty()) return {options_.heights_m[0], options_.heights_m[1]};
    const auto [low, high] =
        std::ranges::minmax(poses, {}, [](const StampedPose& pose) { return pose.T.translation().z(); });
    return {low.T.translation().z() - options_.voxel_m, high.T.translation().z() + options_.voxel_m};
  }

  const RunContext& run_;
  const OccupancyOptions& options_;
  const DenseScans& dense_;
  LivePoints& viewed_;
  Reconstruction model_;
  std::unique_ptr<OccupancyWorker> so_far_;  ///< for the live page
};

}  // namespace

RunOutput occupancy_output() {
  return {
      {"voxels.ply"},
      [](CLI::App& command, Board& options) {
        auto& occupancy = options.get<OccupancyOptions>();
        CLI::Option* folder = command.add_option(
            "--occupancy", occupancy.folder,
            "Also write a folder for planners: occupied and free space around the tracked features (with --dense also "
            "the dense points), as occupancy.bt and occupancy.ot of OctoMap, and as map.pgm and map.yaml of the ROS "
            "map server");
        command.add_option("--occupancy-voxel", occupancy.voxel_m, "Edge of the voxels of --occupancy [m]")
            ->check(CLI::Range(0.01, 10.0))
            ->capture_default_str()
            ->needs(folder);
        command
            .add_option("--occupancy-heights", occupancy.heights_m,
                        "What map.pgm shows: from which to which z in the map [m] [the heights of the path, and a "
                        "voxel]")
            ->expected(2)
            ->needs(folder);
      },
      [](RunContext& run) -> std::unique_ptr<RunObserver> {
        if (run.options.outputs.get<OccupancyOptions>().folder.empty()) return nullptr;
        return std::make_unique<RunOccupancy>(run);
      }};
}

}  // namespace edged
