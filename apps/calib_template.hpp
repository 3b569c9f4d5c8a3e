// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What is known of a camera before anyone has calibrated it, as a file of our own to fill in.
#pragma once

#include <string>
#include <vector>

namespace edged {

std::vector<std::string> template_names();

/// Commented yaml of our own; what has to be measured reads FILL_IN, which load_calibration refuses by its line.
std::string calibration_template(const std::string& camera);

}  // namespace edged
