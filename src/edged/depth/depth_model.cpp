// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "edged/core/check.hpp"
#include "edged/core/resources.hpp"
#include "edged/depth/network.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;

DepthModel parse_model(const nlohmann::json& json) {
  DepthModel model;
  model.name = json.at("name").get<std::string>();
  model.note = json.value("note", "");
  model.bins = json.at("bins").get<int>();
  model.shrink = json.value("shrink", model.shrink);
  model.multiple = json.at("multiple").get<int>();
  model.d_max_m = json.at("d_max_m").get<double>();
  model.alpha = json.at("alpha").get<double>();
  model.focal_px = json.value("focal_px", 0.0);
  model.window_s = json.value("window_s", model.window_s);
  model.sigma_ln = json.value("sigma_ln", model.sigma_ln);
  for (const nlohmann::json& state : json.value("states", nlohmann::json::array()))
    model.states.push_back(
        {state.at("name").get<std::string>(), state.at("channels").get<int>(), state.at("divisor").get<int>()});
  return model;
}

void check_ranges(const DepthModel& m, const fs::path& file) {
  const auto want = [&file](bool good, const char* key, const char* range) {
    if (!good) throw InputError::format("{}: '{}' is out of range; it must be {}", file.string(), key, range);
  };
  want(m.bins >= 2 && m.bins <= 64, "bins", "2 .. 64");
  want(m.shrink >= 1 && m.shrink <= 16, "shrink", "1 .. 16");
  want(m.multiple >= 1 && m.multiple <= 64, "multiple", "1 .. 64");
  want(m.d_max_m > 0.0 && std::isfinite(m.d_max_m), "d_max_m", "positive");
  want(m.alpha > 0.0 && m.alpha < 100.0, "alpha", "positive");
  want(m.focal_px >= 0.0, "focal_px", "the focal length in training, or 0");
  want(m.window_s > 0.0 && m.window_s < 10.0, "window_s", "positive");
  want(m.sigma_ln > 0.0, "sigma_ln", "positive");
  for (const DepthModel::State& state : m.states)
    want(state.channels > 0 && state.divisor > 0 && m.multiple % state.divisor == 0, "states",
         "channels > 0 and a divisor of 'multiple'");
}

}  // namespace

fs::path find_depth_model(const std::string& name_or_path) {
  if (fs::path(name_or_path).has_extension()) return name_or_path;
  if (const auto file = find_resource("depth", name_or_path, ".onnx")) return *file;
  std::vector<std::string> names;
  for (const fs::path& file : resources("depth", ".onnx")) names.push_back(file.stem().string());
  const std::string choice =
      names.empty() ? "set EDGED_DEPTH to a folder of them" : fmt::format("choose one of {}", fmt::join(names, ", "));
  throw InputError::format("there is no depth model '{}'; {} or give the path of an .onnx file", name_or_path, choice);
}

DepthModel read_depth_model(const fs::path& onnx) {
  const fs::path file = fs::path(onnx).replace_extension(".json");
  std::ifstream stream(file);
  if (!stream)
    throw InputError::format("{}: cannot be read; a depth model needs it beside its .onnx (docs/depth_model.md)",
                             file.string());
  try {
    const DepthModel model = parse_model(nlohmann::json::parse(stream));
    check_ranges(model, file);
    return model;
  } catch (const nlohmann::json::exception& e) {
    throw InputError::format("{}: {}; docs/depth_model.md lists the keys", file.string(), first_line(e.what()));
  }
}

}  // namespace edged
