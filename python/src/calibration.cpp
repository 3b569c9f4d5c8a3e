// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "bindings.hpp"
#include "edged/io/core/camera_names.hpp"

namespace edged::python {

Calibration calibration_of(const py::object& calibration) {
  if (py::isinstance<Calibration>(calibration)) return calibration.cast<Calibration>();
  return load_rig(py::str(calibration));
}

py::dict cameras(const Rig& rig) {
  py::dict result;
  for (const RigCamera& camera : rig.cameras) result[py::str(camera.name)] = camera;
  return result;
}

void bind_calibration(py::module_& module) {
  py::class_<RigCamera>(module, "Camera")
      .def_readonly("name", &RigCamera::name)
      .def_property_readonly("modality",
                             [](const RigCamera& c) { return c.modality == Modality::Events ? "events" : "frames"; })
      .def_property_readonly("size",
                             [](const RigCamera& c) { return py::make_tuple(c.model.width(), c.model.height()); })
      .def_property_readonly(
          "pinhole",
          [](const RigCamera& c) { return py::make_tuple(c.model.fx(), c.model.fy(), c.model.cx(), c.model.cy()); })
      .def_property_readonly("T_B_C", [](const RigCamera& c) { return c.T_B_C.matrix(); })
      .def_readonly("time_offset", &RigCamera::time_offset)
      .def("__repr__", [](const RigCamera& c) {
        return fmt::format("<edged.Camera '{}' {} {}x{}>", c.name, kind_name(c.modality), c.model.width(),
                           c.model.height());
      });
  py::class_<Calibration>(module, "Calibration")
      .def_property_readonly("rig", [](const Calibration& c) { return cameras(c.rig); })
      .def_readonly("has_extrinsics", &Calibration::has_extrinsics)
      .def_readonly("warnings", &Calibration::warnings)
      .def("to_yaml", [](const Calibration& c) { return to_yaml(c); })
      .def("__str__", &describe)
      .def("__repr__", [](const Calibration& c) {
        std::vector<std::string> names;
        for (const RigCamera& camera : c.rig.cameras) names.push_back(camera.name);
        return fmt::format("<edged.Calibration '{}' of {}>", c.rig.name, fmt::join(names, ", "));
      });
  module.def(
      "load_rig", [](const py::object& name) { return load_rig(py::str(name)); }, py::arg("name"));
  module.def(
      "load_calibration", [](const py::object& path) { return load_calibration(std::string(py::str(path))); },
      py::arg("path"));
  module.def("known_rigs", &known_rigs);
}

}  // namespace edged::python
