// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/archive/record_file.hpp"

#include <algorithm>

namespace edged {

std::optional<RecordPlace> RecordFile::next_place() {
  while (at_ < end_) {
    std::string reason;
    try {
      const RecordPlace place = checked_place();
      good_ = place.closed ? place.end() - 1 : place.begin;
      at_ = place.end();
      return place;
    } catch (const Damage& damage) {
      reason = damage.what();
    }
    if (!resynchronize(reason)) break;
  }
  return std::nullopt;
}

RecordPlace RecordFile::checked_place() {
  const RecordPlace place = locate(at_);
  const auto listed = index_.upper_bound(at_);
  if (listed != index_.end() && listed->first < place.end() && can_be_located(listed->first))
    throw Damage("covers the record that the index lists at byte " + std::to_string(listed->first));
  // At the end of a recording that was cut no record follows.
  if (index_.empty() && !place.closed && place.end() > end_ && search(place.data)) throw Damage("covers other records");
  return place;
}

bool RecordFile::can_be_located(std::uint64_t at) try {
  locate(at);
  return true;
} catch (const Damage&) {
  return false;
}

std::optional<std::uint64_t> RecordFile::search(std::uint64_t from) {
  constexpr std::size_t kStep = 1 << 20;
  for (; from < end_; from += kStep) {
    const Bytes block = file_.read(from, kStep + kLookAhead);
    for (std::size_t i = 0; i < std::min(kStep, block.size()); ++i)
      if (begins_record(ByteSpan(block).subspan(i)) && can_be_located(from + i)) return from + i;
  }
  return std::nullopt;
}

bool RecordFile::resynchronize(const std::string& reason) {
  std::optional<std::uint64_t> next;
  if (index_.empty()) {
    next = search(std::max(good_ + 1, searched_to_));
    if (next == at_) next = search(at_ + 1);
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
