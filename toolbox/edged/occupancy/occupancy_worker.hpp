// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The occupancy map of a run that goes on, in a thread of its own, which a bounded queue feeds.
#pragma once

#include <octomap/OcTree.h>

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "edged/keyframe_record.hpp"
#include "edged/occupancy/occupancy_slice.hpp"
#include "edged/time.hpp"

namespace edged {

/// In the map frame; what the map corrects later stays where it was.
struct OccupancyMap {
  octomap::OcTree tree;
  HeightRange path;  ///< heights of the body at the keyframes
  Timestamp t;       ///< stamp of the newest keyframe
  /// Keyframes that are missing: too many waited, or the tree was full.
  std::size_t left_out = 0;
};

class OccupancyWorker {
 public:
  static constexpr std::size_t kCapacity = 100;           // keyframes that may wait
  static constexpr std::size_t kMostNodes = 10'000'000;   // of the tree, about 500 MB
  using Show = std::function<void(const OccupancyMap&)>;  ///< does not throw

  /// show: gets the map from the thread of the worker, after the first keyframe, then once so many seconds of keyframes
  /// have been added, and at the end.
  OccupancyWorker(double voxel_m, double period_s, Show show);
  ~OccupancyWorker();  ///< works off what waits
  OccupancyWorker(const OccupancyWorker&) = delete;
  OccupancyWorker& operator=(const OccupancyWorker&) = delete;

  /// Takes the keyframes of a step. Never blocks: keyframes beyond the capacity are left out, and so are those of a
  /// tree that is full.
  void add(const std::vector<KeyframeRecord>& marginalized);

 private:
  void work();
  void insert(const KeyframeRecord& keyframe);

  const Duration period_;
  const Show show_;
  OccupancyMap map_;              // of the thread
  std::size_t not_inserted_ = 0;  // keyframes; of the thread
  std::mutex mutex_;
  std::condition_variable more_;
  std::deque<KeyframeRecord> queue_;
  std::size_t not_queued_ = 0;  // keyframes
  bool closed_ = false;
  std::jthread thread_;  // last member: it uses the others
};

}  // namespace edged
