// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "bindings.hpp"
#include "edged/version.hpp"

PYBIND11_MODULE(_edged, module) {
  using namespace edged::python;
  module.attr("EVENT") = dtype_of<edged::Event>();
  module.attr("IMU") = dtype_of<edged::ImuSample>();
  module.attr("POSE") = pose_dtype();
  // Both are made with the GIL in hand, before threads may ask for them at once.
  static_cast<void>(dtype_of<edged::Track>());
  static_cast<void>(dtype_of<edged::Landmark>());
  bind_errors(module);
  bind_log();
  bind_calibration(module);
  bind_step(module);
  bind_odometry(module);
  bind_recording(module);
  bind_run_check(module);
  bind_evaluation(module);
  bind_docs(module);
  module.attr("__version__") = EDGED_VERSION;
}
