// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The summary of a run: metrics.json, and the short table at its end.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "edged/checks/calibration_fit.hpp"
#include "edged/checks/found_imu_clock.hpp"
#include "edged/counters.hpp"
#include "edged/dataset.hpp"
#include "edged/eval/consistency.hpp"
#include "edged/eval/metrics.hpp"
#include "edged/eval/time_offset.hpp"
#include "edged/live/measurement_queue.hpp"
#include "edged/timing.hpp"
#include "report/report_path.hpp"
#include "run/run_statistics.hpp"

namespace edged {

/// Figures of a run: values of metrics.json, and lines of the table.
struct Figures {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  std::string table;

  /// A line of the table: NAME VALUE NOTE.
  void line(const std::string& name, const std::string& value, const std::string& note = "");
};

/// What was run, and where its files are.
struct RunIdentity {
  std::string recording, format, mode, frame, folder;
  std::string archive;  ///< archive of the folder; "": not requested
  std::optional<int> seed;
  bool localize_only = false;    ///< there are poses only while the body is localized in a loaded map
  double max_scale_sigma = 0.0;  ///< option of the status
};

struct Verdict {
  /// "good", "degraded", "not to be trusted" (with a pose to the end, but contradicted), "lost", "never good",
  /// "interrupted" or "broken off" (by an error)
  std::string status;
  std::vector<Finding> findings;  ///< warnings and errors
  bool contradicted = false;      ///< by recording, calibration, the estimate itself, or ground truth
  bool trusted = true;            ///< not contradicted, and there is a result
  std::string text;               ///< in one line, wherever it is shown
  std::string waiting_for;        ///< never good, or lost at the end: the last reason
  std::string next;               ///< the next step: a command, or the page to open
};

struct RunResources {
  double wall_s = 0, cpu_s = 0, peak_rss_mb = 0;
};

/// Latency and drops of a live run.
struct LiveSummary {
  StageTiming latency;              ///< from when a measurement was due to its result
  DropCounters dropped;             ///< by the queue before the packetizer
  std::size_t dropped_packets = 0;  ///< by the packetizer, while the IMU stayed away
  QueuePeaks peaks;
  double max_age_s = 0.0;  ///< that was allowed to wait
};

/// The trajectory of a run beside the ground truth; empty without one.
struct TruthComparison {
  std::optional<Evaluation> evaluation;        ///< SE(3) on all poses
  std::optional<Evaluation> final_evaluation;  ///< SE(3) on all poses of the final trajectory, not causal
  std::optional<Consistency> consistency;
  std::optional<TimeOffset> offset;           ///< of the stamps of the truth
  std::map<std::string, double> mpe_percent;  ///< per protocol P1..P4 that could be applied
};

struct RunSummary {
  RunIdentity run;
  Verdict verdict;
  RunStatistics statistics;
  RunResources resources;
  TruthComparison truth;
  std::vector<CalibrationFound> calibration;
  std::optional<ChosenImuClock> imu_clock;     ///< of --imu-time-offset auto
  std::map<std::string, std::size_t> repairs;  ///< by the reader and the packetizer, zero counts left out
  Figures outputs;                             ///< what the outputs of the run add
  std::optional<LiveSummary> live;
  std::vector<std::string> unwritten;  ///< outputs that could not be written, and why
};

/// Compares the poses as published with the ground truth, both of `frame`; and, by the calibration that the run
/// estimated in the end, which `frame` has, the stamps of the truth, and the body's errors with their covariances: a
/// wrong lever arm is none of these. Without evaluation, and with the reason in the log, if that is not possible.
TruthComparison compare_with_truth(const CausalPoses& poses, const std::vector<StateCovarianceSample>& samples,
                                   const OutputFrame& frame, const GroundTruth& truth);

/// Unused measurements, in plain words.
void add_dropped(std::map<std::string, std::size_t>& repairs, const OdometryCounters& counters);

nlohmann::ordered_json to_json(const RunSummary& summary);
std::string to_table(const RunSummary& summary);

/// Count, mean, p50, p95, p99, total and, where it was taken, processor time of every stage, as json text.
std::string timing_json(const StageTimings& pipeline, const StageTimings& program);

}  // namespace edged
