// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One pass through a recording, and its survey as text and json.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/source.hpp"
#include "edged/checks/statistics/recording_statistics.hpp"

namespace edged {

std::string to_text(const RecordingStatistics& survey);
nlohmann::ordered_json to_json(const RecordingStatistics& survey);

struct WholeRead {
  std::optional<GroundTruth> truth;
  std::optional<std::string> damage;  ///< the error that ended reading
};

/// Reads a recording with its ground truth, with a status line. Ends early when the user interrupts.
WholeRead read_whole(Dataset& dataset, bool quiet, const std::function<void(const Measurement&)>& use);

}  // namespace edged
