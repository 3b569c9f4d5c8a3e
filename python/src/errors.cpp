// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <regex>

#include "bindings.hpp"
#include "edged/core/check.hpp"

namespace edged::python {

std::string in_python(std::string message) {
  // Readers are the program's as well, whose flags their remedies name. The first that fits counts.
  static const std::pair<std::regex, const char*> kArguments[] = {
      {std::regex(R"(--topic ([^ =]+)=([^ ,;:)]+))"), R"(topics={"$1": "$2"})"},
      {std::regex("--geometry WIDTHxHEIGHT"), "geometry=(WIDTH, HEIGHT)"},
      {std::regex("--rig NAME or --calib FILE"), "rig=NAME or rig=FILE"},
      {std::regex("--set cameras=first"), R"(cameras="first")"},
      {std::regex(R"(--set ([^ =]+)=([^ ,;:)]+))"), R"(options={"$1": $2})"},
      {std::regex("--mode ([a-z]+)"), R"(mode="$1")"},
      {std::regex("--calib "), "rig="},
      {std::regex("--(rig|imu|height|velocity|cameras|mode) "), "$1="},
      {std::regex("--time-unit "), "time_unit="},
      {std::regex("--(from|start) "), "begin_s="},
      {std::regex("--to "), "end_s="},
      {std::regex("--max-gap"), "max_gap_s="}};
  if (message.find("--") == std::string::npos) return message;
  for (const auto& [flag, argument] : kArguments) message = std::regex_replace(message, flag, argument);
  return message;
}

void bind_errors(py::module_& module) {
  static const py::handle kError = py::exception<InputError>(module, "InputError", PyExc_ValueError).release();
  py::register_exception_translator([](std::exception_ptr error) {
    try {
      if (error) std::rethrow_exception(error);
    } catch (const InputError& e) {
      PyErr_SetString(kError.ptr(), in_python(e.what()).c_str());
    }
  });
}

}  // namespace edged::python
