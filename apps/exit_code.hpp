// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the program's exit status means; README.md lists the same.
#pragma once

namespace edged {

constexpr int kExitOk = 0;
constexpr int kExitBug = 1;         ///< a bug of ours: a failed check or an unexpected exception
constexpr int kExitUsage = 2;       ///< the command line
constexpr int kExitInput = 3;       ///< recording, calibration or configuration
constexpr int kExitNeverGood = 4;   ///< ran to the end, but there never was a Good pose
constexpr int kExitNotTrusted = 5;  ///< ran to the end, but recording, calibration or the estimate itself contradict it
/// Plus the signal's number: 130 after Ctrl-C, 143 after SIGTERM, 129 after SIGHUP; files are complete.
constexpr int kExitSignalBase = 128;

}  // namespace edged
