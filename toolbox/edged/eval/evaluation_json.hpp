// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The errors of a trajectory, as json.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "edged/eval/consistency.hpp"
#include "edged/eval/metrics.hpp"
#include "edged/eval/time_offset.hpp"

namespace edged {

/// NaN (no window, no motion) becomes null when it is printed.
nlohmann::ordered_json to_json(const Evaluation& evaluation);
nlohmann::ordered_json to_json(const Consistency& consistency);
nlohmann::ordered_json to_json(const TimeOffset& offset);

}  // namespace edged
