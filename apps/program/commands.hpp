// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The sub-commands of `edged`.
#pragma once

#include <functional>

#include "common/cli.hpp"

namespace edged {

/// Each adds its sub-command; `chosen` receives what to run when the user chose it.
using AddCommand = void(CLI::App& app, std::function<int()>& chosen);

AddCommand add_run_command, add_info_command, add_show_command, add_doctor_command, add_convert_command,
    add_calib_command, add_simulate_command, add_eval_command, add_report_command, add_map_command, add_depth_command,
    add_config_command, add_ros2_command, add_play_command, add_manual_command;

}  // namespace edged
