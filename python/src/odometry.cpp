// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <variant>
#include <vector>

#include "bindings.hpp"
#include "edged/core/check.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/imu/imu_gate.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/pipeline/mode.hpp"

namespace edged::python {
namespace {

SensorDelays delays_of(const std::map<std::string, double>& given, bool in_order) {
  SensorDelays delays = in_order ? kInOrder : SensorDelays{};
  const std::map<std::string, double*> known = {{"events", &delays.events_s},
                                                {"frames", &delays.frames_s},
                                                {"imu", &delays.imu_s},
                                                {"external", &delays.external_s}};
  for (const auto& [sensor, seconds] : given) {
    const auto found = known.find(sensor);
    if (found == known.end())
      throw InputError::format("delays: '{}' is none of events, frames, imu and external", sensor);
    *found->second = seconds;
  }
  return delays;
}

std::unique_ptr<PyOdometry> make_odometry(const py::object& calibration, const std::string& mode,
                                          const OptionValues& options, bool in_order,
                                          const std::map<std::string, double>& delays) {
  const Calibration chosen = calibration_of(calibration);
  if (!chosen.has_extrinsics)
    throw InputError("the calibration holds intrinsics only: the pose of the camera to the IMU is missing");
  return std::make_unique<PyOdometry>(chosen, parse_mode(mode), with_options(options), delays_of(delays, in_order));
}

void add_events(PyOdometry& self, std::string camera, const py::array& events) {
  self.camera(camera, Modality::Events);
  check_events(events);
  const void* const data = events.data();
  const auto size = static_cast<std::size_t>(events.size());
  const py::gil_scoped_release free;
  self.odometry.add(EventBatch{std::move(camera), copy_events(data, size)});
}

void add_frame(PyOdometry& self, std::string camera, Timestamp t, const py::array& image) {
  const CameraModel& model = self.camera(camera, Modality::Frames).model;
  check_image(image);
  if (image.shape(1) != model.width() || image.shape(0) != model.height())
    throw py::value_error(fmt::format("image: has {} x {} pixels, width x height; camera {} has {} x {}",
                                      image.shape(1), image.shape(0), camera, model.width(), model.height()));
  // A view of the caller's memory: Odometry::add copies the pixels of an image that does not own them.
  const cv::Mat pixels(static_cast<int>(image.shape(0)), static_cast<int>(image.shape(1)), CV_8UC1,
                       const_cast<void*>(image.data()));
  const py::gil_scoped_release free;
  self.odometry.add(Frame{t, std::move(camera), pixels});
}

void add_imu(PyOdometry& self, const py::array& samples) {
  check_imu(samples);
  const void* const data = samples.data();
  const auto size = static_cast<std::size_t>(samples.size());
  const py::gil_scoped_release free;
  for (std::size_t i = 0; i < size; ++i) self.odometry.add(imu_sample(data, i));
}

/// One number for all columns, or one each.
std::vector<double> each_column(const ExternalSensor& sensor, const char* what,
                                const std::variant<double, std::vector<double>>& given) {
  const std::size_t n = sensor.columns.size();
  if (const auto* one = std::get_if<double>(&given)) {
    if (n == 1 || std::string_view(what) == "sigma") return std::vector<double>(n, *one);
  } else if (std::get<std::vector<double>>(given).size() == n) {
    return std::get<std::vector<double>>(given);
  }
  throw InputError::format("add_{}: {} must be {} numbers", sensor.name, what, n);
}

/// add_height, add_velocity: one a sensor of the table, its argument named as it is.
void bind_external(py::class_<PyOdometry>& odometry) {
  using Numbers = std::variant<double, std::vector<double>>;
  for (const ExternalSensor& sensor : external_sensors()) {
    const std::string name(sensor.name);
    const auto add = [&sensor](PyOdometry& self, Timestamp t, const Numbers& values, const Numbers& sigma) {
      const ExternalSample sample =
          sensor.sample(t, {each_column(sensor, "values", values), each_column(sensor, "sigma", sigma)});
      const py::gil_scoped_release free;
      self.odometry.add(sample);
    };
    odometry.def(("add_" + name).c_str(), add, py::arg("t"), py::arg(sensor.name.data()),
                 py::arg("sigma") = Numbers(0.0));
  }
}

/// One of the single-threaded calls of the odometry.
template <auto Call>
auto call(PyOdometry& self) {
  return guarded(self.mutex, [&] { return (self.odometry.*Call)(); });
}

Step next_step_or_stop(PyOdometry& self) {
  std::optional<Step> step = call<&Odometry::next>(self);
  if (!step) throw py::stop_iteration();
  return std::move(*step);
}

std::map<std::string, std::size_t> counters(PyOdometry& self) {
  const auto [in, out, external] = call<&Odometry::counters>(self);
  std::map<std::string, std::size_t> counters{{"unknown_camera", in.unknown_camera},
                                              {"unused_camera", in.unused_camera},
                                              {"absurd_stamps", in.absurd_stamps},
                                              {"far_ahead", in.far_ahead},
                                              {"clocks_set_back", in.clocks_set_back},
                                              {"events_outside", in.events_outside},
                                              {"frames_unfit", in.frames_unfit},
                                              {"external_unfit", in.external_unfit},
                                              {"no_room", in.no_room},
                                              {"packets", out.packets},
                                              {"packets_before_imu", out.packets_before_imu},
                                              {"packets_after_imu", out.packets_after_imu},
                                              {"packets_overflow", out.packets_overflow},
                                              {"events_late", out.events_late},
                                              {"events_surplus", out.events_surplus},
                                              {"events_flicker", out.events_flicker},
                                              {"events_lost", out.events_lost},
                                              {"frames_late", out.frames_late},
                                              {"frames_missing", out.frames_missing}};
  for (std::size_t i = 0; i < kImuFaults; ++i) counters[std::string(imu_fault_infos()[i].key)] = out.imu[i];
  for (std::size_t i = 0; i < external_sensors().size(); ++i) {
    const std::string name(external_sensors()[i].name);
    counters[name + "_in_packets"] = out.external[i];
    counters[name + "_used"] = external.used[i];
    counters[name + "_rejected"] = external.rejected[i];
    counters[name + "_late"] = out.external_late[i];
    counters[name + "_lost"] = out.external_lost[i];
  }
  return counters;
}

void load_map(PyOdometry& self, const py::bytes& map) {
  const std::string bytes = map;
  guarded(self.mutex, [&] { self.odometry.load_map(bytes); });
}

std::optional<py::bytes> save_map(PyOdometry& self) {
  const std::optional<std::string> bytes = call<&Odometry::save_map>(self);
  return bytes ? std::optional(py::bytes(*bytes)) : std::nullopt;
}

Trajectory keyframe_poses(const FinalTrajectory& known) {
  Trajectory poses;
  for (const MappedKeyframe& keyframe : known.keyframes) poses.push_back({keyframe.t, keyframe.T_W_B});
  return poses;
}

py::array_t<double> map_points(const FinalTrajectory& known) {
  std::vector<double> rows;
  for (const MappedKeyframe& keyframe : known.keyframes) {
    for (const MappedKeyframe::Point& point : keyframe.points)
      rows.insert(rows.end(), point.p_W.data(), point.p_W.data() + 3);
  }
  return py::array_t<double>({static_cast<py::ssize_t>(rows.size() / 3), py::ssize_t{3}}, rows.data());
}

std::map<std::string, double> timings(PyOdometry& self) {
  const StageTimings timings = guarded(self.mutex, [&] { return self.odometry.timings(); });
  std::map<std::string, double> total_s;
  for (const auto& [stage, timing] : timings.all()) total_s[stage] = timing.total_s();
  return total_s;
}

}  // namespace

OdometryConfig with_options(const OptionValues& options) {
  OdometryConfig config;
  set_options(config, options);
  return config;
}

PyOdometry::PyOdometry(const Calibration& calibration, Mode mode, const OdometryConfig& config,
                       const SensorDelays& delays)
    : rig(calibration.rig), odometry(calibration.rig, calibration.imu, mode, config, {delays}) {}

const RigCamera& PyOdometry::camera(const std::string& name, Modality modality) const {
  std::vector<std::string> names;
  for (const RigCamera& camera : rig.cameras) {
    if (camera.modality != modality) continue;
    if (camera.name == name) return camera;
    names.push_back(camera.name);
  }
  throw InputError::format("add_{}: no camera '{}'; of {} the calibration has: {}",
                           modality == Modality::Events ? "events" : "frame", name, kind_name(modality),
                           names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")));
}

void bind_odometry(py::module_& module) {
  using Free = py::call_guard<py::gil_scoped_release>;
  py::class_<FinalTrajectory>(module, "FinalTrajectory")
      .def_property_readonly("poses", [](const FinalTrajectory& known) { return poses_array(known.poses); })
      .def_property_readonly("keyframes",
                             [](const FinalTrajectory& known) { return poses_array(keyframe_poses(known)); })
      .def_property_readonly("points", &map_points)
      .def("__repr__", [](const FinalTrajectory& known) {
        return fmt::format("<edged.FinalTrajectory {} poses, {} keyframes>", known.poses.size(),
                           known.keyframes.size());
      });
  py::class_<PyOdometry> odometry(module, "Odometry");
  bind_external(odometry);
  odometry
      .def(py::init(&make_odometry), py::arg("calibration"), py::arg("mode") = "fused",
           py::arg("options") = OptionValues{}, py::arg("in_order") = false,
           py::arg("delays") = std::map<std::string, double>{})
      .def("add_events", &add_events, py::arg("camera"), py::arg("events"))
      .def("add_frame", &add_frame, py::arg("camera"), py::arg("t"), py::arg("image"))
      .def("add_imu", &add_imu, py::arg("samples"))
      .def(
          "add", [](PyOdometry& self, const PyMeasurement& measurement) { self.odometry.add(measurement.value); },
          py::arg("measurement"), Free())
      .def(
          "finish", [](PyOdometry& self) { self.odometry.finish(); }, Free())
      .def("next", &call<&Odometry::next>)
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", &next_step_or_stop)
      .def(
          "newest_state", [](const PyOdometry& self) { return self.odometry.newest_state(); }, Free())
      .def(
          "state_at", [](const PyOdometry& self, Timestamp t) { return self.odometry.state_at(t); }, py::arg("t"),
          Free())
      .def("load_map", &load_map, py::arg("map"))
      .def("save_map", &save_map)
      .def_property_readonly("awaiting_relocalization", &call<&Odometry::awaiting_relocalization>)
      .def("final_trajectory",
           [](PyOdometry& self) { return guarded(self.mutex, [&] { return self.odometry.final_trajectory(); }); })
      .def_property_readonly("rig", [](PyOdometry& self) { return cameras(call<&Odometry::rig>(self)); })
      .def_property_readonly("counters", &counters)
      .def_property_readonly("timings", &timings)
      .def("__repr__", [](PyOdometry& self) {
        std::vector<std::string> names;
        for (const RigCamera& camera : call<&Odometry::rig>(self).cameras) names.push_back(camera.name);
        return fmt::format("<edged.Odometry of {}>", fmt::join(names, ", "));
      });
}

}  // namespace edged::python
