// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The input of measurements, from any thread: unusable ones are counted, the rest is put in order.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "edged/core/measurements/external_sensor.hpp"
#include "edged/core/measurements/jump_gate.hpp"
#include "edged/counters.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/input/sequencer.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Whether the clock of a sensor has been set back for good.
class ClockWatch {
 public:
  /// True when t completes half a second of stamps more than a second behind the newest one.
  bool set_back(Timestamp t);

 private:
  std::optional<Timestamp> newest_;
  std::optional<Timestamp> behind_since_;
  Timestamp behind_;
};

/// One damaged stamp costs one measurement. When a sensor's clock has been set back by more than a second and stays
/// there, a new time begins. The decision takes half a second, whose measurements are late. After a step by less than a
/// second measurements are late until the old time is reached again.
class MeasurementValidator {
 public:
  struct Item {
    Measurement measurement;
    bool begins_epoch = false;  ///< a clock was set back: earlier measurements belong to another time
  };

  /// used: the cameras of the run, some of the rig's.
  MeasurementValidator(const Rig& rig, const Rig& used, const SensorDelays& delays);

  /// From any thread. Measurements of unused cameras are ignored.
  void add(Measurement measurement);
  void finish();

  /// The next measurement, as of the sequencer.
  std::optional<Item> next();
  /// After finish(), when next() has returned all.
  bool ended() const;
  IntakeCounters counters() const;

 private:
  template <typename T>
  struct Sensor {
    std::string name = {};  ///< the camera's
    CameraModel model = {};
    JumpGate<T> gate{false};
    ClockWatch clock = {};
  };
  static std::array<JumpGate<ExternalSample>, kExternalSensors> fresh_gates();
  template <typename T>
  Sensor<T>* find(std::vector<Sensor<T>>& cameras, const std::string& name);
  void accept(EventBatch batch);
  void accept(Frame frame);
  void accept(const ImuSample& sample);
  void accept(const ExternalSample& sample);
  void remove_invalid(std::vector<Event>& events, const CameraModel& camera);
  bool is_valid(Frame& frame, const CameraModel& camera);
  bool is_valid(const ImuSample& sample);
  template <typename T>
  void validate(Sensor<T>& sensor, T item);
  void release(Measurement measurement, ClockWatch& clock);
  void forward(Measurement measurement);
  template <typename Give>
  void for_each_gate(const Give& give);
  void begin_epoch();

  Rig used_;
  SensorDelays delays_;
  std::vector<std::pair<std::string, Modality>> known_;  // all cameras of the rig
  mutable std::mutex mutex_;                             // guards the members below
  std::deque<Sequencer> epochs_;       // the last one receives; those before it are finished but not yet read out
  bool begins_time_ = false;           // of the next measurement from the first one
  std::vector<Sensor<Event>> events_;  // one per used camera
  std::vector<Sensor<Frame>> frames_;
  Sensor<ImuSample> imu_;
  // They start no new time and confirm no other stamp, so that runs without them are the same.
  std::array<JumpGate<ExternalSample>, kExternalSensors> external_ = fresh_gates();
  IntakeCounters counters_;
};

}  // namespace edged
