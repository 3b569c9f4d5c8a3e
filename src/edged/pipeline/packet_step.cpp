// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/packet_step.hpp"

#include <utility>

#include "edged/core/check.hpp"

namespace edged {

Step process_packet(Packet packet, Localization& localization, Vision& vision) {
  EDGED_CHECK(packet.imu.size() >= 2, "packet at {} ns with {} IMU samples", to_ns(packet.t), packet.imu.size());
  Preintegration motion = localization.predict(packet.imu);
  const VisionOutput seen = vision.process({packet, localization.body(), motion.gyro_trusted()});
  LocalizationOutput localized = localization.process(std::move(motion), seen, std::move(packet.external));
  vision.correct(localized.correction, localization.body());
  localized.step.cameras = vision.describe(std::move(packet), seen);
  return std::move(localized.step);
}

}  // namespace edged
