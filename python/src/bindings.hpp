// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The parts of the module, and what they share.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arrays.hpp"
#include "edged/dataset.hpp"
#include "edged/io/calibration.hpp"
#include "edged/odometry.hpp"

namespace edged::python {

/// Without the GIL and one thread at a time. The lock is taken without the GIL, as its holder may wait for the GIL.
template <typename Function>
auto guarded(std::mutex& mutex, const Function& function) {
  const py::gil_scoped_release free;
  const std::lock_guard lock(mutex);
  return function();
}

/// Options by their keys, of any type that prints as the option reads.
using OptionValues = std::map<std::string, py::object>;
template <typename Config>
void set_options(Config& config, const OptionValues& values) {
  ConfigFields fields = ConfigFields::of(config);
  for (const auto& [key, value] : values) {
    const bool is_bool = py::isinstance<py::bool_>(value);
    fields.set(key, is_bool ? (py::cast<bool>(value) ? "true" : "false") : std::string(py::str(value)));
  }
}

/// A Calibration, or the name or the file of one.
Calibration calibration_of(const py::object& calibration);

/// A message of the library with the arguments of the module in place of the flags of the program.
std::string in_python(std::string message);

/// Cameras by name.
py::dict cameras(const Rig& rig);

/// A variant as a class of Python.
struct PyMeasurement {
  Measurement value;
};

/// An odometry with the lock for its single-threaded calls.
struct PyOdometry {
  PyOdometry(const Calibration& calibration, Mode mode, const OdometryConfig& config, const SensorDelays& delays);
  /// Throws InputError if the calibration has no camera of that name and kind; one that the mode leaves out is fine.
  /// InputError where the calibration has no such camera.
  const RigCamera& camera(const std::string& name, Modality modality) const;
  const Rig rig;  ///< cameras of the calibration
  std::mutex mutex;
  Odometry odometry;
};

/// A recording with the lock for its single-threaded calls.
struct PyRecording {
  std::mutex mutex;
  std::unique_ptr<Dataset> dataset;
  std::optional<Calibration> calibration;
  std::vector<std::string> cameras;  ///< names, where a run does not use the first of each kind
};

OdometryConfig with_options(const OptionValues& options);

void bind_errors(py::module_& module);
void bind_log();
void bind_calibration(py::module_& module);
void bind_step(py::module_& module);
void bind_odometry(py::module_& module);
void bind_recording(py::module_& module);
void bind_run_check(py::module_& module);
void bind_evaluation(py::module_& module);
void bind_docs(py::module_& module);

}  // namespace edged::python
