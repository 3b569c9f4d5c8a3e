// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads the intrinsics of the cameras in a bag.
#pragma once

#include <optional>

#include "edged/io/core/topic_choice.hpp"
#include "edged/io/ros/bag/message_source.hpp"
#include "edged/io/sensor_head.hpp"

namespace edged {

/// Intrinsics of its cameras from the CameraInfo in the namespace of their topics (/dvs/camera_info of
/// /dvs/events). Nothing without usable ones. Reads up to the first message of each, so source must be at its
/// beginning.
std::optional<Calibration> read_bag_intrinsics(MessageSource& source, const TopicChoice& choice);

}  // namespace edged
