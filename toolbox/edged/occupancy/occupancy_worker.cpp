// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/occupancy/occupancy_worker.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "edged/occupancy/occupancy_scan.hpp"

namespace edged {

OccupancyWorker::OccupancyWorker(double voxel_m, double period_s, Show show)
    : period_(duration_from_seconds(period_s)),
      show_(std::move(show)),
      map_{octomap::OcTree(voxel_m), {}, {}},
      thread_([this] { work(); }) {}

OccupancyWorker::~OccupancyWorker() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  more_.notify_one();
}

void OccupancyWorker::add(const std::vector<KeyframeRecord>& marginalized) {
  if (marginalized.empty()) return;
  {
    const std::lock_guard lock(mutex_);
    for (const KeyframeRecord& keyframe : marginalized) {
      if (queue_.size() < kCapacity) {
        queue_.push_back(keyframe);
      } else {
        ++not_queued_;
      }
    }
  }
  more_.notify_one();
}

void OccupancyWorker::work() {
  std::optional<Timestamp> shown;
  for (bool more = true; more;) {
    std::unique_lock lock(mutex_);
    more_.wait(lock, [this] { return closed_ || !queue_.empty(); });
    more = !queue_.empty();
    KeyframeRecord keyframe;
    if (more) {
      keyframe = std::move(queue_.front());
      queue_.pop_front();
    }
    const std::size_t not_queued = not_queued_;
    lock.unlock();
    if (more) insert(keyframe);
    map_.left_out = not_queued + not_inserted_;
    const bool due = !shown || map_.t < *shown || map_.t - *shown >= period_ || (!more && map_.t != *shown);
    if (map_.tree.size() == 0 || !due) continue;
    shown = map_.t;
    map_.tree.updateInnerOccupancy();
    map_.tree.prune();
    show_(map_);
  }
}

void OccupancyWorker::insert(const KeyframeRecord& keyframe) {
  map_.t = keyframe.t;
  if (map_.tree.size() > kMostNodes) {
    ++not_inserted_;
    return;
  }
  const double z = keyframe.T_W_B.translation().z();
  map_.path = map_.tree.size() == 0 ? HeightRange{z, z}
                                    : HeightRange{std::min(map_.path.low_m, z), std::max(map_.path.high_m, z)};
  insert_keyframe(map_.tree, keyframe);
}

}  // namespace edged
