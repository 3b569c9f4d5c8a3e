// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The interface of observers of a run. Each output is one observer, with its line in each list of run_observer.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/config_source.hpp"
#include "common/source.hpp"
#include "edged/camera/output_frame.hpp"
#include "edged/odometry.hpp"
#include "report/report_path.hpp"
#include "run/dense_scan.hpp"
#include "run/live_points.hpp"
#include "run/run_album.hpp"
#include "run/run_options.hpp"
#include "run/run_statistics.hpp"
#include "run/run_summary.hpp"

namespace edged {

/// Data for observers; it lives as long as the run.
struct RunContext {
  RunContext(const RunOptions& run_options, Source recording, Mode run_mode, const RunConfig& run_config);

  const DatasetInfo& info() const { return source.dataset->info(); }
  /// The rig for poses of cameras, as found so far.
  Rig found_rig() const;
  /// `frame` in that rig.
  OutputFrame found_frame() const { return {found_rig(), frame.name()}; }
  /// Comments at the head of a trajectory file.
  std::vector<std::string> heading(const OutputFrame& of, const std::string& known_when) const;

  const RunOptions& options;
  Source source;
  Mode mode;
  RunConfig config;
  OutputFrame frame;  ///< whose pose the trajectory files hold, by the given calibration
  Rig used;           ///< the cameras of the run
  Odometry odometry;
  std::filesystem::path folder, archive;  ///< the second: "" for none
  StageTimings timings;                   ///< of the program
  ResourceMeter meter;
  PacketPace pace;               ///< of the newest step
  RunStatistics statistics;      ///< with all steps, the newest included
  RunAlbum album;                ///< the same
  std::vector<DenseScan> dense;  ///< points of --dense, once its observer has ended
  LivePoints live_points;        ///< the same so far, with --serve
};

/// The results at the end of the steps.
struct RunEnd {
  RunSummary summary;
  std::optional<GroundTruth> truth;
  std::optional<Timestamp> in_map_since;  ///< poses before it are not in the frame of the loaded map
  FinalTrajectory known;
  ReportPath path;  ///< the causal trajectory, aligned with the truth
};

/// The constructor throws InputError for invalid options, before the run folder exists. All calls but on_due come from
/// the thread of the run.
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
  /// At the end of the steps: adds the results of this observer. Summary and truth are complete except for those of
  /// others.
  virtual void on_summary(RunEnd&) {}
  /// Writes its files. Also called after an error, to keep earlier results.
  virtual void on_end(const RunEnd&) {}
};

/// The observers of a run, in the order of their calls.
std::vector<std::unique_ptr<RunObserver>> make_observers(RunContext& run);

/// Makes an observer, or nothing if its output is not requested. Each is defined beside its output.
using ObserverFactory = std::unique_ptr<RunObserver>(RunContext& run);
ObserverFactory observe_status_line, observe_log;  // run_log
ObserverFactory observe_verdict;                   // verdict
ObserverFactory observe_map;                       // run_map
ObserverFactory observe_states;                    // run_writer
ObserverFactory observe_external;                  // external_log
ObserverFactory observe_final_trajectory;          // final_trajectory
ObserverFactory observe_export;                    // run_export
ObserverFactory observe_dense;                     // run_dense
ObserverFactory observe_occupancy;                 // run_occupancy
ObserverFactory observe_summary;                   // run_summary
ObserverFactory observe_overview;                  // overview
ObserverFactory observe_album;                     // run_album
ObserverFactory observe_report;                    // run_observer
ObserverFactory observe_mcap;                      // run_mcap
ObserverFactory observe_live_page;                 // live_page
ObserverFactory observe_autopilot;                 // autopilot

}  // namespace edged
