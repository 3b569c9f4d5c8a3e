// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes recordings as bags of ROS 1 and 2.
#pragma once

#include <memory>

#include "edged/io/core/recording_writer.hpp"

namespace edged {

/// Topics /dvs/events (dvs_msgs/EventArray), /camera/image_raw, /imu/data and /ground_truth/pose (TransformStamped from
/// the frame that it names to "world"). With a calibration, also the intrinsics as /dvs/camera_info and
/// /camera/camera_info. Stamps are those of the sensors to the nanosecond. Throws InputError for stamps that are
/// negative or beyond the range of ROS.
std::unique_ptr<RecordingWriter> write_ros1_bag(const WriterSetup& setup);
std::unique_ptr<RecordingWriter> write_mcap(const WriterSetup& setup);

}  // namespace edged
