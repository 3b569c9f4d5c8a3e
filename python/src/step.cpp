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

void add_covariance(py::class_<Step>& bound, const char* name, Eigen::Matrix3d StateCovariance::*part) {
  bound.def_property_readonly(name, [part](const Step& step) {
    return step.covariance ? std::optional<Eigen::Matrix3d>((*step.covariance).*part) : std::nullopt;
  });
}

/// A view that keeps its owner alive.
template <typename Class, typename T>
void add_array(py::class_<Class>& bound, const char* name, std::vector<T> Class::*items) {
  bound.def_property_readonly(name,
                              [items](const py::object& self) { return view(self.cast<const Class&>().*items, self); });
}

/// The value for a camera that the run does not have.
const CameraStep& camera_of(const Step& step, Modality modality) {
  static const CameraStep kNone;
  const CameraStep* camera = step.find(modality);
  return camera ? *camera : kNone;
}

py::object picture(const cv::Mat& image, const py::object& owner) {
  return image.empty() ? py::object(py::none()) : py::object(view(image, owner));
}

void bind_camera(py::module_& module) {
  py::class_<CameraStep> camera(module, "CameraStep");
  add_array(camera, "tracks", &CameraStep::tracks);
  add_array(camera, "events", &CameraStep::events);
  camera.def_readonly("name", &CameraStep::name)
      .def_property_readonly("modality",
                             [](const CameraStep& c) { return c.modality == Modality::Events ? "events" : "frames"; })
      .def_property_readonly("image",
                             [](const py::object& self) { return picture(self.cast<const CameraStep&>().image, self); })
      .def_readonly("survival_rate", &CameraStep::survival_rate)
      .def_readonly("rendered", &CameraStep::rendered)
      .def_readonly("event_rate_hz", &CameraStep::event_rate_hz)
      .def("__repr__", [](const CameraStep& c) {
        return fmt::format("<edged.CameraStep '{}' {} tracks>", c.name, c.tracks.size());
      });
}

/// Each camera keeps the step alive.
py::dict cameras_of(const py::object& self) {
  py::dict cameras;
  for (const CameraStep& camera : self.cast<const Step&>().cameras)
    cameras[py::str(camera.name)] = py::cast(&camera, py::return_value_policy::reference_internal, self);
  return cameras;
}

/// Values of the first camera of a kind have names of their own: most runs have one of each.
void bind_first_cameras(py::class_<Step>& bound) {
  const auto add = [&](const char* name, Modality modality, auto value) {
    bound.def_property_readonly(
        name, [=](const py::object& self) { return value(camera_of(self.cast<const Step&>(), modality), self); });
  };
  const auto tracks = [](const CameraStep& camera, const py::object& self) { return view(camera.tracks, self); };
  const auto image = [](const CameraStep& camera, const py::object& self) { return picture(camera.image, self); };
  const auto survival_rate = [](const CameraStep& camera, const py::object&) {
    return camera.name.empty() ? std::nullopt : std::optional(camera.survival_rate);
  };
  add("event_tracks", Modality::Events, tracks);
  add("frame_tracks", Modality::Frames, tracks);
  add("event_frame", Modality::Events, image);
  add("frame", Modality::Frames, image);
  add("event_track_survival_rate", Modality::Events, survival_rate);
  add("frame_track_survival_rate", Modality::Frames, survival_rate);
  add("events", Modality::Events,
      [](const CameraStep& camera, const py::object& self) { return view(camera.events, self); });
  add("rendered", Modality::Events, [](const CameraStep& camera, const py::object&) { return camera.rendered; });
  add("event_rate_hz", Modality::Events,
      [](const CameraStep& camera, const py::object&) { return camera.event_rate_hz; });
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
  state.def("__repr__", [](const NavState& s) {
    const Eigen::Vector3d& p = s.T_W_B.translation();
    return fmt::format("<edged.State {:.3f} s ({:.3f}, {:.3f}, {:.3f}) m>", to_seconds(s.t), p.x(), p.y(), p.z());
  });

  bind_camera(module);
  py::class_<LoopClosure>(module, "LoopClosure")
      .def_readonly("keyframe", &LoopClosure::keyframe)
      .def_readonly("position_m", &LoopClosure::position_m)
      .def_readonly("rotation_rad", &LoopClosure::rotation_rad);
  py::class_<Step> step(module, "Step");
  bind_state(step, [](const Step& s) -> const NavState& { return s.state; });
  bind_first_cameras(step);
  add_covariance(step, "position_covariance", &StateCovariance::position);
  add_covariance(step, "rotation_covariance", &StateCovariance::rotation);
  add_covariance(step, "velocity_covariance", &StateCovariance::velocity);
  add_array(step, "landmarks", &Step::landmarks);
  step.def_readonly("t", &Step::t)
      .def_readonly("status", &Step::status)
      .def_property_readonly("is_tracking", [](const Step& s) { return is_tracking(s.status); })
      .def(
          "pose_of", [](const Step& s, const std::string& frame) { return poses_array({s.pose_of(frame)}); },
          py::arg("frame"))
      .def_property_readonly("attitude",
                             [](const Step& s) -> std::optional<Eigen::Vector4d> {
                               if (!s.attitude) return std::nullopt;
                               return s.attitude->R_W_B.coeffs();
                             })
      .def_readonly("keyframe", &Step::keyframe)
      .def_readonly("relocalized", &Step::relocalized)
      .def_readonly("loop_closure", &Step::loop_closure)
      .def_readonly("waiting_for", &Step::waiting_for)
      .def_readonly("started", &Step::started)
      .def_readonly("lost_because", &Step::lost_because)
      .def_readonly("degraded_because", &Step::degraded_because)
      .def_readonly("contradicted", &Step::contradicted)
      .def_property_readonly("cameras", &cameras_of)
      .def_readonly("scene_depth", &Step::scene_depth)
      .def("__repr__", &step_text);
}

}  // namespace edged::python
