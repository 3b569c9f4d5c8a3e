// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Semi-dense depth of a simulated flight, against the true depth: one line a mode.
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "common/config_source.hpp"
#include "dense_flight.hpp"
#include "edged/options.hpp"
#include "edged/sim/simulated_pair.hpp"
#include "program/commands.hpp"
#include "program/program.hpp"

namespace edged {
namespace {

struct DenseOptions {
  std::string preset = "room";
  std::uint64_t seed = 1;
  double duration_s = 10.0;
  double baseline_m = 0.0;
  std::vector<std::string> simulator;  ///< "key=value"
  std::vector<std::string> modes = {"events", "frames", "fused"};
};

Flight fly(const SimulatorConfig& config, double baseline_m) {
  if (baseline_m <= 0.0) return simulate_flight(config);
  SimulatedPair pair(config, baseline_m);
  return read_flight(pair, pair.calibration());
}

int run(const DenseOptions& options) {
  SimulatorConfig config = simulator_preset(options.preset);
  config.seed = options.seed;
  config.duration_s = options.duration_s;
  assign(config, options.simulator);
  const Flight flight = fly(config, options.baseline_m);
  OdometryConfig odometry;
  if (options.baseline_m > 0.0) odometry.cameras = "events,events2,frames,frames2";
  for (const std::string& mode : options.modes) {
    const DenseRun mapped = map_densely(flight, parse_mode(mode), odometry);
    fmt::print("{} {} {}: {}\n", options.preset, options.seed, mode, describe(mapped, score(mapped, config)));
  }
  return kExitOk;
}

}  // namespace
}  // namespace edged

int main(int argc, char** argv) {
  using namespace edged;
  CLI::App app{"How far semi-dense depth is from the true depth of a simulated flight", "edged_dense_errors"};
  DenseOptions options;
  app.add_option("--preset", options.preset, "As for edged simulate")->capture_default_str();
  app.add_option("--seed", options.seed, "Another flight")->capture_default_str();
  app.add_option("--duration", options.duration_s, "[s]")->capture_default_str();
  app.add_option("--baseline", options.baseline_m, "Of second cameras [m]; 0: none")->capture_default_str();
  add_assignments(app, "--set", "One option of the simulator", options.simulator);
  app.add_option("--modes", options.modes, "Sensors beside the IMU")
      ->delimiter(',')
      ->check(CLI::IsMember({"events", "frames", "fused"}));
  return run_program(app, argc, argv, [&] { return run(options); });
}
