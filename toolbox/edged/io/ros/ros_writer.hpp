// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Recordings as bags of ROS 1 and 2.
#pragma once

#include <memory>

#include "edged/io/recording_writer.hpp"

namespace edged {

/// Topics /dvs/events (dvs_msgs/EventArray), /camera/image_raw, /imu/data and /ground_truth/pose (TransformStamped from
/// the frame it names to "world"), and where there is a calibration the intrinsics as /dvs/camera_info and
/// /camera/camera_info. Stamps are those of the sensors to the nanosecond; none may be negative or later than ROS's
/// (InputError).
std::unique_ptr<RecordingWriter> write_ros1_bag(const WriterSetup& setup);
std::unique_ptr<RecordingWriter> write_mcap(const WriterSetup& setup);

}  // namespace edged
