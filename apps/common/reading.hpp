// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the commands do with a recording that is open.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "edged/dataset.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// Passes each measurement to `use` until that returns false, the recording ends, or the user interrupts, with the
/// progress in a status line: "12.3 / 60.0 s WHAT".
void read_through(Dataset& dataset, bool quiet, std::string_view what,
                  const std::function<bool(const Measurement&)>& use);

}  // namespace edged
