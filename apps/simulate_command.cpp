// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/command.hpp"
#include "common/config_source.hpp"
#include "common/interrupt.hpp"
#include "common/status_line.hpp"
#include "common/text.hpp"
#include "edged/core/check.hpp"
#include "edged/io/recording.hpp"
#include "edged/io/write_recording.hpp"
#include "edged/sim/simulated_pair.hpp"
#include "edged/sim/simulator.hpp"

namespace edged {
namespace {

struct SimulateOptions {
  std::string preset = "room";
  std::optional<std::string> seed, duration_s;
  std::optional<double> baseline_m;  ///< of a second camera of each kind
  std::vector<std::string> assignments;
  std::filesystem::path out;
  bool list = false;  ///< prints the options instead
  bool quiet = false, json = false;
};

SimulatorConfig load_config(const SimulateOptions& options) {
  SimulatorConfig config = simulator_preset(options.preset);
  ConfigFields fields = ConfigFields::of(config);
  if (options.seed) fields.set("seed", *options.seed);
  if (options.duration_s) fields.set("duration_s", *options.duration_s);
  assign(config, options.assignments);
  return config;
}

/// The simulator with its calibration; with a baseline, of two cameras of each kind.
Recording make_simulator(const SimulatorConfig& config, const std::optional<double>& baseline_m) {
  const auto opened = [](auto simulator) -> Recording {
    Calibration calibration = simulator->calibration();
    return {std::move(simulator), std::move(calibration)};
  };
  if (baseline_m) return opened(std::make_unique<SimulatedPair>(config, *baseline_m));
  return opened(std::make_unique<Simulator>(config));
}

int run_simulate(const SimulateOptions& options) {
  catch_interrupts();
  SimulatorConfig config = load_config(options);
  if (options.list) {
    fmt::print("{}", ConfigFields::of(config).to_yaml());
    return kExitOk;
  }
  const Recording recording = make_simulator(config, options.baseline_m);
  const std::filesystem::path folder =
      options.out.empty() ? std::filesystem::path("recordings") / fmt::format("{}_{}", options.preset, config.seed)
                          : options.out;
  StatusLine status(options.quiet);
  WriteOptions write;
  write.progress = [&](Timestamp t) {
    if (status.due())
      status.show(fmt::format("{:.1f} / {:.1f} s simulated", to_seconds(t), config.duration_s),
                  to_seconds(t) / config.duration_s);
  };
  InterruptibleDataset dataset(*recording.dataset);
  const WriteCounts counts =
      write_recording(dataset, writable_format("ecd", folder), folder, recording.calibration, write);
  status.clear();
  const nlohmann::ordered_json json = {{"folder", folder.string()},  {"preset", options.preset},
                                       {"seed", config.seed},        {"duration_s", config.duration_s},
                                       {"events", counts.events},    {"frames", counts.frames},
                                       {"imu", counts.imu},          {"poses", counts.poses},
                                       {"external", counts.external}};
  print_result(
      options.json, json,
      fmt::format("{}: {}events, {}, {}, {}{}\n", folder.string(), si_number(static_cast<double>(counts.events)),
                  quantity(counts.frames, "frame"), quantity(counts.imu, "IMU sample"),
                  quantity(counts.poses, "true pose"), external_text(counts.external)));
  return exit_code_of_interrupt();
}

}  // namespace

void add_simulate_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<SimulateOptions>();
  CLI::App* simulate = app.add_subcommand("simulate", "Make a recording with ground truth: events, frames and IMU");
  simulate->add_option("--preset", options->preset, "What is simulated: see below")
      ->type_name("PRESET")
      ->check([](std::string name) { return CLI::IsMember(simulator_presets())(name); }, "")
      ->capture_default_str();
  simulate->add_option("--seed", options->seed, "Seed of motion, scene and noise [1]");
  simulate->add_option("--duration", options->duration_s, "Length [s] [that of the preset]");
  simulate
      ->add_option("--baseline", options->baseline_m,
                   "Distance of a second event camera and a second frame camera, events2 and frames2, to the right of "
                   "the first [m] [no second cameras]")
      ->check(positive_number());
  add_assignments(*simulate, "--set", "One option", options->assignments);
  simulate->add_flag("--list", options->list, "Print every option as chosen, with unit and effect, instead");
  simulate->add_option("--out", options->out, "Folder to make [recordings/PRESET_SEED]");
  finish_command(*simulate, options, "", chosen, run_simulate);
  simulate->footer([] {
    std::string presets = "Presets:\n";
    for (const std::string& name : simulator_presets())
      presets += fmt::format("  {:<20} {}\n", name, preset_summary(name));
    return presets +
           "\nExamples:\n"
           "  edged simulate --preset room --seed 3 --duration 20 --out /tmp/flight && edged run /tmp/flight\n"
           "  edged simulate --baseline 0.1 --out /tmp/pair    # events, events2, frames, frames2\n"
           "  edged simulate --set disturbance.kind=lens-covered --set disturbance.at_s=6 --out /tmp/covered";
  });
}

}  // namespace edged
