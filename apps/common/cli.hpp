// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What sources say of the command line without CLI11, whose header takes six seconds to compile: its class, the exit
// status and the version of the program.
#pragma once

namespace CLI {
class App;
}

namespace edged {

constexpr int kExitOk = 0;
constexpr int kExitBug = 1;         ///< a bug of ours: a failed check or an unexpected exception
constexpr int kExitUsage = 2;       ///< the command line
constexpr int kExitInput = 3;       ///< recording, calibration or configuration
constexpr int kExitNeverGood = 4;   ///< ran to the end, but there never was a Good pose
constexpr int kExitNotTrusted = 5;  ///< ran to the end, but recording, calibration or the estimate itself contradict it
/// Plus the signal's number: 130 after Ctrl-C, 143 after SIGTERM, 129 after SIGHUP; files are complete.
constexpr int kExitSignalBase = 128;

/// Version of the project and state of the source tree at build time, e.g. "0.1.0 (1a2b3c4, changed)".
extern const char* const kVersion;

}  // namespace edged
