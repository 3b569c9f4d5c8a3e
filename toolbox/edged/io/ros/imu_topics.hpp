// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Chooses among several topics of sensor_msgs/Imu. Some drivers send gyro and accelerometer in separate topics, each
// with the other sensor left empty.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "edged/io/core/topic_choice.hpp"

namespace edged {

struct ImuTopics {
  std::optional<std::size_t> imu;    ///< nothing: choose_topics decides
  std::optional<std::size_t> accel;  ///< the topic of the accelerometer, if `imu` has the gyro only
};

/// Chooses by the content of the first messages of each topic: the only topic with both sensors, else the only one with
/// a gyro and the only one with an accelerometer. Nothing if the user has chosen, or if the choice is not unique.
ImuTopics choose_imu_topics(const std::filesystem::path& bag, const std::vector<Topic>& topics,
                            const WantedTopics& wanted);

/// The wishes of the user, extended by that choice.
WantedTopics with_imu_topic(WantedTopics wanted, const std::vector<Topic>& topics, const ImuTopics& chosen);

}  // namespace edged
