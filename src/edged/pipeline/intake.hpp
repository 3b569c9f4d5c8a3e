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
#include "edged/counters.hpp"
#include "edged/options.hpp"
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

  /// used: the cameras of the run, some of the rig's.
  Intake(const Rig& rig, const Rig& used, const SensorDelays& delays);

  /// From any thread. Measurements of cameras that are not used are passed over.
  void add(Measurement measurement);
  void finish();

  /// What follows next, as of the sequencer.
  std::optional<Item> next();
  /// After finish(), and next() has given all.
  bool ended() const;
  IntakeCounters counters() const;

 private:
  template <typename T>
  struct Sensor {
    std::string name = {};  ///< of the camera
    CameraModel model = {};
    JumpGate<T> gate{false};
    ClockWatch clock = {};
  };
  template <typename T>
  Sensor<T>* find(std::vector<Sensor<T>>& cameras, const std::string& name);
  void accept(EventBatch batch);
  void accept(Frame frame);
  void accept(const ImuSample& sample);
  bool admit(EventBatch& batch, const CameraModel& camera);
  bool admit(Frame& frame, const CameraModel& camera);
  bool admit(const ImuSample& sample);
  template <typename T>
  void judge(Sensor<T>& sensor, T item);
  void take(Measurement measurement, ClockWatch& clock);
  template <typename Give>
  void for_each_gate(const Give& give);
  void begin_time();

  Rig used_;
  SensorDelays delays_;
  std::vector<std::pair<std::string, Modality>> known_;  // all cameras of the rig
  mutable std::mutex mutex_;                             // of what is below
  std::deque<Sequencer> times_;        // the last is what comes, those before it are ended and not yet handed out
  bool begins_time_ = false;           // of what comes next out of the first
  std::vector<Sensor<Event>> events_;  // one a camera that is used
  std::vector<Sensor<Frame>> frames_;
  Sensor<ImuSample> imu_;
  IntakeCounters counters_;
};

}  // namespace edged
