// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Data for viewers of a running run: rows of its plots, status changes, map points, dense points, images.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/even_sample.hpp"
#include "common/step_numbers.hpp"
#include "edged/step.hpp"
#include "outputs/snapshots.hpp"
#include "run/run_statistics.hpp"
#include "scene/live_points.hpp"

namespace edged {

/// The progress of a run.
struct RunProgress {
  RunStatistics statistics;
  double wall_s = 0;
  PacketPace pace;  ///< of the newest packet
};

/// `add` and `finish` are for the thread of the run, the rest for any thread. Keeps a bounded number of rows, spread
/// evenly over the run, and copies images only while there is a viewer.
class LiveFeed {
 public:
  static constexpr std::size_t kMostRows = 3000;

  /// What one viewer has received.
  struct Place {
    std::size_t rows = 0, halvings = 0, changes = 0, map = 0;
    std::size_t left_out = 0;  ///< updates skipped because this viewer was too slow
    LivePoints::Place dense = {};
  };

  /// Positions are those of `frame`, as in the trajectory files. dense: lives longer.
  LiveFeed(std::string frame, const LivePoints& dense);

  void add(const Step& step, RunProgress progress, const Snapshots& snapshots);
  /// The final numbers, as the last measurements are after the last step.
  void finish(RunProgress progress);

  void viewer_came() { ++viewers_; }
  void viewer_left() { --viewers_; }
  std::size_t viewers() const { return viewers_; }

  /// One line of json: the present numbers, and the rest that is new for this viewer (docs/report.md).
  std::string news(Place& place) const;
  /// The newest image with its tracks as JPEG, made by the caller's thread; empty where there is none. of: "events" and
  /// "frame" for the first camera of a kind, the name of another one.
  std::vector<unsigned char> picture(const std::string& of) const;

 private:
  struct Row {
    double t = 0;  ///< [s] since the first packet
    TrackingStatus status = TrackingStatus::Initializing;
    std::vector<double> values;  ///< NaN where there is none
  };
  struct Shot {
    std::size_t number = 0;  ///< 0: there is none
    std::chrono::steady_clock::time_point taken;
    cv::Mat image;
    std::vector<Track> tracks;
  };
  /// All guarded data; of large parts only new elements are copied.
  struct Present {
    Row newest;
    std::string reason;
    RunProgress progress;
    std::size_t rows = 0, changes = 0;  ///< number of elements before the first one here
    std::vector<Row> new_rows;
    std::vector<StatusChange> new_changes;
    std::vector<float> new_map;
    std::map<std::string, std::size_t> shots = {};  ///< numbers of the newest images
  };

  Row row_of(const Step& step, const PacketPace& pace);
  void take_shots(const Step& step);
  Present present(Place& place) const;
  static nlohmann::ordered_json columns(const std::vector<Row>& rows);

  std::string frame_;
  const LivePoints& dense_;
  std::atomic<std::size_t> viewers_ = 0;
  std::optional<Timestamp> origin_;  ///< set before there are rows or changes, and no more afterwards
  Eigen::Vector3d angles_;           ///< of the row before [deg]

  mutable std::mutex mutex_;  ///< guards all below
  Row newest_;
  std::string reason_;
  RunProgress progress_;
  EvenSample<Row> rows_{kMostRows};
  StatusChanges changes_;
  std::vector<float> map_;
  std::size_t map_number_ = 0;
  std::chrono::steady_clock::time_point map_taken_;
  std::map<std::string, std::shared_ptr<const Shot>> shots_;  ///< as picture() calls them
};

}  // namespace edged
