// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The parts of the module, and what they share.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "arrays.hpp"
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

/// Cameras by name.
py::dict cameras(const Rig& rig);

/// A variant as a class of Python.
struct PyMeasurement {
  Measurement value;
};

/// An odometry with the lock for its single-threaded calls.
struct PyOdometry {
  PyOdometry(const Calibration& calibration, Mode mode, const OptionValues& options, const SensorDelays& delays);
  std::mutex mutex;
  Odometry odometry;
};

void bind_log();
void bind_calibration(py::module_& module);
void bind_step(py::module_& module);
void bind_odometry(py::module_& module);
void bind_recording(py::module_& module);
void bind_evaluation(py::module_& module);

}  // namespace edged::python
