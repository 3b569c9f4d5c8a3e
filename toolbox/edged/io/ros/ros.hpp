// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads bags of ROS 1 and ROS 2 as recordings, and writes them.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/core/recording_writer.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// True for the first bytes of a bag, or of a bag that ROS 2 compressed as a whole.
bool is_bag(ByteSpan head);
/// True for the folder of a ROS 2 bag.
bool is_bag_folder(const std::filesystem::path& folder);

/// The files of the bag whose first part is given, NAME_0.bag, NAME_1.bag and so on, in this order. Only the given file
/// if it is no first part.
std::vector<std::filesystem::path> split_bag_parts(const std::filesystem::path& first);

/// path: of a file or folder. The cameras are those of choose_topics(). The poses are those of "body", or of the camera
/// that the messages name. The size of an event camera is that of the rig, else options.geometry, else that of its
/// messages. Throws InputError if the user has to choose topics or nothing is readable.
Recording open_bag(const std::filesystem::path& path, const Rig* rig, const RecordingOptions& options);

/// Topics /dvs/events (dvs_msgs/EventArray), /camera/image_raw, /imu/data and /ground_truth/pose (TransformStamped from
/// the frame that it names to "world"). With a calibration, also the intrinsics as /dvs/camera_info and
/// /camera/camera_info. Stamps are those of the sensors to the nanosecond. Throws InputError for stamps that are
/// negative or beyond the range of ROS.
std::unique_ptr<RecordingWriter> write_ros1_bag(const WriterSetup& setup);
std::unique_ptr<RecordingWriter> write_mcap(const WriterSetup& setup);

}  // namespace edged
