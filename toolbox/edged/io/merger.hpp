// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Measurements of several streams, as they come from a file, put into the order that Dataset promises.
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/core/external_sensor.hpp"
#include "edged/core/measurement_stamps.hpp"
#include "edged/core/stream_order.hpp"
#include "edged/io/ahead_gate.hpp"
#include "edged/io/repairs.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// A batch of events spans no more.
inline constexpr Duration kLongestBatch = std::chrono::milliseconds(5);

/// The items of one stream, T with a `time_of`, sorted although they may come a little out of order. Stamps
/// far ahead pass an AheadGate first.
template <typename T>
class ArrivalQueue {
 public:
  /// subject: begins the kinds of repairs. max_held: more than this are not held back, whatever the other streams do.
  ArrivalQueue(std::string subject, bool stamps_repeat, std::size_t max_held, Repairs& repairs)
      : subject_(std::move(subject)), stamps_repeat_(stamps_repeat), max_held_(max_held), repairs_(repairs) {}

  void push(T item);
  /// Many; those that simply follow each other go in at once.
  void push(std::span<const T> items);
  /// Nothing more will come.
  void finish();
  /// What is held is not wanted.
  void clear() { sorted_.clear(); }

  const T* peek() const { return sorted_.empty() ? nullptr : &sorted_.front(); }
  Timestamp next_stamp() const { return sorted_.empty() ? Timestamp::max() : time_of(sorted_.front()); }
  T pop();
  /// Those before `end`, at most so many.
  std::vector<T> pop_before(Timestamp end, std::size_t most);

  /// Stamp of the last arrival.
  std::optional<Timestamp> last() const { return last_; }
  /// What is before this has to leave, as too much is held.
  Timestamp overflow() const {
    return sorted_.size() <= max_held_ ? Timestamp::min() : time_of(sorted_[sorted_.size() - max_held_]) + Duration(1);
  }

 private:
  void insert(T item);
  Timestamp newest() const { return gate_.newest().value_or(Timestamp::min()); }
  std::size_t count_in_order(std::span<const T> items) const;

  std::string subject_;
  bool stamps_repeat_;
  std::size_t max_held_;
  Repairs& repairs_;
  std::deque<T> sorted_;
  AheadGate<T> gate_;
  std::optional<Timestamp> last_;
  Timestamp handed_out_ = Timestamp::min();  ///< what is before comes too late
};

/// Push what the file gives, pop what is ready: `while (!(m = merger.pop()) && more) push(...)`. Holds back what an
/// expected stream may still precede, but no more than a few million events, and waits no longer than a second of
/// recording for a stream that is silent. A stream that is farther behind the others, by another clock for instance,
/// comes late, but whole: within it, order holds always. Its items that are out of order are sorted in, or left out
/// where what follows them has been handed out; both are counted.
class Merger {
 public:
  struct Streams {
    bool events = false, frames = false, imu = false;
    std::string event_camera = "events";
  };

  explicit Merger(Repairs& repairs);

  /// Streams to wait for; before any push.
  void expect(const Streams& streams);

  /// What has come of that stream is forgotten, and it is not waited for; none of it may be pushed any more.
  void leave_out(Modality unwanted);

  void push(std::span<const Event> events);
  void push(Frame frame);
  void push(const ImuSample& sample);
  /// Is never waited for: it comes in its place where it is not later in the file than what follows it.
  void push(const ExternalSample& sample);
  /// The file has ended: all that is held gets ready.
  void finish();

  /// The next measurement, or nothing: push more, or after finish() the end.
  std::optional<Measurement> pop();

 private:
  /// How far a stream has come, and where the newest of all was when it last delivered.
  struct Pace {
    bool expected = false;
    std::optional<Timestamp> last, heard;
  };
  void note(Pace& pace, std::optional<Timestamp> last);
  Timestamp horizon() const;
  ArrivalQueue<ExternalSample>& next_external();
  EventBatch take_events(Timestamp end);

  std::string event_camera_;
  Pace event_pace_, frame_pace_, imu_pace_;
  std::optional<Timestamp> begin_, newest_;  ///< first and newest stamp of all
  ArrivalQueue<Event> events_;
  ArrivalQueue<Frame> frames_;
  ArrivalQueue<ImuSample> imu_;
  std::vector<ArrivalQueue<ExternalSample>> external_;  ///< one a sensor
  bool finished_ = false;
};

}  // namespace edged
