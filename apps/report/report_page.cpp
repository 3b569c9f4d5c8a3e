// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "report/report_page.hpp"

#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/files.hpp"
#include "common/json_text.hpp"
#include "edged/core/check.hpp"
#include "report/report_data.hpp"
#include "report_parts.hpp"

namespace edged {
namespace {

/// As json within a script element, with "<" escaped.
std::string script_safe(const nlohmann::ordered_json& data) {
  const std::string text = compact_json(data);
  std::string safe;
  safe.reserve(text.size() + 1024);
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

/// start: the script to run at the end; sources: allowed sources of images and data.
std::string filled_page(const nlohmann::ordered_json& data, const char* start, const char* sources) {
  const std::map<std::string_view, std::string> parts = {
      {"css", kReportCss},       {"data", script_safe(data)}, {"tools", kToolsJs},   {"plot", kPlotJs},
      {"start", start},          {"clouds", kCloudsJs},       {"view3d", kView3dJs}, {"report", kReportJs},
      {"sections", kSectionsJs}, {"sources", sources}};
  constexpr std::string_view kOpen = "{{", kClose = "}}";
  std::string page;
  std::string_view rest = kReportHtml;
  for (std::size_t at = rest.find(kOpen); at != std::string_view::npos; at = rest.find(kOpen)) {
    const std::size_t end = rest.find(kClose, at);
    EDGED_CHECK(end != std::string_view::npos, "report.html: a part without an end");
    page += rest.substr(0, at);
    page += parts.at(rest.substr(at + kOpen.size(), end - at - kOpen.size()));
    rest.remove_prefix(end + kClose.size());
  }
  return page += rest;
}

}  // namespace

std::string report_page(const nlohmann::ordered_json& data) {
  return filled_page(data, "begin(buildPage);", "img-src data:");
}

std::string live_report_page(const nlohmann::ordered_json& about) {
  return filled_page(about, kLiveJs, "img-src data: 'self'; connect-src 'self'");
}

std::string player_page(const nlohmann::ordered_json& data) { return filled_page(data, kPlayerJs, "img-src data:"); }

std::string calibration_page(const nlohmann::ordered_json& data) {
  return filled_page(data, kTargetJs, "img-src data:");
}

void write_run_report(const std::filesystem::path& folder) {
  write_file(folder / "report.html", report_page(report_data({folder})));
}

}  // namespace edged
