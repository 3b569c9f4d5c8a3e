// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// An evaluation as a table.
#pragma once

#include <string>
#include <vector>

#include "edged/eval/metrics.hpp"

namespace edged {

std::string to_table(const Evaluation& evaluation);
/// In one line, of the windows that there are.
std::string local_error_text(const std::vector<LocalError>& local);

}  // namespace edged
