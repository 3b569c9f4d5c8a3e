// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/command.hpp"
#include "common/interrupt.hpp"
#include "common/source.hpp"
#include "common/status_line.hpp"
#include "common/text.hpp"
#include "edged/io/write_recording.hpp"

namespace edged {
namespace {

struct ConvertOptions {
  SourceOptions source;
  std::filesystem::path target;
  std::string format;
  bool round = false, quiet = false, json = false;
};

std::string left_out_text(const WriteCounts& counts, std::string_view format) {
  std::vector<std::string> parts;
  const auto add = [&parts](std::size_t count, const char* what) {
    if (count > 0) parts.push_back(quantity(count, what));
  };
  add(counts.frames_left_out, "frame");
  add(counts.imu_left_out, "IMU sample");
  add(counts.poses_left_out, "true pose");
  for (const auto& [sensor, count] : counts.external_left_out) add(count, (sensor + " sample").c_str());
  return parts.empty() ? "" : fmt::format("dropped, as {} cannot store them: {}\n", format, fmt::join(parts, ", "));
}

void print_summary(const ConvertOptions& options, const WritableFormat& format, const WriteCounts& counts,
                   const std::map<std::string, std::size_t>& repairs) {
  const nlohmann::ordered_json json = {{"from", options.source.recording},
                                       {"to", options.target.string()},
                                       {"format", format.name},
                                       {"events", counts.events},
                                       {"frames", counts.frames},
                                       {"imu", counts.imu},
                                       {"poses", counts.poses},
                                       {"external", counts.external},
                                       {"left_out",
                                        {{"frames", counts.frames_left_out},
                                         {"imu", counts.imu_left_out},
                                         {"poses", counts.poses_left_out},
                                         {"external", counts.external_left_out}}},
                                       {"repairs", repairs}};
  std::string text = fmt::format("{}: {}, {}, {}, {}{}\n{}", options.target.string(), quantity(counts.events, "event"),
                                 quantity(counts.frames, "frame"), quantity(counts.imu, "IMU sample"),
                                 quantity(counts.poses, "true pose"), external_text(counts.external),
                                 left_out_text(counts, format.name));
  for (const auto& [kind, count] : repairs) text += fmt::format("repaired: {} ({})\n", kind, count);
  print_result(options.json, json, text);
}

int run_convert(const ConvertOptions& options) {
  catch_interrupts();
  const WritableFormat& format = writable_format(options.format, options.target);
  SourceOptions source = options.source;
  source.all_cameras = format.several_cameras;
  const Recording recording = open_uncalibrated(source);
  StatusLine status(options.quiet);
  WriteOptions write{.round = options.round};
  write.progress = [&](Timestamp t) { show_progress(status, t, recording.dataset->info(), "converted"); };
  InterruptibleDataset dataset(*recording.dataset);
  const WriteCounts counts = write_recording(dataset, format, options.target, recording.calibration, write);
  status.clear();
  print_summary(options, format, counts, dataset.repairs());
  return exit_code_of_interrupt();
}

}  // namespace

void add_convert_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<ConvertOptions>();
  std::vector<std::string_view> names;
  for (const WritableFormat& format : writable_formats()) names.push_back(format.name);
  CLI::App* convert = app.add_subcommand("convert", "Convert a recording to another format without loss of any event");
  add_source_options(*convert, options->source);
  add_cameras_option(*convert, options->source);
  convert->add_option("TARGET", options->target, "File or folder to write; the extension determines the format")
      ->required();
  convert->add_option("--format", options->format, fmt::format("One of {} [by extension]", fmt::join(names, ", ")));
  convert->add_flag("--round", options->round,
                    "Truncate timestamps that are finer than the format can store, instead of refusing them");
  finish_command(*convert, options,
                 "Examples:\n"
                 "  edged convert flight.aedat4 flight_folder\n"
                 "  edged convert gen3.raw events.dat --geometry 640x480",
                 chosen, run_convert);
}

}  // namespace edged
