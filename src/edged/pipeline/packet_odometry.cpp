// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/packet_odometry.hpp"

#include <utility>

#include "edged/core/check.hpp"

namespace edged {

PacketOdometry::PacketOdometry(const Rig& cameras, const ImuNoise& noise, const OdometryConfig& config,
                               Inference inference)
    : localization_(cameras, noise, config, timings_), vision_(without_offsets(cameras), config, inference, timings_) {}

void PacketOdometry::begin_time() {
  localization_.begin_time();
  vision_.begin_time();
}

Step PacketOdometry::process(Packet packet) {
  EDGED_CHECK(packet.imu.size() >= 2, "packet at {} ns with {} IMU samples", to_ns(packet.t), packet.imu.size());
  Preintegration motion = localization_.predict(packet.imu);
  const VisionOutput seen = vision_.process({packet, localization_.body(), motion.gyro_trusted()});
  LocalizationOutput localized = localization_.process(std::move(motion), seen, std::move(packet.external));
  vision_.correct(localized.correction, localization_.body());
  localized.step.cameras = vision_.describe(std::move(packet), seen);
  return std::move(localized.step);
}

}  // namespace edged
