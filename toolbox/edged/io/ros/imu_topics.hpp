// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Several topics of sensor_msgs/Imu: drivers may send gyro and accelerometer apart, each with the other left empty.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "edged/io/topic_choice.hpp"

namespace edged {

struct ImuTopics {
  std::optional<std::size_t> imu;    ///< nothing: as choose_topics says
  std::optional<std::size_t> accel;  ///< where `imu` has the gyro alone: its accelerometer
};

/// By what the first messages of each fill in: the only topic that has both sensors, else the only one with a gyro and
/// the only one with an accelerometer. Nothing where the user has chosen, or where that does not decide.
ImuTopics choose_imu_topics(const std::filesystem::path& bag, const std::vector<Topic>& topics,
                            const WantedTopics& wanted);

/// What the user wants, and that choice.
WantedTopics with_imu_topic(WantedTopics wanted, const std::vector<Topic>& topics, const ImuTopics& chosen);

}  // namespace edged
