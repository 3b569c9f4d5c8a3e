// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The method, packet by packet: `process` is the paper's data flow.
#pragma once

#include "edged/imu_noise.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/input/packet.hpp"
#include "edged/pipeline/localization/localization.hpp"
#include "edged/pipeline/vision/vision.hpp"
#include "edged/rig.hpp"
#include "edged/step.hpp"
#include "edged/timing.hpp"

namespace edged {

/// Synchronous and deterministic: the same packets give the same bits, except with a depth network in a thread of its
/// own.
class PacketOdometry {
 public:
  /// cameras: those of the run, event cameras first; config: validated.
  PacketOdometry(const Rig& cameras, const ImuNoise& noise, const OdometryConfig& config, Inference inference);
  PacketOdometry(const PacketOdometry&) = delete;
  PacketOdometry& operator=(const PacketOdometry&) = delete;

  /// Packets in time order. Never throws on data; lost tracking is a status.
  Step process(Packet packet);
  /// A clock was set back and a new time begins: tracks and estimate end.
  void begin_time();

  Localization& localization() { return localization_; }
  /// Of the stages; callers may add their own.
  StageTimings& timings() { return timings_; }

 private:
  StageTimings timings_;
  Localization localization_;
  Vision vision_;
};

}  // namespace edged
