// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Where measurements come in, from any thread: what cannot be used is counted, the rest is put into order.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "edged/options.hpp"
#include "edged/pipeline/counters.hpp"
#include "edged/pipeline/sequencer.hpp"
#include "edged/rig.hpp"

namespace edged {

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
