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
#include "edged/rig.hpp"

namespace edged {

/// Each sensor's own measurements in order, those of different sensors as they come. What a sensor may still precede is
/// held back; what comes later than its delay goes out at once, out of order, for the packetizer to use or to count.
/// With kInOrder all goes out as it came, a sample of an external sensor with the next measurement of another. The
/// order that comes out does not depend on how the sensors lag, as long as they keep to their delays.
///
/// When half of most_bytes waits, no sensor is waited for any longer; beyond most_bytes of events and frames, or a
/// million IMU samples, nothing more is taken.
class Sequencer {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{256} << 20U;

  /// Waits for these cameras and the IMU. The delays are valid, as of validate(); what the clocks of the cameras differ
  /// by comes on top of them, as stamps are compared as recorded.
  Sequencer(const Rig& cameras, const SensorDelays& delays, std::size_t most_bytes = kMostBytes);

  /// False when there is no room for it, or after finish(). Batches without events are passed over. Of those cameras.
  bool add(Measurement measurement);
  /// No more will come: all that waits goes out.
  void finish() { finished_ = true; }

  /// The next measurement, a batch of events up to the next IMU sample or frame; nothing as long as another may precede
  /// it. Batches of two event cameras may overlap, in the order of their first events.
  std::optional<Measurement> next();
  /// After finish(), and all has gone out.
  bool ended() const { return finished_ && waiting() == 0; }
  /// How many measurements have not gone out.
  std::size_t waiting() const;

 private:
  template <typename T>
  struct Line {
    std::string camera;  ///< or sensor
    Duration delay;
    std::deque<T> waiting = {};
    std::size_t events_out = 0;  ///< of the first batch that waits
    std::optional<Timestamp> newest = {};
  };

  template <typename T>
  bool push(Line<T>& line, T item, Timestamp last);
  template <typename T>
  Timestamp earliest(const Line<T>& line) const;
  template <typename T>
  std::optional<Measurement> pop(Line<T>& line);
  std::optional<Measurement> pop_events(Line<EventBatch>& line, Timestamp end);
  template <typename T>
  Line<T>* first_of(std::vector<Line<T>>& lines);

  std::size_t most_bytes_;
  std::vector<Line<EventBatch>> events_;  // one a camera, no batch empty
  std::vector<Line<Frame>> frames_;       // one a camera
  Line<ImuSample> imu_;
  std::vector<Line<ExternalSample>> external_;  // one a sensor, as in ExternalSample; their stamps move no other line
  std::size_t bytes_ = 0;                       // of the events and frames that wait
  std::optional<Timestamp> newest_;
  bool finished_ = false;
};

}  // namespace edged
