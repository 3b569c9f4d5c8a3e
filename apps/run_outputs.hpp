// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The outputs of `edged run`.
#pragma once

#include <vector>

#include "run/run_context.hpp"

namespace edged {

/// All outputs, in the order of their calls.
std::vector<RunOutput> run_outputs();

}  // namespace edged
