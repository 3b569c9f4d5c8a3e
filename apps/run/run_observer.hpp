// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a run tells its observers. An output is one observer, with its line in each list of run_observer.
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
#include "run/run_album.hpp"
#include "run/run_options.hpp"
#include "run/run_statistics.hpp"
#include "run/run_summary.hpp"

namespace edged {

/// What observers look at; it lives as long as the run.
struct RunContext {
  RunContext(const RunOptions& run_options, Source recording, Mode run_mode, const RunConfig& run_config);

  const DatasetInfo& info() const { return source.dataset->info(); }
  /// Comments at the head of a trajectory file.
  std::vector<std::string> heading(const std::string& known_when) const;

  const RunOptions& options;
  Source source;
  Mode mode;
  RunConfig config;
  OutputFrame frame;  ///< whose pose the trajectory files hold
  Rig used;           ///< the cameras of the run
  Odometry odometry;
  std::filesystem::path folder, archive;  ///< the second: "" where none is asked for
  StageTimings timings;                   ///< of the program
  ResourceMeter meter;
  PacketPace pace;           ///< of the newest step
  RunStatistics statistics;  ///< by all steps, the newest included
  RunAlbum album;            ///< the same
};

/// What is known when no more steps come.
struct RunEnd {
  RunSummary summary;
  std::optional<GroundTruth> truth;
  std::optional<Timestamp> in_map_since;  ///< poses before are not in the frame of the map that was given
  FinalTrajectory known;
  ReportPath path;  ///< as it was known at the time, laid onto the truth
};

/// The constructor refuses what cannot be done, before there is a run folder. All calls come from the thread of the
/// run.
class RunObserver {
 public:
  RunObserver() = default;
  virtual ~RunObserver() = default;
  RunObserver(const RunObserver&) = delete;
  RunObserver& operator=(const RunObserver&) = delete;

  /// The stage of timing.json that on_step counts for; neighbours of one stage are timed together.
  virtual const char* stage() const { return "write"; }
  /// The folder is there.
  virtual void on_begin() {}
  /// Before the odometry gets it.
  virtual void on_measurement(const Measurement&) {}
  virtual void on_step(const Step&) {}
  /// No more steps come: adds what only this observer knows. Summary and truth are there but for what others add.
  virtual void on_summary(RunEnd&) {}
  /// Writes what it has to. Also after an error, so that what came before it stays.
  virtual void on_end(const RunEnd&) {}
};

/// Those that the run asks for, in the order in which they are told.
std::vector<std::unique_ptr<RunObserver>> make_observers(RunContext& run);

/// Makes an observer, or nothing where the run does not ask for it. Each is defined beside what it writes.
using ObserverFactory = std::unique_ptr<RunObserver>(RunContext& run);
ObserverFactory observe_status_line, observe_log;  // run_log
ObserverFactory observe_verdict;                   // verdict
ObserverFactory observe_map;                       // run_map
ObserverFactory observe_states;                    // run_writer
ObserverFactory observe_external;                  // external_log
ObserverFactory observe_final_trajectory;          // final_trajectory
ObserverFactory observe_summary;                   // run_summary
ObserverFactory observe_overview;                  // overview
ObserverFactory observe_album;                     // run_album
ObserverFactory observe_report;                    // run_observer
ObserverFactory observe_mcap;                      // run_mcap
ObserverFactory observe_live_page;                 // live_page

}  // namespace edged
