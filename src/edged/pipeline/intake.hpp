// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Where measurements come in, from any thread: what cannot be used is counted, the rest is put into order.
#pragma once

#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "edged/core/jump_gate.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/counters.hpp"
#include "edged/pipeline/sequencer.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Whether the clock of a sensor has been set back for good.
class ClockWatch {
 public:
  /// True when t completes half a second that lies behind the newest stamp by more than a second.
  bool set_back(Timestamp t);

 private:
  std::optional<Timestamp> newest_;
  std::optional<Timestamp> behind_since_;
  Timestamp behind_;
};

/// One damaged stamp costs one measurement. When a sensor's clock has been set back by more than a second, for good,
/// what comes belongs to a new time: it takes half a second to be sure, whose measurements are late, and by less than a
/// second they are late until the old time is reached again.
class Intake {
 public:
  struct Item {
    Measurement measurement;
    bool begins_time = false;  ///< a clock was set back: what came before belongs to another time
  };

  Intake(const Rig& rig, Mode mode, const SensorDelays& delays);

  /// From any thread. Measurements of cameras that the mode does not use are passed over.
  void add(Measurement measurement);
  void finish();

  /// What follows next, as of the sequencer.
  std::optional<Item> next();
  /// After finish(), and next() has given all.
  bool ended() const;
  IntakeCounters counters() const;

 private:
  struct Camera {
    std::string name;
    Modality modality;
    CameraModel model;
    bool used;
  };
  const Camera* find(const std::string& name, Modality modality);
  bool admit(EventBatch& batch);
  bool admit(Frame& frame);
  bool admit(const ImuSample& sample);
  void judge(EventBatch batch);
  void judge(Frame frame) { judge(frames_, std::move(frame)); }
  void judge(const ImuSample& sample) { judge(imu_, sample); }
  template <typename T>
  struct Sensor {
    JumpGate<T> gate{false};
    ClockWatch clock = {};
  };
  template <typename T>
  void judge(Sensor<T>& sensor, T item);
  void take(Measurement measurement, ClockWatch& clock);
  void begin_time();

  Mode mode_;
  SensorDelays delays_;
  std::string event_camera_;  // empty: not used in this mode
  std::vector<Camera> cameras_;
  mutable std::mutex mutex_;     // of what is below
  std::deque<Sequencer> times_;  // the last is what comes, those before it are ended and not yet handed out
  bool begins_time_ = false;     // of what comes next out of the first
  Sensor<Event> events_;
  Sensor<Frame> frames_;
  Sensor<ImuSample> imu_;
  IntakeCounters counters_;
};

}  // namespace edged
