// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One run: from a recording and its options to the run folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "config_source.hpp"
#include "edged/live/live_source.hpp"
#include "edged/odometry.hpp"
#include "live_page.hpp"
#include "overview.hpp"
#include "packet_pace.hpp"
#include "report_path.hpp"
#include "run_album.hpp"
#include "run_check.hpp"
#include "run_folder.hpp"
#include "run_map.hpp"
#include "run_mcap.hpp"
#include "run_mode.hpp"
#include "run_summary.hpp"
#include "source.hpp"
#include "states_table.hpp"
#include "status_line.hpp"

namespace edged {

struct RunOptions {
  SourceOptions source;
  ConfigSource config;
  MapOptions map;
  std::string mode = "auto";
  std::string frame = "auto";
  std::filesystem::path out;
  std::vector<std::string> more;  ///< recordings, and options as key=value
  int jobs = 1;
  bool force = false;
  bool quiet = false;
  bool json = false;
  bool live = false;
  bool mcap = false;
  std::string archive;  ///< which file; "true" for the one beside the folder; "" for none
  std::string serve;    ///< where to; "true" where that is not said; "" without a live page
};

/// One run from the first measurement to the files' end.
class Run {
 public:
  /// Makes the run folder; `options` must outlive the run. Throws InputError for what cannot be run.
  Run(const RunOptions& options, Source source, Mode mode, const RunConfig& config);
  RunSummary go();

 private:
  std::optional<Measurement> next_measurement();
  std::optional<Measurement> read();
  void start_reading();
  void stop_reading();
  void check(const Measurement& measurement);
  void observe(const Step& step);
  void log_changes(const Step& step) const;
  void show_status(const Step& step);
  RunProgress progress() const { return {statistics_, writer_->poses(), meter_.wall_s(), pace_}; }
  RunSummary summarize();
  FinalTrajectory final_trajectory();
  void finish_mcap(const RunSummary& summary, const FinalTrajectory& known, const ReportPath& path);
  std::vector<std::string> headed(const std::string& known_when) const;
  void write_overview(const RunSummary& summary, const ReportPath& path) const;

  const RunOptions& options_;
  Source source_;
  Mode mode_;
  OutputFrame frame_;
  Rig used_;  ///< the cameras of the run
  RunCheck check_;
  std::filesystem::path folder_, archive_;
  StageTimings program_timings_;
  Odometry odometry_;
  RunMap map_;
  QueueConfig queue_config_;
  CalibrationConfig calibration_config_;
  std::optional<RunWriter> writer_;
  std::optional<PaceWriter> pace_writer_;
  PacketPace pace_;  ///< of the newest packet
  RunStatistics statistics_;
  LiveliestMoment moment_;
  RunAlbum album_;
  StatusLine status_line_;
  ResourceMeter meter_;
  std::optional<LiveSource> live_;   ///< plays the dataset in its own thread; in go() only
  std::optional<ReadAhead> reader_;  ///< reads the dataset in its own thread; in go() only
  std::optional<LivePage> page_;
  std::optional<RunMcap> mcap_;
  bool broken_off_ = false;  ///< an error ended the run
};

}  // namespace edged
