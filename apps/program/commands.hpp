// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The sub-commands of `edged`, and the meaning of its exit status.
#pragma once

#include <functional>

#include "common/cli_fwd.hpp"

namespace edged {

constexpr int kExitOk = 0;
constexpr int kExitBug = 1;         ///< a bug of ours: a failed check or an unexpected exception
constexpr int kExitUsage = 2;       ///< the command line
constexpr int kExitInput = 3;       ///< recording, calibration or configuration
constexpr int kExitNeverGood = 4;   ///< ran to the end, but there never was a Good pose
constexpr int kExitNotTrusted = 5;  ///< ran to the end, but recording, calibration or the estimate itself contradict it
/// Plus the signal's number: 130 after Ctrl-C, 143 after SIGTERM, 129 after SIGHUP; files are complete.
constexpr int kExitSignalBase = 128;

/// Each adds its sub-command; `chosen` receives what to run when the user chose it.
void add_run_command(CLI::App& app, std::function<int()>& chosen);
void add_info_command(CLI::App& app, std::function<int()>& chosen);
void add_show_command(CLI::App& app, std::function<int()>& chosen);
void add_doctor_command(CLI::App& app, std::function<int()>& chosen);
void add_convert_command(CLI::App& app, std::function<int()>& chosen);
void add_calib_command(CLI::App& app, std::function<int()>& chosen);
void add_simulate_command(CLI::App& app, std::function<int()>& chosen);
void add_eval_command(CLI::App& app, std::function<int()>& chosen);
void add_report_command(CLI::App& app, std::function<int()>& chosen);
void add_map_command(CLI::App& app, std::function<int()>& chosen);
void add_depth_command(CLI::App& app, std::function<int()>& chosen);
void add_config_command(CLI::App& app, std::function<int()>& chosen);
void add_ros2_command(CLI::App& app, std::function<int()>& chosen);
void add_play_command(CLI::App& app, std::function<int()>& chosen);
void add_manual_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace edged
