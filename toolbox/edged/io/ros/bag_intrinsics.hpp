// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a bag tells of its cameras.
#pragma once

#include <optional>

#include "edged/io/ros/message_source.hpp"
#include "edged/io/sensor_head.hpp"
#include "edged/io/topic_choice.hpp"

namespace edged {

/// Intrinsics of "events" and "frames" from the CameraInfo beside their topics (/dvs/camera_info of /dvs/events);
/// nothing where there are none that can be used. Reads up to the first of each: source is to be a fresh one.
std::optional<Calibration> read_bag_intrinsics(MessageSource& source, const TopicChoice& choice);

}  // namespace edged
