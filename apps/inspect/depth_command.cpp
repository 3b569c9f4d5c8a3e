// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/command.hpp"
#include "edged/core/resources.hpp"
#include "edged/core/statistics.hpp"
#include "edged/depth/network.hpp"
#include "edged/events/voxel_grid.hpp"
#include "edged/options/depth.hpp"

namespace edged {
namespace {

struct DepthOptions {
  std::string model = NetworkDepthConfig().model;
  bool json = false;
};

/// Median over windows of a DAVIS240C's central region [ms of processor time, independent of other programs].
double inference_ms(DepthNetwork& network) {
  const cv::Size image(240, 180);
  const cv::Rect seen =
      grown_region(central_region(image, DepthConfig().region_share), NetworkDepthConfig().margin_px, image);
  cv::Mat grid(std::vector<int>{1, network.model().bins, seen.height, seen.width}, CV_32FC1);
  cv::RNG random(1);
  random.fill(grid, cv::RNG::NORMAL, 0.0, 1.0);
  std::vector<double> times;
  for (int i = 0; i < 21; ++i) {
    const std::clock_t begin = std::clock();
    network.infer(grid);
    times.push_back(1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return median(std::move(times));
}

std::string text_of(const DepthModel& m, const std::filesystem::path& file, double ms) {
  const auto size = static_cast<double>(std::filesystem::file_size(file));
  return fmt::format(
      "{}: {} ({:.2f} MB)\n{}  input   {} bins over {:.0f} ms of events{}, {}\n"
      "  output  {:.2f} .. {:.0f} m, depth = {} exp(-{} (1 - y)){}\n"
      "  error   {:.2f} (rms of ln depth, as its authors measured it)\n"
      "  time    {:.1f} ms of one core per window of a DAVIS240C\nOthers: edged depth fetch\n",
      m.name, file.string(), 1e-6 * size, m.note.empty() ? "" : fmt::format("  {}\n", m.note), m.bins, 1e3 * m.window_s,
      m.shrink > 1 ? fmt::format(", at 1/{} of the resolution", m.shrink) : "",
      m.states.empty() ? "no memory" : "recurrent", m.d_max_m * std::exp(-m.alpha), m.d_max_m, m.d_max_m, m.alpha,
      m.focal_px > 0.0 ? fmt::format(", times the focal length / {:.1f} px", m.focal_px) : "", m.sigma_ln, ms);
}

int run_depth(const DepthOptions& options) {
  const std::filesystem::path file = find_depth_model(options.model);
  DepthNetwork network(file);
  const DepthModel& m = network.model();
  const double ms = inference_ms(network);
  const nlohmann::ordered_json json = {{"name", m.name},         {"file", file.string()},     {"note", m.note},
                                       {"bins", m.bins},         {"window_s", m.window_s},    {"shrink", m.shrink},
                                       {"d_max_m", m.d_max_m},   {"alpha", m.alpha},          {"focal_px", m.focal_px},
                                       {"sigma_ln", m.sigma_ln}, {"states", m.states.size()}, {"inference_ms", ms}};
  print_result(options.json, json, text_of(m, file, ms));
  return kExitOk;
}

/// Nothing is downloaded: the published weights are under their authors' terms, so the user must get them.
int explain_fetch() {
  const std::vector<std::filesystem::path> folders = resource_folders("depth");
  const std::filesystem::path target = (folders.empty() ? "." : folders.front()) / "e2depth.onnx";
  fmt::print(
      "The published e2depth network cannot ship with this program: its weights come under their authors' terms.\n"
      "  1. Get E2DEPTH_si_grad_loss_mixed.pth.tar from the page of github.com/uzh-rpg/rpg_e2depth.\n"
      "  2. tools/depth/convert_checkpoint.py E2DEPTH_si_grad_loss_mixed.pth.tar --out {}\n"
      "     (Debian: python3-numpy, python3-onnx; nothing in the checkpoint is executed)\n"
      "  3. edged depth e2depth\n"
      "     edged run RECORDING --set depth.source=fused --set depth.network.model=e2depth\n"
      "Its depths begin at 2 m and its scale is uncertain: use it fused, where landmarks determine the scale.\n"
      "Training a network of your own: tools/depth/train.py, docs/depth_model.md.\n"
      "It is {}.\n",
      target.string(), std::filesystem::exists(target) ? "installed" : "not installed yet");
  return kExitOk;
}

}  // namespace

void add_depth_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<DepthOptions>();
  CLI::App* depth = app.add_subcommand("depth", "Describe a depth network and measure its run time");
  depth->add_option("MODEL", options->model, "Name of an installed network, or path of an .onnx file")
      ->capture_default_str();
  depth->add_flag("--json", options->json, "Print JSON");
  depth->footer(
      "Examples:\n"
      "  edged depth\n"
      "  edged depth small_recurrent --json\n"
      "  edged depth fetch");
  CLI::App* fetch =
      depth->add_subcommand("fetch", "Print where to get the published e2depth weights and where to put them");
  depth->callback([options, fetch, &chosen] {
    chosen = [options, fetching = fetch->parsed()] { return fetching ? explain_fetch() : run_depth(*options); };
  });
}

}  // namespace edged
