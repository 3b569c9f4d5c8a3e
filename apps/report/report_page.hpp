// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// report.html: one self-contained file. Its parts are in apps/report/page/.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace edged {

inline constexpr std::string_view kPageBegin = "<!DOCTYPE html>";  ///< of all pages

/// The data is escaped, so that it cannot end its script element.
std::string report_page(const nlohmann::ordered_json& data);

/// The page of a live run, which polls its server (apps/live/live_page). about: data known at the start.
std::string live_report_page(const nlohmann::ordered_json& about);

/// The page of `edged show`, which plays event images. data: a recording and its PlayerData.
std::string player_page(const nlohmann::ordered_json& data);

/// The page of `edged calib --target`. data: a TargetCalibration as json, with coverage and residuals.
std::string calibration_page(const nlohmann::ordered_json& data);

/// report.html of one run folder, into it.
void write_run_report(const std::filesystem::path& folder);

}  // namespace edged
