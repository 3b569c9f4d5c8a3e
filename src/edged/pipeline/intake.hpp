// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Where measurements come in, from any thread: what cannot be used is counted, the rest is put into order.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "edged/camera/rig.hpp"
#include "edged/pipeline/sequencer.hpp"

namespace edged {

/// What was left out as it came.
struct IntakeCounters {
  std::size_t unknown_camera = 0;  ///< measurements of a camera that the rig does not have
  std::size_t absurd_stamps = 0;   ///< events and measurements more than 146 years from zero
  std::size_t events_outside = 0;  ///< of the pixels of their camera
  std::size_t frames_unfit = 0;    ///< not grey (CV_8UC1), or not of their camera's size
  std::size_t no_room = 0;         ///< measurements that came when too much waited already, or after finish()
};

class Intake {
 public:
  Intake(const Rig& rig, Mode mode, const SensorDelays& delays);

  /// From any thread. Measurements of cameras that the mode does not use are passed over. True when it is taken.
  bool add(Measurement measurement);
  void finish();

  /// What follows next, as of the sequencer.
  std::optional<Measurement> next();
  /// After finish(), and next() has given all.
  bool ended() const;
  IntakeCounters counters() const;

 private:
  struct Camera {
    std::string name;
    Modality modality;
    int width, height;
    bool used;
  };
  const Camera* find(const std::string& name, Modality modality);
  bool admit(EventBatch& batch);
  bool admit(Frame& frame);
  bool admit(const ImuSample& sample);

  std::vector<Camera> cameras_;
  mutable std::mutex mutex_;  // of what is below
  Sequencer sequencer_;
  IntakeCounters counters_;
};

}  // namespace edged
