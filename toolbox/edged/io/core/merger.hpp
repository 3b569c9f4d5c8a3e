// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Merges measurements of several streams of a file into the order that Dataset guarantees.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/core/measurements/external_sensor.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/core/measurements/stream_order.hpp"
#include "edged/io/parse/repairs.hpp"
#include "edged/io/parse/stamp_jump_filter.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// The longest time that a batch of events spans.
inline constexpr Duration kLongestBatch = std::chrono::milliseconds(5);

/// The items of one stream, T with a `time_of`, sorted by their stamps. They may arrive slightly out of order. An
/// StampJumpFilter checks for stamps far ahead.
template <typename T>
class ArrivalQueue {
 public:
  /// subject: the prefix of the kinds of repairs. max_held: the largest number of held items, also if other streams
  /// lag.
  ArrivalQueue(std::string subject, bool stamps_repeat, std::size_t max_held, Repairs& repairs)
      : subject_(std::move(subject)), stamps_repeat_(stamps_repeat), max_held_(max_held), repairs_(repairs) {}

  void push(T item);
  /// Many items. Those in order are added at once.
  void push(std::span<const T> items);
  /// The end of the stream.
  void finish();
  /// Discards the held items.
  void clear() { sorted_.clear(), first_ = 0; }

  Timestamp next_stamp() const { return first_ == sorted_.size() ? Timestamp::max() : time_of(sorted_[first_]); }
  T pop();
  /// The items before `end`, at most `most` of them.
  std::vector<T> pop_before(Timestamp end, std::size_t most);

  /// Stamp of the last arrival.
  std::optional<Timestamp> last() const { return last_; }
  /// Items before this stamp must be popped, because too many are held.
  Timestamp overflow() const {
    if (sorted_.size() - first_ <= max_held_) return Timestamp::min();
    return time_of(sorted_[sorted_.size() - max_held_]) + Duration(1);
  }

 private:
  void insert(T item);
  void drop_popped();
  Timestamp newest() const { return jump_filter_.newest().value_or(Timestamp::min()); }
  std::size_t count_in_order(std::span<const T> items) const;

  std::string subject_;
  bool stamps_repeat_;
  std::size_t max_held_;
  Repairs& repairs_;
  std::vector<T> sorted_;  ///< from first_ on; those before have been popped
  std::size_t first_ = 0;
  StampJumpFilter<T> jump_filter_;
  std::optional<Timestamp> last_;
  Timestamp handed_out_ = Timestamp::min();  ///< items before this stamp are too late
};

/// Use: `while (!(m = merger.pop()) && more) push(...)`. Holds measurements that an expected stream may still precede,
/// but at most a few million events, and waits at most one second of recording for a silent stream. A stream that lags
/// more, for instance by another clock, is returned late, but completely. Each stream is always in order: its items out
/// of order are sorted in, or left out if later items have been returned. Both are counted.
class Merger {
 public:
  struct Streams {
    std::vector<std::string> events = {}, frames = {};  ///< names of the cameras
    bool imu = false;
  };

  explicit Merger(Repairs& repairs);

  /// Sets the streams to wait for. Before any push().
  void expect(const Streams& streams);

  /// Discards the held items of those streams and does not wait for them. They must not be pushed any more.
  void leave_out(Modality unwanted);

  /// camera: its place among those of its kind. A stream that is not expected may be pushed as the first.
  void push(std::span<const Event> events, std::size_t camera = 0);
  /// The name of the camera is that of Streams.
  void push(Frame frame, std::size_t camera = 0);
  void push(const ImuSample& sample);
  /// Never waited for. It is in order unless later measurements precede it in the file.
  void push(const ExternalSample& sample);
  /// The end of the file: all held measurements become ready.
  void finish();

  /// The next measurement. Nothing if more has to be pushed, or at the end after finish().
  std::optional<Measurement> pop();

 private:
  /// What has arrived of a stream.
  struct Arrival {
    bool expected = false;
    std::optional<Timestamp> last_stamp;   ///< the last of the stream
    std::optional<Timestamp> newest_then;  ///< the newest stamp of all streams at that time
  };
  template <typename T>
  struct Camera {
    std::string name;
    ArrivalQueue<T> queue;
    Arrival arrival = {};
  };
  void note_arrival(Arrival& arrival, std::optional<Timestamp> last_stamp);
  Timestamp complete_until() const;
  ArrivalQueue<ExternalSample>& next_external();
  EventBatch take_events(Camera<Event>& camera, Timestamp end);

  Repairs& repairs_;
  Arrival imu_arrival_;
  std::optional<Timestamp> begin_, newest_;  ///< first and newest stamp of all
  std::vector<Camera<Event>> events_;        ///< at least one
  std::vector<Camera<Frame>> frames_;        ///< at least one
  ArrivalQueue<ImuSample> imu_;
  std::vector<ArrivalQueue<ExternalSample>> external_;  ///< one a sensor
  bool finished_ = false;
};

}  // namespace edged
