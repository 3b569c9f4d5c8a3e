// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The simulator presets: files that come with the program, in config/presets.
#include <algorithm>
#include <sstream>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/resources.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {
namespace {

constexpr int kMostBases = 8;

/// What a file may hold: every option of the simulator, and what is none.
struct PresetFile {
  std::string base, summary, T_B_C;
  int order = 1000;
  SimulatorConfig config;

  void visit(ConfigFields& fields) {
    fields.add("summary", summary, {.effect = "what is simulated, in a line"});
    fields.add("order", order, {"", 0, 1000, "place in the list"});
    fields.add("base", base, {.effect = "the preset from which this one differs; empty: the defaults"});
    fields.add("T_B_C", T_B_C, {.effect = "pose of the camera in the body, three rows of four numbers [m]"});
    config.visit(fields);
  }
};

void read_preset(const std::filesystem::path& file, PresetFile& preset) {
  ConfigFields::of(preset).load(file);
  if (preset.T_B_C.empty()) return;
  Eigen::Matrix<double, 3, 4> T;
  std::istringstream numbers(preset.T_B_C);
  for (double& number : T.reshaped<Eigen::RowMajor>()) numbers >> number;
  if (!numbers) throw InputError::format("{}: T_B_C must be three rows of four numbers", file.string());
  preset.config.T_B_C = {Eigen::Matrix3d(T.leftCols<3>()), T.col(3)};
}

SimulatorConfig load_preset(const std::string& name, int bases_left) {
  const auto file = find_resource("presets", name, ".yaml");
  if (!file && name == SimulatorConfig().name) return {};  // the defaults need no file
  if (!file)
    throw InputError::format("there is no simulator preset '{}'; choose one of {}", name,
                             fmt::join(simulator_presets(), ", "));
  if (bases_left == 0)
    throw InputError::format("{}: its chain of base presets has no end; give a preset without a base", file->string());
  PresetFile own, whole;
  read_preset(*file, own);
  if (!own.base.empty()) whole.config = load_preset(own.base, bases_left - 1);
  read_preset(*file, whole);
  whole.config.name = name;
  return whole.config;
}

}  // namespace

SimulatorConfig simulator_preset(const std::string& name) { return load_preset(name, kMostBases); }

std::string preset_summary(const std::string& name) {
  const auto file = find_resource("presets", name, ".yaml");
  PresetFile preset;
  if (file) read_preset(*file, preset);
  return preset.summary;
}

std::vector<std::string> simulator_presets() {
  std::vector<std::pair<int, std::string>> ordered;
  for (const std::filesystem::path& file : resources("presets", ".yaml")) {
    PresetFile preset;
    read_preset(file, preset);
    ordered.emplace_back(preset.order, file.stem().string());
  }
  std::ranges::sort(ordered);
  std::vector<std::string> names;
  for (auto& [order, name] : ordered) names.push_back(std::move(name));
  return names;
}

}  // namespace edged
