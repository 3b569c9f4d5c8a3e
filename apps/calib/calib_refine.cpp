// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "calib/calib.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "calib/calib.hpp"
#include "common/command.hpp"
#include "common/files.hpp"
#include "common/interrupt.hpp"
#include "common/text.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/estimator/tuning.hpp"
#include "edged/estimator/window/calibration_prior.hpp"
#include "edged/pipeline/mode.hpp"
#include "run/estimated_calibration.hpp"

namespace edged {
namespace {

using nlohmann::ordered_json;

/// What was found in one recording.
struct RecordingEstimate {
  std::string recording;
  std::string why_not;                                     ///< why there is no estimate; empty where there is one
  std::map<std::string, CorrectionEstimate> cameras = {};  ///< by name
};

/// A camera as estimated from all recordings together.
struct RefinedCamera {
  RigCamera given, found;
  CorrectionEstimate estimate;
};

/// As the covariances of a run are inflated, its prior is.
CalibrationVector inflated_prior(const RigCamera& camera, Mode mode) {
  const EstimatorConfig config;
  const double inflation =
      config.sigma_inflation * (mode == Mode::Events ? kEstimatorTuning.events_alone_inflation : 1.0);
  return inflation * calibration_sigmas(config.calibration, camera.model);
}

bool same_cameras(const Rig& a, const Rig& b) {
  return std::ranges::equal(a.cameras, b.cameras, [](const RigCamera& one, const RigCamera& other) {
    return one.name == other.name && one.model == other.model && one.time_offset == other.time_offset &&
           one.T_B_C.matrix().isApprox(other.T_B_C.matrix(), 1e-9);
  });
}

RecordingEstimate estimate_of(const std::string& recording, Source& source, Mode mode, bool quiet) {
  RecordingEstimate result{recording, {}};
  const CalibrationRun run = calibrate_by_run(source.calibration.rig, source, mode, quiet);
  if (run.covariances.empty()) {
    result.why_not = run.fit.cameras.empty() ? "there was no estimate" : run.fit.cameras.front().why;
    return result;
  }
  for (const RigCamera& found : run.estimated.cameras)
    if (const auto P = run.covariances.find(found.name); P != run.covariances.end())
      result.cameras[found.name] = {correction_between(source.calibration.rig.camera(found.name), found), P->second};
  return result;
}

std::vector<RefinedCamera> combine(const std::vector<RecordingEstimate>& all, const Rig& given, Mode mode) {
  std::vector<RefinedCamera> refined;
  for (const RigCamera& camera : given.cameras) {
    std::vector<CorrectionEstimate> estimates;
    for (const RecordingEstimate& result : all)
      if (const auto of = result.cameras.find(camera.name); of != result.cameras.end()) estimates.push_back(of->second);
    if (estimates.empty()) continue;
    const CorrectionEstimate estimate = combined(estimates, inflated_prior(camera, mode));
    refined.push_back({camera, corrected_camera(camera, estimate.correction), estimate});
  }
  return refined;
}

/// Numbers with units: those of corrections_of, and before them rotation and time.
std::vector<CorrectionFound> numbers_of(const RigCamera& given, const CorrectionEstimate& estimate) {
  std::vector<CorrectionFound> numbers;
  for (int i = 0; i < 3; ++i)
    numbers.push_back({fmt::format("rotation_{}_deg", "xyz"[i]), kDegreesPerRadian * estimate.correction[i],
                       kDegreesPerRadian * std::sqrt(estimate.covariance(i, i))});
  numbers.push_back(
      {"time_ms", 1e3 * estimate.correction[kTimeAt], 1e3 * std::sqrt(estimate.covariance(kTimeAt, kTimeAt))});
  const auto rest = corrections_of(given, corrected_camera(given, estimate.correction), estimate.covariance,
                                   EstimatorConfig().calibration);
  numbers.insert(numbers.end(), rest.begin(), rest.end());
  return numbers;
}

/// The numbers in which a recording is beyond three sigma of what all say together.
std::string contradictions(const RecordingEstimate& result, const std::vector<RefinedCamera>& refined) {
  constexpr double kSigmas = 3.0;
  std::string list;
  for (const RefinedCamera& camera : refined) {
    const auto own = result.cameras.find(camera.given.name);
    if (own == result.cameras.end()) continue;
    const auto alone = numbers_of(camera.given, own->second), all = numbers_of(camera.given, camera.estimate);
    for (std::size_t i = 0; i < all.size(); ++i)
      if (std::abs(alone[i].off - all[i].off) > kSigmas * alone[i].sigma)
        list += fmt::format("{}{} of {} {:+.3f} +- {:.3f}, of all {:+.3f}", list.empty() ? "" : "; ", alone[i].name,
                            camera.given.name, alone[i].off, alone[i].sigma, all[i].off);
  }
  return list;
}

std::string text_of(const std::vector<RecordingEstimate>& all, const std::vector<RefinedCamera>& refined) {
  std::string text;
  for (const RefinedCamera& camera : refined) {
    text += fmt::format("{}\n", camera.given.name);
    for (const CorrectionFound& number : numbers_of(camera.given, camera.estimate))
      text += fmt::format("  {:<15} {:+10.4f} +- {:.4f}\n", number.name, number.off, number.sigma);
  }
  for (const RecordingEstimate& result : all) {
    const std::string off = contradictions(result, refined);
    text += fmt::format("{:<11} {}\n", result.recording,
                        !result.why_not.empty() ? "not used: " + result.why_not
                        : off.empty()           ? "agrees within 3 sigma"
                                                : "differs by more than 3 sigma: " + off);
  }
  return text;
}

ordered_json json_of(const std::vector<RecordingEstimate>& all, const std::vector<RefinedCamera>& refined) {
  ordered_json out = {{"cameras", ordered_json::array()}, {"recordings", ordered_json::array()}};
  for (const RefinedCamera& camera : refined) {
    ordered_json numbers = ordered_json::object();
    for (const CorrectionFound& number : numbers_of(camera.given, camera.estimate))
      numbers[number.name] = {{"off", number.off}, {"sigma", number.sigma}};
    out["cameras"].push_back({{"camera", camera.given.name}, {"corrections", numbers}});
  }
  for (const RecordingEstimate& result : all)
    out["recordings"].push_back({{"recording", result.recording},
                                 {"not_used", result.why_not},
                                 {"contradicts", contradictions(result, refined)}});
  return out;
}

/// The given calibration of the cameras used, the same for all recordings.
struct Begin {
  std::optional<Calibration> calibration;
  Rig used;
  Mode mode = Mode::Fused;
};

void take_begin(Begin& begin, const Source& source, Mode mode, const std::string& recording) {
  const Rig used = used_cameras(source.calibration.rig, mode);
  if (!begin.calibration) {
    begin = {source.calibration, used, mode};
  } else if (mode != begin.mode || !same_cameras(used, begin.used)) {
    throw InputError::format(
        "{}: has other cameras or another calibration than the first recording: give all the same one with --calib, "
        "and refine recordings with other cameras by themselves",
        recording);
  }
}

}  // namespace

int refine_calibration(const CalibOptions& options) {
  catch_interrupts();
  if (options.out.empty()) throw InputError("--refine: give the file for the calibration with --out FILE");
  check_writable(options.out, "--out");
  Begin begin;
  std::vector<RecordingEstimate> all;
  SourceOptions one = options.source_with_file();
  for (const std::string& recording : options.refined) {
    one.recording = recording;
    Source source = open_source(one);
    const Mode mode = choose_mode(options.mode, source.dataset->info());
    match_cameras(source, mode);
    take_begin(begin, source, mode, recording);
    all.push_back(estimate_of(recording, source, mode, options.quiet));
    if (interrupt_signal() != 0) return exit_code_of_interrupt();
  }
  const std::vector<RefinedCamera> refined = combine(all, begin.used, begin.mode);
  print_result(options.json, json_of(all, refined), text_of(all, refined));
  if (refined.empty()) return kExitNeverGood;
  Rig found;
  for (const RefinedCamera& camera : refined) found.cameras.push_back(camera.found);
  write_file(options.out, to_yaml(with_estimated(*begin.calibration, found)));
  if (!options.json) fmt::print("{:<11} edged run RECORDING --calib {}\n", "next", shell_word(options.out.string()));
  return kExitOk;
}

}  // namespace edged
