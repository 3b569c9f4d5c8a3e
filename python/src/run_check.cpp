// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What `edged run` checks beside its steps, for edged.run.
#include "edged/checks/recording_check.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "edged/core/check.hpp"

namespace edged::python {
namespace {

/// Logs each finding once.
class PyRunCheck {
 public:
  PyRunCheck(const PyRecording& recording, PyOdometry& odometry)
      : dataset_(*recording.dataset),
        check_(dataset_.info(),
               CheckedCalibration{odometry.odometry.rig().cameras,
                                  recording.calibration && recording.calibration->has_extrinsics,
                                  recording.calibration ? recording.calibration->known_noise() : std::nullopt},
               RecordingCheck::Effort::DuringRun) {}

  void add(const PyMeasurement& measurement) {
    check_.add(measurement.value);
    log(check_.news());
  }

  /// After the last measurement.
  void finish() {
    std::optional<GroundTruth> truth;
    try {
      truth = dataset_.ground_truth();
    } catch (const InputError& e) {
      spdlog::warn(fmt::format("ground truth: cannot be used: {}", e.what()));
    }
    log(check_.findings(dataset_, truth));
  }

 private:
  void log(const std::vector<Finding>& findings) {
    for (const Finding& finding : findings) {
      if (finding.severity < Severity::Warning || std::ranges::count(logged_, finding.text) > 0) continue;
      logged_.push_back(finding.text);
      const auto level = finding.severity == Severity::Error ? spdlog::level::err : spdlog::level::warn;
      spdlog::log(level, fmt::format("{}: {}", finding.text, finding.remedy));
    }
  }

  const Dataset& dataset_;
  RecordingCheck check_;
  std::vector<std::string> logged_;
};

}  // namespace

void bind_run_check(py::module_& module) {
  using Free = py::call_guard<py::gil_scoped_release>;
  py::class_<PyRunCheck>(module, "RunCheck")
      .def(py::init<const PyRecording&, PyOdometry&>(), py::keep_alive<1, 2>())
      .def("add", &PyRunCheck::add, Free())
      .def("finish", &PyRunCheck::finish, Free());
}

}  // namespace edged::python
