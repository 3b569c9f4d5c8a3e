// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The summary of a run: metrics.json, and the short table at its end.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "edged/camera/output_frame.hpp"
#include "edged/counters.hpp"
#include "edged/dataset.hpp"
#include "edged/eval/consistency.hpp"
#include "edged/eval/metrics.hpp"
#include "edged/eval/time_offset.hpp"
#include "edged/live/measurement_queue.hpp"
#include "edged/timing.hpp"
#include "run/run_statistics.hpp"
#include "run/verdict.hpp"

namespace edged {

/// Latency and drops of a live run.
struct LiveSummary {
  StageTiming latency;           ///< from when a measurement was due to its result
  ShedCounters shed;             ///< by the queue before the packetizer
  std::size_t shed_packets = 0;  ///< by the packetizer, while the IMU stayed away
  QueuePeaks peaks;
  double max_age_s = 0.0;  ///< that was allowed to wait
};

/// The results of --map and --save-map.
struct MapSummary {
  std::string loaded;             ///< file; empty: none was given
  bool localize_only = false;     ///< there are poses only while localized in it
  std::optional<double> found_s;  ///< from the start of the estimate until the first relocalization in it
  std::size_t relocalized = 0;    ///< how many times, also after losses: the pose has jumped so often
  std::string saved;              ///< file; empty: not requested, or there is nothing to save
};

/// What became of the samples of a height or velocity sensor. The rest came before the first pose, while lost, or after
/// the last packet.
struct ExternalSummary {
  std::size_t samples = 0, used = 0, rejected = 0, late = 0;
};

/// The results of --dense.
struct DenseSummary {
  std::size_t keyframes = 0, without_parallax = 0, dropped = 0;  ///< with depth; without; live, while it was too slow
  std::size_t edges = 0, with_depth = 0;                         ///< edge pixels of those with depth
};

struct RunSummary {
  std::string recording, format, mode, frame, folder;
  std::string archive;  ///< archive of the folder; "": not requested
  std::optional<int> seed;
  /// "good", "degraded", "not to be trusted" (with a pose to the end, but contradicted), "lost", "never good",
  /// "interrupted" or "broken off" (by an error)
  std::string status;
  Verdict verdict;
  RunStatistics statistics;
  std::size_t poses = 0;
  double wall_s = 0, cpu_s = 0, peak_rss_mb = 0;
  std::optional<LiveSummary> live;
  std::optional<MapSummary> map;
  std::optional<DenseSummary> dense;
  std::vector<CalibrationFound> calibration;
  std::map<std::string, ExternalSummary> external;  ///< by sensor
  std::map<std::string, std::size_t> repairs;       ///< by the reader and the packetizer, zero counts left out
  std::optional<Evaluation> evaluation;             ///< SE(3) on all poses; nothing without ground truth
  std::optional<Evaluation> final_evaluation;       ///< the same of the final trajectory, not causal
  std::optional<Consistency> consistency;           ///< nothing without ground truth
  std::optional<TimeOffset> truth_offset;           ///< the same
  std::map<std::string, double> mpe_percent;        ///< per protocol P1..P4 that could be applied
  std::vector<std::string> unwritten;               ///< outputs that could not be written, and why
};

/// Compares the body's poses with the ground truth, in the ground truth's frame by the given calibration, as the
/// trajectory files have them; and their errors with their covariances, in the body's frame by the calibration that the
/// run found: a wrong lever arm is no error of the body's pose. Leaves the summary without evaluation, and logs the
/// reason, if that is not possible.
void evaluate_run(RunSummary& summary, const Trajectory& body, const std::vector<StateCovarianceSample>& samples,
                  const Rig& rig, const GroundTruth& truth);

/// The same of the final trajectory, which has as many poses.
void evaluate_final(RunSummary& summary, const Trajectory& body, const Rig& rig, const GroundTruth& truth);

/// Unused measurements, in plain words.
void add_dropped(std::map<std::string, std::size_t>& repairs, const OdometryCounters& counters);

nlohmann::ordered_json to_json(const RunSummary& summary);
std::string to_table(const RunSummary& summary);

/// Count, mean, p50, p95, p99, total and, where it was taken, processor time of every stage, as json text.
std::string timing_json(const StageTimings& pipeline, const StageTimings& program);

}  // namespace edged
