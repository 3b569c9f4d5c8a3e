// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>

#include "bindings.hpp"

namespace edged::python {
namespace {

/// x, y, z, w as in TUM files and ROS.
Eigen::Vector4d quaternion(const NavState& state) { return state.T_W_B.rotation().coeffs(); }

/// The properties of a state, on a class that has one.
template <typename Class, typename State>
void bind_state(Class& bound, const State& state_of) {
  const auto add = [&](const char* name, auto value) {
    bound.def_property_readonly(name, [=](const typename Class::type& self) { return value(state_of(self)); });
  };
  add("T_W_B", [](const NavState& state) { return state.T_W_B.matrix(); });
  add("position", [](const NavState& state) { return Eigen::Vector3d(state.T_W_B.translation()); });
  add("quaternion", quaternion);
  add("velocity", [](const NavState& state) { return state.v_W; });
  add("bias_gyro", [](const NavState& state) { return state.bias_gyro; });
  add("bias_accel", [](const NavState& state) { return state.bias_accel; });
}

std::string step_text(const Step& step) {
  const Eigen::Vector3d& p = step.state.T_W_B.translation();
  const std::string head = fmt::format("<edged.Step {:.3f} s {}", to_seconds(step.t), to_string(step.status));
  if (step.status == TrackingStatus::Initializing) return head + ">";
  return head + fmt::format(" ({:.3f}, {:.3f}, {:.3f}) m>", p.x(), p.y(), p.z());
}

template <typename Part>
std::optional<Eigen::Matrix3d> covariance(const Step& step, Part part) {
  if (!step.covariance) return std::nullopt;
  return (*step.covariance).*part;
}

py::object frame_of(const py::object& self) {
  const auto& step = self.cast<const Step&>();
  return step.frame ? py::object(view(step.frame->image, self)) : py::object(py::none());
}

py::object event_frame_of(const py::object& self) {
  const auto& step = self.cast<const Step&>();
  return step.event_frame.empty() ? py::object(py::none()) : py::object(view(step.event_frame, self));
}

void bind_arrays(py::class_<Step>& bound) {
  const auto add = [&](const char* name, auto member) {
    bound.def_property_readonly(name,
                                [=](const py::object& self) { return view(self.cast<const Step&>().*member, self); });
  };
  add("event_tracks", &Step::event_tracks);
  add("frame_tracks", &Step::frame_tracks);
  add("landmarks", &Step::landmarks);
  add("events", &Step::events);
  bound.def_property_readonly("event_frame", &event_frame_of);
  bound.def_property_readonly("frame", &frame_of);
}

}  // namespace

void bind_step(py::module_& module) {
  py::enum_<TrackingStatus>(module, "Status")
      .value("INITIALIZING", TrackingStatus::Initializing)
      .value("GOOD", TrackingStatus::Good)
      .value("DEGRADED", TrackingStatus::Degraded)
      .value("LOST", TrackingStatus::Lost);

  py::class_<NavState> state(module, "State");
  state.def_readonly("t", &NavState::t);
  bind_state(state, [](const NavState& s) -> const NavState& { return s; });

  py::class_<Step> step(module, "Step");
  bind_state(step, [](const Step& s) -> const NavState& { return s.state; });
  bind_arrays(step);
  step.def_readonly("t", &Step::t)
      .def_readonly("status", &Step::status)
      .def_property_readonly("is_tracking", [](const Step& s) { return is_tracking(s.status); })
      .def_property_readonly("position_covariance",
                             [](const Step& s) { return covariance(s, &PoseCovariance::position); })
      .def_property_readonly("rotation_covariance",
                             [](const Step& s) { return covariance(s, &PoseCovariance::rotation); })
      .def_readonly("keyframe", &Step::keyframe)
      .def_readonly("found_again", &Step::found_again)
      .def_readonly("waiting_for", &Step::waiting_for)
      .def_readonly("started", &Step::started)
      .def_readonly("lost_because", &Step::lost_because)
      .def_readonly("event_survival", &Step::event_survival)
      .def_readonly("frame_survival", &Step::frame_survival)
      .def_readonly("drawn", &Step::drawn)
      .def_readonly("event_rate_hz", &Step::event_rate_hz)
      .def_readonly("scene_depth", &Step::scene_depth)
      .def("__repr__", &step_text);
}

}  // namespace edged::python
