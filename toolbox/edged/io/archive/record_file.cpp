// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/archive/record_file.hpp"

#include <algorithm>
#include <utility>

namespace edged {

std::optional<RecordPlace> RecordFile::next_place() {
  while (at_ < end_) {
    std::string reason;
    try {
      const RecordPlace place = locate(at_);
      good_ = std::exchange(at_, place.end());
      return place;
    } catch (const Damage& damage) {
      reason = damage.what();
    }
    if (!resynchronize(reason)) break;
  }
  return std::nullopt;
}

bool RecordFile::resynchronize(const std::string& reason) {
  std::optional<std::uint64_t> next;
  if (index_.empty()) {
    next = search(std::max(good_ + 1, searched_to_));
  } else {
    auto listed = index_.upper_bound(good_);
    if (listed != index_.end() && listed->first == at_) ++listed;
    if (listed != index_.end()) next = listed->first;
  }
  count_damage(at_, reason, next);
  at_ = good_ = next.value_or(end_);
  searched_to_ = at_ + 1;
  return next.has_value();
}

}  // namespace edged
