// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "bindings.hpp"
#include "edged/eval/evaluation_json.hpp"
#include "edged/io/parse/trajectory_io.hpp"

namespace edged::python {
namespace {

/// What `edged eval --json` prints, for the module to read.
std::string evaluate_to_json(const py::array& estimate, const py::array& truth, const std::string& protocol_name,
                             double max_gap_s, const std::vector<double>& deltas_s) {
  const Trajectory estimated = trajectory_of(estimate), true_poses = trajectory_of(truth);
  const py::gil_scoped_release free;
  const Association association = associate(true_poses, estimated, duration_from_seconds(max_gap_s));
  return to_json(evaluate(association, protocol(protocol_name), deltas_s)).dump();
}

}  // namespace

void bind_evaluation(py::module_& module) {
  module.def("evaluate_to_json", &evaluate_to_json, py::arg("estimate"), py::arg("truth"), py::arg("protocol"),
             py::arg("max_gap_s"), py::arg("deltas_s"));
  module.def(
      "read_trajectory",
      [](const py::object& file) { return poses_array(read_trajectory(std::string(py::str(file)))); }, py::arg("file"));
}

}  // namespace edged::python
