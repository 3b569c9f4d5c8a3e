// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/findings.hpp"

#include <algorithm>
#include <array>

#include "common/json_text.hpp"
#include "common/text.hpp"

namespace edged {
namespace {

constexpr std::array kSeverities = {Severity::Good, Severity::Note, Severity::Warning, Severity::Error};

const char* name_of(Severity severity) {
  constexpr std::array kNames = {"ok", "note", "warning", "error"};
  return kNames[static_cast<std::size_t>(severity)];
}

const char* name_of(Fit fit) {
  return fit == Fit::Fits ? "fits" : fit == Fit::DoesNotFit ? "does not fit" : "cannot be determined";
}

}  // namespace

std::string to_text(const std::vector<Finding>& findings) {
  std::string text;
  for (const Severity severity : kSeverities)
    for (const Finding& finding : findings) {
      if (finding.severity != severity) continue;
      text += fmt::format("{:<8} {}\n", name_of(severity), finding.text);
      if (!finding.remedy.empty()) text += fmt::format("{:<8}   -> {}\n", "", finding.remedy);
    }
  const auto count = [&](Severity severity) { return std::ranges::count(findings, severity, &Finding::severity); };
  return text + fmt::format("{}, {}\n", quantity(count(Severity::Error), "error"),
                            quantity(count(Severity::Warning), "warning"));
}

nlohmann::ordered_json to_json(const std::vector<Finding>& findings) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Finding& finding : findings)
    json.push_back({{"severity", name_of(finding.severity)}, {"text", finding.text}, {"remedy", finding.remedy}});
  return json;
}

nlohmann::ordered_json to_json(const CalibrationFound& c) {
  nlohmann::ordered_json corrections = nlohmann::ordered_json::object();
  for (const CorrectionFound& of : c.corrections) corrections[of.name] = {{"off", of.off}, {"sigma", of.sigma}};
  return {{"camera", c.camera},
          {"rotation_off_deg", c.rotation_deg},
          {"rotation_sigma_deg", number_or_null(c.rotation_sigma_deg)},
          {"time_offset_ms", c.time_offset_ms},
          {"time_offset_sigma_ms", number_or_null(c.time_sigma_ms)},
          {"given_time_offset_ms", c.given_offset_ms},
          {"corrections", corrections}};
}

std::string to_text(const CalibrationFit& fit) {
  std::string text = fit.findings.empty() ? "" : to_text(fit.findings);
  for (const CameraFit& camera : fit.cameras)
    text += fmt::format("{:<11} {}: {}\n", camera.found.camera, name_of(camera.fit), camera.why);
  return text + fmt::format("{:<11} {}: {}\n", "calibration", name_of(fit.fit), fit.why);
}

nlohmann::ordered_json to_json(const CalibrationFit& fit) {
  nlohmann::ordered_json json = {{"verdict", name_of(fit.fit)}, {"why", fit.why}};
  json["cameras"] = nlohmann::ordered_json::array();
  for (const CameraFit& camera : fit.cameras) {
    nlohmann::ordered_json one = to_json(camera.found);
    one.update({{"verdict", name_of(camera.fit)}, {"why", camera.why}});
    json["cameras"].push_back(one);
  }
  json["findings"] = to_json(fit.findings);
  return json;
}

bool has_error(const std::vector<Finding>& findings) {
  return std::ranges::count(findings, Severity::Error, &Finding::severity) > 0;
}

}  // namespace edged
