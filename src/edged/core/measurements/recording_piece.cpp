// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/core/measurements/recording_piece.hpp"

#include <algorithm>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

InputError beyond_the_end(const DatasetInfo& info, double from_s, Duration length) {
  return InputError::format("{}: --from {:g} is beyond its end: it is {:.3f} s long; give less", info.name, from_s,
                            to_seconds(length));
}

}  // namespace

RecordingPiece::RecordingPiece(std::unique_ptr<Dataset> whole, const PieceBounds& bounds)
    : whole_(std::move(whole)), info_(whole_->info()), bounds_(bounds) {
  if (bounds.to_s && bounds.from_s >= *bounds.to_s)
    throw InputError::format("{}: --from {:g} to --to {:g} holds nothing; --to must be the later one", info_.name,
                             bounds.from_s, *bounds.to_s);
  left_ = {info_.has_events, info_.has_frames, info_.has_imu};
  std::optional<Timestamp> begin = info_.begin;
  while (!begin && (first_ = whole_->next())) begin = first_stamp(*first_);
  if (!begin) throw InputError::format("{}: nothing to read", info_.name);
  from_ = *begin + duration_from_seconds(bounds.from_s);
  to_ = bounds.to_s ? *begin + duration_from_seconds(*bounds.to_s) : Timestamp::max();
  if (info_.end && from_ > *info_.end) throw beyond_the_end(info_, bounds.from_s, *info_.end - *begin);
  info_.begin = from_;
  if (info_.end) info_.end = std::min(*info_.end, to_);
}

std::optional<Measurement> RecordingPiece::read() {
  return first_ ? std::exchange(first_, std::nullopt) : whole_->next();
}

std::optional<Measurement> RecordingPiece::cut(Measurement measurement) {
  const std::optional<Timestamp> last = last_stamp(measurement);
  if (!last) return std::nullopt;
  newest_ = std::max(newest_, *last);
  auto* batch = std::get_if<EventBatch>(&measurement);
  if (*last >= to_) {
    if (batch) left_.events = false;
    if (std::holds_alternative<Frame>(measurement)) left_.frames = false;
    if (std::holds_alternative<ImuSample>(measurement)) left_.imu = false;
  }
  if (!batch) return *last >= from_ && *last < to_ ? std::optional(std::move(measurement)) : std::nullopt;
  std::vector<Event>& events = batch->events;
  events.erase(std::ranges::lower_bound(events, to_, {}, &Event::t), events.end());
  events.erase(events.begin(), std::ranges::lower_bound(events, from_, {}, &Event::t));
  return events.empty() ? std::nullopt : std::optional(std::move(measurement));
}

/// The end of the piece does not wait for these.
void RecordingPiece::leave_out(Modality unwanted) {
  whole_->leave_out(unwanted);
  (unwanted == Modality::Events ? left_.events : left_.frames) = false;
}

std::optional<Measurement> RecordingPiece::next() {
  // The sensors' clocks may differ, so the others may still have measurements before the end.
  while (!all_past()) {
    std::optional<Measurement> measurement = read();
    if (!measurement) break;
    if (std::optional<Measurement> kept = cut(std::move(*measurement))) {
      empty_ = false;
      return kept;
    }
  }
  if (empty_ && newest_ < from_)
    throw beyond_the_end(info_, bounds_.from_s, newest_ - from_ + duration_from_seconds(bounds_.from_s));
  return std::nullopt;
}

std::optional<GroundTruth> RecordingPiece::ground_truth() const {
  std::optional<GroundTruth> truth = whole_->ground_truth();
  if (!truth) return truth;
  Trajectory& poses = truth->trajectory;
  const auto after = std::ranges::lower_bound(poses, to_, {}, &StampedPose::t);
  if (after != poses.end()) poses.erase(after + 1, poses.end());
  const auto begin = std::ranges::lower_bound(poses, from_, {}, &StampedPose::t);
  if (begin != poses.begin()) poses.erase(poses.begin(), begin - 1);
  return truth;
}

}  // namespace edged
