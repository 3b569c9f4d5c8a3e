// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What an output of a run is made from, what it sees of the run, and its interface.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/cli.hpp"
#include "edged/camera/output_frame.hpp"
#include "edged/final_trajectory.hpp"
#include "edged/step.hpp"
#include "run/estimated_calibration.hpp"
#include "run/run_options.hpp"
#include "run/run_statistics.hpp"
#include "run/run_summary.hpp"

namespace edged {

/// A run as its outputs see it; it lives as long as they do.
struct RunContext {
  RunContext(const RunOptions& run_options, Source recording, Mode run_mode, const RunConfig& run_config);

  const DatasetInfo& info() const { return source.dataset->info(); }
  /// The rig for poses of cameras, as estimated so far.
  Rig estimated_rig() const;
  /// `frame` in that rig.
  OutputFrame estimated_frame() const { return {estimated_rig(), frame.name()}; }
  /// Comments at the head of a trajectory file.
  std::vector<std::string> heading(const OutputFrame& of, const std::string& known_when) const;

  const RunOptions& options;
  Source source;
  Mode mode;
  RunConfig config;
  OutputFrame frame;                      ///< whose pose the trajectory files hold, by the given calibration
  Rig used;                               ///< the cameras of the run, as given
  std::filesystem::path folder, archive;  ///< the second: "" for none
  StageTimings timings;                   ///< of the program
  ResourceMeter meter;

  // After the newest step.
  RunStatistics statistics;
  PacketPace pace;
  Rig rig;                               ///< the cameras of the run, with their online calibration
  bool awaiting_relocalization = false;  ///< a map was loaded, and the body has not been localized in it yet

  /// What outputs publish for others, by its type: in their constructors, for all calls from on_begin on.
  Board products;
};

/// A map that the run begins with.
struct InitialMap {
  std::filesystem::path file;
  std::string bytes;  ///< "": none
};

/// The results at the end of the steps.
struct RunEnd {
  RunSummary summary;
  std::optional<GroundTruth> truth;
  std::optional<Timestamp> in_map_since;  ///< poses before it are not in the frame of the loaded map
  OdometryCounters counters;
  CalibrationCovariances covariances;
  std::function<std::optional<std::string>()> save_map;  ///< for on_summary
  // For on_end:
  FinalTrajectory final_trajectory;
  StageTimings timings;  ///< of the odometry
};

/// Observes a run and writes an output. The constructor throws InputError for invalid options, before the run folder
/// exists. All calls but on_due come from the thread of the run.
class RunObserver {
 public:
  RunObserver() = default;
  virtual ~RunObserver() = default;
  RunObserver(const RunObserver&) = delete;
  RunObserver& operator=(const RunObserver&) = delete;

  /// The stage of timing.json that on_step counts for; neighbours of one stage are timed together.
  virtual const char* stage() const { return "write"; }
  /// The folder exists.
  virtual void on_begin() {}
  /// Live runs: when the measurement is due, from the thread that plays the recording, until the end of the steps.
  virtual void on_due(const Measurement&) {}
  /// Called before the odometry gets the measurement.
  virtual void on_measurement(const Measurement&) {}
  virtual void on_step(const Step&) {}
  /// After the last step: before the joint optimization, and after each of its steps with the share that is done.
  virtual void on_optimization(double /*share*/) {}
  /// At the end of the steps: adds the results of this observer. Summary and truth are complete except for those of
  /// others.
  virtual void on_summary(RunEnd&) {}
  /// Writes its files. Also called after an error, to keep earlier results.
  virtual void on_end(const RunEnd&) {}
};

/// A kind of output of `edged run`. Its source describes it, and run_outputs.cpp lists it.
struct RunOutput {
  std::vector<const char*> files = {};                                 ///< that it writes into the run folder
  std::function<void(CLI::App& command, Board& options)> add_options;  ///< adds its flags; may be empty
  /// Makes its observer; nothing if this output is not requested.
  std::function<std::unique_ptr<RunObserver>(RunContext&)> make;
};

/// An output that each run has.
template <typename Observer>
RunOutput always(std::vector<const char*> files = {}) {
  return {std::move(files), {}, [](RunContext& run) { return std::make_unique<Observer>(run); }};
}

}  // namespace edged
