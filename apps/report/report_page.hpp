// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// report.html: one file that a browser shows without a network. Its parts lie in apps/report/page/.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace edged {

/// No text of the data can end the script that holds it.
std::string report_page(const nlohmann::ordered_json& data);

/// The page of a run that goes on, which asks where it comes from for what happens (apps/live/live_page). about: what
/// is known before it begins.
std::string live_report_page(const nlohmann::ordered_json& about);

/// The page of `edged show`: pictures of events that play. data: a recording and its PlayerData.
std::string player_page(const nlohmann::ordered_json& data);

/// report.html of one run folder, into it.
void write_run_report(const std::filesystem::path& folder);

}  // namespace edged
