// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The units in which recordings count their stamps.
#pragma once

namespace edged {

/// As powers of ten of a nanosecond.
enum class TimeUnit { Nanoseconds = 0, Microseconds = 3, Milliseconds = 6, Seconds = 9 };

}  // namespace edged
