// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/calibration_fit.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace edged {
namespace {

/// An offset and its sigma, with the limits of a correct calibration.
struct Offset {
  double value = 0.0, sigma = 0.0;
  double least =
      0.0;  ///< a smaller offset fits for any sigma: calibrations are not more accurate, and a run corrects it
  double known = 0.0;  ///< with a larger sigma the fit is undetermined

  /// The sigmas of an estimate are already inflated by a factor of two. With a sigma of `known`, an offset of 2 * known
  /// is
  /// detected.
  bool off() const { return std::abs(value) > std::max(least, 2.0 * sigma); }
  bool unknown() const { return sigma > known && !off(); }
};

Offset rotation_of(const CalibrationFound& c) { return {c.rotation_deg, c.rotation_sigma_deg.value_or(1e9), 1.0, 0.7}; }

Offset clock_of(const CalibrationFound& c) {
  return {c.time_offset_ms - c.given_offset_ms, c.time_sigma_ms.value_or(1e9), 3.0, 2.0};
}

std::string figures(const Offset& rotation, const Offset& clock) {
  return fmt::format("rotation {:.2f} deg +- {:.2f} deg off, clock {:+.2f} ms +- {:.2f} ms", rotation.value,
                     rotation.sigma, clock.value, clock.sigma);
}

/// The offsets that the run estimated, and how to write the estimate.
std::string contradiction(const CalibrationFound& c, const Offset& rotation, const Offset& clock) {
  std::string text;
  if (clock.off())
    text = fmt::format("its clock is {:.1f} ms +- {:.1f} ms off; write `time_offset: {:.4f}`", std::abs(clock.value),
                       clock.sigma, 1e-3 * c.time_offset_ms);
  if (rotation.off())
    text += fmt::format("{}its rotation to the IMU is {:.1f} deg +- {:.1f} deg off; {}", text.empty() ? "" : ", and ",
                        rotation.value, rotation.sigma,
                        c.inverse  ? fmt::format("its inverse fits: {}", kTurnRound)
                        : c.beyond ? "calibrate camera and IMU again"
                                   : "--out FILE writes the estimated one");
  return text;
}

bool is_about(const Finding& finding, const CalibrationFound& c) {
  return finding.text.starts_with(fmt::format("camera {}:", c.camera));
}

CameraFit judge_camera(const CalibrationFound& c, const std::vector<Finding>& findings, const std::string& missing) {
  const auto said = std::ranges::find_if(findings, [&c](const Finding& f) { return is_about(f, c); });
  const auto unusable = std::ranges::find(findings, Unusable::Calibration, &Finding::unusable);
  const bool comparable = unusable == findings.end();
  const Offset rotation = rotation_of(c), clock = clock_of(c);
  if (comparable && is_off(c)) return {c, Fit::DoesNotFit, contradiction(c, rotation, clock)};
  if (said != findings.end())
    return {c, Fit::DoesNotFit, fmt::format("{}; {}", said->text.substr(said->text.find(": ") + 2), said->remedy)};
  if (!comparable) return {c, Fit::CannotBeTold, fmt::format("{}; {}", unusable->text, unusable->remedy)};
  if (!c.estimated())
    return {c, Fit::CannotBeTold,
            missing.empty() ? "there was no estimate" : "no estimate, as it waited for " + missing};
  if (rotation.unknown() || clock.unknown())
    return {c, Fit::CannotBeTold, "too little motion: " + figures(rotation, clock)};
  return {c, Fit::Fits, figures(rotation, clock)};
}

}  // namespace

bool is_off(const CalibrationFound& found) {
  return found.estimated() && (rotation_of(found).off() || clock_of(found).off());
}

CalibrationFit judge_fit(const std::vector<CalibrationFound>& found, std::vector<Finding> findings,
                         const std::string& missing) {
  CalibrationFit all;
  std::string wrong, unknown;
  for (const CalibrationFound& c : found) {
    all.cameras.push_back(judge_camera(c, findings, missing));
    std::string& list = all.cameras.back().fit == Fit::DoesNotFit ? wrong : unknown;
    if (all.cameras.back().fit != Fit::Fits) list += (list.empty() ? "" : ", ") + c.camera;
  }
  const auto other = std::ranges::find_if(findings, [&found](const Finding& f) {
    return f.severity == Severity::Error &&
           std::ranges::none_of(found, [&f](const CalibrationFound& c) { return is_about(f, c); });
  });
  if (other != findings.end()) {
    all.fit = Fit::DoesNotFit;
    all.why = fmt::format("{}; {}", other->text, other->remedy);
  } else if (!wrong.empty()) {
    all.fit = Fit::DoesNotFit;
    all.why = "see " + wrong;
  } else if (!unknown.empty()) {
    all.why = "see " + unknown;
    if (!is_unusable(Unusable::Calibration, findings))
      all.why +=
          "; move and turn the sensor about all axes before a scene with texture, or take more or another part: "
          "--duration, --start";
  } else {
    all.fit = Fit::Fits;
    all.why = "nothing in this recording contradicts it";
  }
  all.findings = std::move(findings);
  return all;
}

}  // namespace edged
