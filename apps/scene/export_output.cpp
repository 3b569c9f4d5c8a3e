// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// --export of `edged run`: a folder from which programs for reconstruction start.
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <utility>

#include "common/files.hpp"
#include "common/text.hpp"
#include "edged/camera/undistort.hpp"
#include "edged/core/check.hpp"
#include "edged/dense/rectifier.hpp"
#include "run/run_context.hpp"
#include "scene/reconstruction.hpp"

namespace edged {
namespace {

struct ExportOptions {
  std::filesystem::path folder;  ///< "": none
  double rate_hz = 0.0;          ///< of its images; 0: at keyframes
};

/// Frames at keyframes, or at a rate, are written at once, undistorted by the lens as the run knows it then. The model
/// is made at the end, with the final trajectory.
class RunExport : public RunObserver {
 public:
  explicit RunExport(RunContext& run)
      : run_(run), options_(run.options.outputs.get<ExportOptions>()), folder_(options_.folder) {
    if (!run.options.force) check_empty(folder_, "--export");
    for (const RigCamera& camera : run.used.cameras)
      if (camera.modality == Modality::Frames) model_.cameras.push_back({camera.name, ideal_pinhole(camera.model)});
    if (model_.cameras.empty())
      throw InputError::format("--export: needs a frame camera; mode {} uses none", mode_name(run.mode));
    make_picture_folder(folder_ / "images");
  }

  void on_step(const Step& step) override {
    if (!is_tracking(step.status) || !due(step)) return;
    for (std::size_t camera = 0; camera < model_.cameras.size(); ++camera) {
      const CameraStep* seen = step.find(model_.cameras[camera].name);
      if (!seen || seen->image.empty()) continue;
      add(step.t, camera, *seen, run_.rig.camera(seen->name).model);
      last_ = step.t;
    }
  }

  void on_summary(RunEnd& end) override {
    end.summary.outputs.line(
        "export", (folder_ / "").string(),
        fmt::format("{}, sparse/0, transforms.json, points.ply", quantity(model_.images.size(), "image")));
  }

  void on_end(const RunEnd& end) override {
    place(model_, end.final_trajectory.poses, run_.rig);
    triangulate(model_);
    write_colmap(folder_, model_);
    write_file(folder_ / "transforms.json", transforms_json(model_));
    write_file(folder_ / "points.ply", points_ply(model_));
  }

 private:
  bool due(const Step& step) const {
    const double rate_hz = options_.rate_hz;
    if (rate_hz == 0.0) return step.keyframe;
    constexpr double kEarly = 0.1;  // of the period: frames come in a rhythm of their own
    return !last_ || to_seconds(step.t - *last_) * rate_hz > 1.0 - kEarly;
  }

  void add(Timestamp t, std::size_t camera, const CameraStep& seen, const CameraModel& lens) {
    const CameraModel& pinhole = model_.cameras[camera].pinhole;
    const cv::Mat undistorted = Rectifier(lens, pinhole)(seen.image);
    Reconstruction::Image image;
    image.file = fmt::format("{}_{:06d}.png", seen.name, model_.images.size());
    image.t = t;
    image.camera = camera;
    image.observations = observations_of(seen.tracks, pinhole);
    for (auto& [id, pixel, grey, point] : image.observations)
      grey = undistorted.at<std::uint8_t>(cv::Point(cvRound(pixel.x()), cvRound(pixel.y())));
    write_picture(folder_ / "images" / image.file, undistorted);
    model_.images.push_back(std::move(image));
  }

  const RunContext& run_;
  const ExportOptions& options_;
  std::filesystem::path folder_;
  Reconstruction model_;
  std::optional<Timestamp> last_;
};

}  // namespace

RunOutput export_output() {
  return {{},
          [](CLI::App& command, Board& options) {
            auto& exports = options.get<ExportOptions>();
            CLI::Option* folder = command.add_option(
                "--export", exports.folder,
                "Also write a folder for reconstruction: undistorted frames with poses and points as a COLMAP model "
                "(sparse/0; as text in sparse_text/0), nerfstudio's transforms.json, and points.ply");
            command
                .add_option("--export-hz", exports.rate_hz,
                            "Frames a second that --export writes [those of the keyframes]")
                ->check(CLI::Range(0.01, 10'000.0))
                ->needs(folder);
          },
          [](RunContext& run) -> std::unique_ptr<RunObserver> {
            if (run.options.outputs.get<ExportOptions>().folder.empty()) return nullptr;
            return std::make_unique<RunExport>(run);
          }};
}

}  // namespace edged
