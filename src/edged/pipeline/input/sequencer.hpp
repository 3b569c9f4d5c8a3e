// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Puts the measurements of sensors that lag behind one another into the order of their stamps.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "edged/measurement.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/tuning.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Input: each sensor's own measurements in order, those of different sensors interleaved in any way. A measurement is
/// held back while another sensor may still precede it; one that is later than its delay is returned at once, out of
/// order, and the packetizer uses or counts it. With kInOrder the order is that of the input, with samples of external
/// sensors before the next measurement of another. The order does not depend on the lags of the sensors, as long as
/// these are within their delays.
///
/// When the queues reach half of max_bytes, nothing is held back any longer; beyond max_bytes of events and frames,
/// or a million IMU samples, no more input is accepted.
class Sequencer {
 public:
  /// Waits for these cameras and the IMU. The delays are valid, as of validate(); the differences of the camera clocks
  /// are added to them, as stamps are compared as recorded.
  Sequencer(const Rig& cameras, const SensorDelays& delays, std::size_t max_bytes = kPipelineTuning.max_queued_bytes);

  /// False when there is no room for it, or after finish(). Empty batches are ignored. Only of those cameras.
  bool add(Measurement measurement);
  /// The end of the input: next() returns all that is held back.
  void finish() { finished_ = true; }

  /// The next measurement, a batch of events up to the next IMU sample or frame; nothing while another may precede it.
  /// Batches of two event cameras may overlap, in the order of their first events.
  std::optional<Measurement> next();
  /// After finish(), when all has been returned.
  bool ended() const { return finished_ && waiting() == 0; }
  /// Number of measurements held back.
  std::size_t waiting() const;

 private:
  template <typename T>
  struct Queue {
    std::string camera;  ///< or sensor
    Duration delay;
    std::deque<T> waiting = {};
    std::size_t events_out = 0;  ///< events of the first queued batch that are out
    std::optional<Timestamp> newest = {};
  };

  template <typename T>
  bool push(Queue<T>& queue, T item, Timestamp last);
  template <typename T>
  Timestamp earliest(const Queue<T>& queue) const;
  template <typename T>
  std::optional<Measurement> pop(Queue<T>& queue);
  std::optional<Measurement> pop_events(Queue<EventBatch>& queue, Timestamp end);
  template <typename T>
  Queue<T>* first_of(std::vector<Queue<T>>& queues);

  std::size_t max_bytes_;
  std::vector<Queue<EventBatch>> events_;  // one per camera, no batch empty
  std::vector<Queue<Frame>> frames_;       // one per camera
  Queue<ImuSample> imu_;
  std::vector<Queue<ExternalSample>>
      external_;           // one per sensor, as in ExternalSample; their stamps do not affect other queues
  std::size_t bytes_ = 0;  // of the queued events and frames
  std::optional<Timestamp> newest_;
  bool finished_ = false;
};

}  // namespace edged
