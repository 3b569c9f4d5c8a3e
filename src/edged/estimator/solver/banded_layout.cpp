// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/banded_layout.hpp"

#include <algorithm>
#include <limits>
#include <tuple>
#include <vector>

#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

/// Where blocks belong in time: a number that grows with the states.
class Times {
 public:
  Times(const Window& window, const Cost& cost) {
    for (const auto& [id, state] : window.states()) place_.emplace(id, place_.size());
    for (const LandmarkTerm& term : cost.landmarks)
      if (term.coupled) times_.emplace(BlockKey{BlockKind::InverseDepth, term.id}, term.anchor_place);
    // A parameter is that of the time of its first measurement; without any, as that before it.
    for (const auto& factor : cost.factors) {
      const std::size_t first = first_state(factor->blocks());
      for (const BlockKey& key : factor->blocks()) {
        if (is_state(key) || is_calibration(key) || key.kind == BlockKind::InverseDepth) continue;
        std::size_t& time = times_.try_emplace(key, kUnknown).first->second;
        time = std::min(time, first);
      }
    }
    std::size_t before = 0;
    for (auto& [key, time] : times_) {
      if (time == kUnknown) time = times_.contains({key.kind, key.id - 1}) ? before : 0;
      before = time;
    }
  }

  static bool is_state(const BlockKey& key) { return key.kind == BlockKind::Pose || key.kind == BlockKind::Motion; }
  std::size_t of(const BlockKey& key) const { return is_state(key) ? place_.at(key.id) : times_.at(key); }

 private:
  static constexpr std::size_t kUnknown = std::numeric_limits<std::size_t>::max();
  std::size_t first_state(const std::vector<BlockKey>& blocks) const {
    std::size_t first = kUnknown;
    for (const BlockKey& key : blocks)
      if (is_state(key)) first = std::min(first, place_.at(key.id));
    return first;
  }

  std::map<StateId, std::size_t> place_;
  std::map<BlockKey, std::size_t> times_;
};

/// The older poses of the factors between poses that lie far apart.
std::set<BlockKey> revisited(const Cost& cost, const Times& times) {
  std::set<BlockKey> poses;
  for (const auto& factor : cost.factors) {
    std::size_t last = 0;
    for (const BlockKey& key : factor->blocks())
      if (key.kind == BlockKind::Pose) last = std::max(last, times.of(key));
    for (const BlockKey& key : factor->blocks())
      if (key.kind == BlockKind::Pose && times.of(key) + kSolverTuning.band_states < last) poses.insert(key);
  }
  return poses;
}

std::vector<EnvelopeMatrix::Rows> envelope_of(const Cost& cost, const Layout& layout,
                                              const std::vector<BlockKey>& order) {
  std::map<BlockKey, Eigen::Index> first = layout.offset;
  for_each_term(cost, [&](std::span<const BlockKey> blocks) {
    Eigen::Index least = layout.size;
    for (const BlockKey& key : blocks) least = std::min(least, layout.offset.at(key));
    for (const BlockKey& key : blocks) first.at(key) = std::min(first.at(key), least);
  });
  std::vector<EnvelopeMatrix::Rows> rows;
  rows.reserve(order.size());
  for (const BlockKey& key : order) rows.push_back({tangent_size(key.kind), first.at(key)});
  return rows;
}

}  // namespace

Layout banded_layout(const Window& window, const Cost& cost) {
  const Times times(window, cost);
  const std::set<BlockKey> border = revisited(cost, times);
  std::vector<std::tuple<int, std::size_t, bool, BlockKey>> places;
  for (const BlockKey& key : blocks_of(cost)) {
    if (is_calibration(key)) {
      places.emplace_back(2, 0, false, key);
    } else {
      places.emplace_back(border.contains(key) ? 1 : 0, times.of(key), key.kind == BlockKind::Pose, key);
    }
  }
  std::ranges::sort(places);
  std::vector<BlockKey> order;
  order.reserve(places.size());
  for (const auto& place : places) order.push_back(std::get<BlockKey>(place));
  Layout layout(order);
  layout.envelope = envelope_of(cost, layout, order);
  return layout;
}

}  // namespace edged
