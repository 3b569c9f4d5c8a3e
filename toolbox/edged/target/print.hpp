// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A calibration target on paper.
#pragma once

#include <string>

#include "edged/target/target.hpp"

namespace edged {

/// Both are of true size: the page is the target with its margin, to be printed at 100 %.
std::string target_svg(const TargetSpec& spec);
std::string target_pdf(const TargetSpec& spec);

}  // namespace edged
