// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "common/command.hpp"
#include "common/files.hpp"
#include "common/text.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/map/map_merge.hpp"
#include "outputs/final_trajectory.hpp"
#include "outputs/map.hpp"

namespace edged {
namespace {

struct MapCommandOptions {
  std::filesystem::path file, other, out;
  bool json = false;
};

std::vector<MappedKeyframe> mapped(const SavedMap& map) {
  std::vector<MappedKeyframe> all;
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) all.push_back(mapped(map.keyframes[k], map.T_M_K[k]));
  return all;
}

nlohmann::ordered_json describe(const SavedMap& map) {
  Eigen::AlignedBox3d box;
  std::map<std::string, std::size_t> keyframes;
  std::size_t points = 0;
  for (const MappedKeyframe& keyframe : mapped(map)) {
    points += keyframe.points.size();
    for (const MappedKeyframe::Point& point : keyframe.points) box.extend(point.p_W);
  }
  for (const MapKeyframe& keyframe : map.keyframes)
    for (const MapView& view : keyframe.views) ++keyframes[view.camera];
  nlohmann::ordered_json cameras = nlohmann::ordered_json::array();
  for (const auto& [name, width, height, focal] : map.cameras)
    cameras.push_back(
        {{"name", name}, {"width", width}, {"height", height}, {"focal_px", focal}, {"keyframes", keyframes[name]}});
  const Eigen::Vector3d size = points > 0 ? Eigen::Vector3d(box.sizes()) : Eigen::Vector3d(0, 0, 0);
  return {{"cameras", cameras},
          {"keyframes", map.keyframes.size()},
          {"points", points},
          {"size_m", {size.x(), size.y(), size.z()}}};
}

int run_info(const MapCommandOptions& options) {
  const nlohmann::ordered_json about = describe(read_map(options.file));
  std::string text =
      fmt::format("{}: {}, {} over {:.1f} x {:.1f} x {:.1f} m, {} kB\n", options.file.string(),
                  quantity(about["keyframes"].get<int>(), "keyframe"), quantity(about["points"].get<int>(), "point"),
                  about["size_m"][0].get<double>(), about["size_m"][1].get<double>(), about["size_m"][2].get<double>(),
                  std::filesystem::file_size(options.file) / 1024);
  for (const auto& camera : about["cameras"])
    text += fmt::format("  {:<12} {}; {} x {} px, focal length {:.1f} px\n", camera["name"].get<std::string>(),
                        quantity(camera["keyframes"].get<int>(), "keyframe"), camera["width"].get<int>(),
                        camera["height"].get<int>(), camera["focal_px"].get<double>());
  print_result(options.json, about, text);
  return kExitOk;
}

int run_show(const MapCommandOptions& options) {
  const SavedMap map = read_map(options.file);
  check_writable(options.out, "--out", "ply\n");
  write_file(options.out, map_ply(mapped(map)));
  print_result(options.json, {{"out", options.out.string()}, {"keyframes", map.keyframes.size()}},
               fmt::format("{}: points of {}; any viewer of point clouds shows them\n", options.out.string(),
                           quantity(map.keyframes.size(), "keyframe")));
  return kExitOk;
}

int run_merge(const MapCommandOptions& options) {
  const SavedMap map = read_map(options.file), other = read_map(options.other);
  check_writable(options.out, "--out", beginning_of_maps());
  const auto [T_A_B, refusal] = find_map_in(map, other);
  if (!T_A_B)
    throw InputError::format(
        "{}: not recognized in {}, {}; run a recording of one in the map of the other instead: edged run RECORDING "
        "--map {} --save-map BOTH",
        options.other.string(), options.file.string(), refusal, options.file.string());
  const SavedMap both = merged(map, other, *T_A_B);
  write_file(options.out, to_bytes(both));
  const Eigen::Vector3d p = T_A_B->translation();
  const double turned_deg = so3::log(T_A_B->rotation()).norm() * kDegreesPerRadian;
  print_result(options.json,
               {{"out", options.out.string()},
                {"keyframes", both.keyframes.size()},
                {"other_at_m", {p.x(), p.y(), p.z()}},
                {"other_turned_deg", turned_deg}},
               fmt::format("{}: {}; {} lies at {:.2f} {:.2f} {:.2f} m of {}, turned by {:.1f} deg\n",
                           options.out.string(), quantity(both.keyframes.size(), "keyframe"), options.other.string(),
                           p.x(), p.y(), p.z(), options.file.string(), turned_deg));
  return kExitOk;
}

}  // namespace

void add_map_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<MapCommandOptions>();
  CLI::App* map = app.add_subcommand("map", "Inspect, export and merge saved maps");
  map->require_subcommand(1);
  CLI::App* info = map->add_subcommand("info", "Cameras, keyframes, points and size of a map");
  CLI::App* show = map->add_subcommand("show", "Write the map points as a PLY file for point cloud viewers");
  CLI::App* merge = map->add_subcommand("merge", "Merge two maps of one place, in the frame of the first");
  for (CLI::App* each : {info, show, merge})
    each->add_option("MAP", options->file, "Map file of `edged run --save-map`")->required();
  for (CLI::App* each : {info, show, merge}) each->add_flag("--json", options->json, "Print JSON");
  show->add_option("--out", options->out, "File to write [map.ply]");
  merge->add_option("OTHER", options->other, "Another map of the same place")->required();
  merge->add_option("--out", options->out, "File to write")->required();
  map->footer(
      "Examples:\n"
      "  edged run monday.bag --save-map lab.map\n"
      "  edged run tuesday.bag --map lab.map --save-map lab.map   # in monday's frame, once relocalized\n"
      "  edged map show lab.map --out lab.ply");
  info->callback([options, &chosen] { chosen = [options] { return run_info(*options); }; });
  show->callback([options, &chosen] {
    if (options->out.empty()) options->out = "map.ply";
    chosen = [options] { return run_show(*options); };
  });
  merge->callback([options, &chosen] { chosen = [options] { return run_merge(*options); }; });
}

}  // namespace edged
