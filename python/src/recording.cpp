// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <array>
#include <functional>
#include <variant>

#include "bindings.hpp"
#include "edged/checks/found_imu_clock.hpp"
#include "edged/core/check.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/core/measurements/recording_piece.hpp"
#include "edged/io/aedat/aedat.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/parse/text_parsing.hpp"
#include "edged/io/text/sample_files.hpp"
#include "edged/pipeline/mode.hpp"
#include "edged/sim/simulated_pair.hpp"
#include "edged/sim/simulator.hpp"

namespace edged::python {
namespace {

/// Ctrl-C while a live source waits: its handler runs, what that throws stays pending.
bool interrupted() {
  const py::gil_scoped_acquire gil;
  return PyErr_Occurred() != nullptr || PyErr_CheckSignals() != 0;
}

std::unique_ptr<PyRecording> piece_of(Recording recording, const std::optional<double>& begin_s,
                                      const std::optional<double>& end_s) {
  if (begin_s || end_s)
    recording.dataset =
        std::make_unique<RecordingPiece>(std::move(recording.dataset), PieceBounds{begin_s.value_or(0.0), end_s});
  auto opened = std::make_unique<PyRecording>();
  opened->dataset = std::move(recording.dataset);
  opened->calibration = std::move(recording.calibration);
  return opened;
}

/// Files of sensors beside a recording, by the names of the arguments: "imu" and the external sensors.
using SensorFiles = std::map<std::string, std::string>;

Recording with_files(Recording recording, const SensorFiles& files, bool imu_has_own_clock) {
  for (const auto& [sensor, file] : files)
    recording.dataset = sensor == "imu"
                            ? with_imu_file(std::move(recording.dataset), file, imu_has_own_clock)
                            : with_external_file(std::move(recording.dataset), *find_external_sensor(sensor), file);
  return recording;
}

/// The names of the cameras to read; "all", "first" (of each kind), or None: as `edged run` chooses.
using CameraChoice = std::optional<std::variant<std::vector<std::string>, std::string>>;

Recording open_cameras(const std::string& file, const std::optional<Calibration>& calibration,
                       const RecordingOptions& options, const SensorFiles& files) {
  Recording recording = open_recording(file, calibration ? &calibration->rig : nullptr, options);
  if (calibration) recording.calibration = calibration;
  return with_files(std::move(recording), files, options.imu_has_own_clock);
}

/// Sets what is opened; the names of several cameras of a kind go to `chosen`.
Recording open_choice(const std::string& file, const std::optional<Calibration>& calibration, RecordingOptions options,
                      const SensorFiles& files, const CameraChoice& cameras, std::vector<std::string>& chosen) {
  const auto open = [&](const std::vector<std::string>& names, bool all) {
    options.cameras = names;
    options.all_cameras = all;
    return open_cameras(file, calibration, options, files);
  };
  if (!cameras && !file.starts_with(kTcpPrefix)) return open_with_stereo_cameras(open, chosen);
  if (!cameras) return open({}, false);
  if (const auto* names = std::get_if<std::vector<std::string>>(&*cameras)) return open(chosen = *names, false);
  return open({}, std::get<std::string>(*cameras) == "all");
}

/// Of an IMU with an epoch of its own: the seconds to add to its stamps, or "auto".
using ImuTimeOffset = std::optional<std::variant<double, std::string>>;

/// All on one clock. reopen: opens it, as it is.
Recording on_one_clock(const std::string& file, const ImuTimeOffset& offset, const std::function<Recording()>& reopen) {
  if (!offset) return reopen();
  const auto* number = std::get_if<double>(&*offset);
  const auto seconds = given_imu_offset_s(number ? fmt::format("{}", *number) : std::get<std::string>(*offset));
  if (file.starts_with(kTcpPrefix)) return with_live_imu_clock(reopen(), seconds, 1.0);
  const auto read = [](Dataset& dataset, const std::function<void(const Measurement&)>& use) {
    constexpr std::size_t kAsked = 1000;
    for (std::size_t i = 0; i % kAsked != 0 || !interrupted(); ++i) {
      const auto measurement = dataset.next();
      if (!measurement) return true;
      use(*measurement);
    }
    return false;
  };
  const ImuClock clock =
      seconds ? ImuClock{duration_from_seconds(*seconds)} : determine_imu_clock(reopen, read, 1.0).clock;
  Recording recording = reopen();
  recording.dataset = with_imu_clock(std::move(recording.dataset), reopen().dataset, clock);
  return recording;
}

SensorFiles given_files(const py::kwargs& files) {
  SensorFiles given;
  for (const auto& [key, file] : files) {
    const std::string sensor = py::str(key);
    if (sensor != "imu" && !find_external_sensor(sensor))
      throw py::type_error(fmt::format(
          "open_recording() got an unexpected keyword argument '{}'; there are rig (a calibration), topics, "
          "geometry, time_unit, begin_s, end_s, cameras, imu_time_offset, and files of imu, height, velocity",
          sensor));
    if (!file.is_none()) given[sensor] = py::str(file);
  }
  return given;
}

std::unique_ptr<PyRecording> open(const py::object& path, const py::object& rig,
                                  const std::map<std::string, std::string>& topics,
                                  const std::optional<std::array<int, 2>>& geometry,
                                  const std::optional<std::string>& time_unit, const std::optional<double>& begin_s,
                                  const std::optional<double>& end_s, const CameraChoice& cameras,
                                  const ImuTimeOffset& imu_time_offset, const py::kwargs& sensor_files) {
  const std::string file = py::str(path);
  std::optional<Calibration> calibration;
  if (!rig.is_none()) calibration = calibration_of(rig);
  const SensorFiles files = given_files(sensor_files);
  RecordingOptions options;
  options.topics = topics;
  options.own_imu = !files.contains("imu");
  options.imu_has_own_clock = imu_time_offset.has_value();
  if (calibration) options.camera_topics = calibration->topics;
  const auto* choice = cameras ? std::get_if<std::string>(&*cameras) : nullptr;
  if (choice && *choice != "all" && *choice != "first")
    throw InputError::format("cameras '{}': give a list of names, 'first' (of each kind) or 'all'", *choice);
  options.interrupted = interrupted;
  if (geometry) options.geometry = cv::Size((*geometry)[0], (*geometry)[1]);
  if (time_unit && !(options.time_unit = parse_time_unit(*time_unit)))
    throw InputError::format("time_unit '{}': there are s, ms, us and ns", *time_unit);
  std::unique_ptr<PyRecording> opened;
  {
    const py::gil_scoped_release free;
    std::vector<std::string> chosen;
    const auto reopen = [&] { return open_choice(file, calibration, options, files, cameras, chosen); };
    opened = piece_of(on_one_clock(file, imu_time_offset, reopen), begin_s, end_s);
    opened->cameras = std::move(chosen);
  }
  if (PyErr_Occurred() != nullptr) throw py::error_already_set();
  return opened;
}

std::unique_ptr<PyRecording> simulate(const std::string& preset, int seed, const std::optional<double>& duration_s,
                                      const OptionValues& options, const std::optional<double>& begin_s,
                                      const std::optional<double>& end_s, const std::optional<double>& baseline_m) {
  SimulatorConfig config = simulator_preset(preset);
  config.seed = seed;
  if (duration_s) config.duration_s = *duration_s;
  set_options(config, options);
  const py::gil_scoped_release free;
  const auto opened = [&](auto simulator) {
    Calibration calibration = simulator->calibration();
    return piece_of({std::move(simulator), std::move(calibration)}, begin_s, end_s);
  };
  if (baseline_m) return opened(std::make_unique<SimulatedPair>(config, *baseline_m));
  return opened(std::make_unique<Simulator>(config));
}

PyMeasurement next_measurement(PyRecording& self) {
  std::optional<Measurement> measurement = guarded(self.mutex, [&] { return self.dataset->next(); });
  if (PyErr_Occurred() != nullptr) throw py::error_already_set();
  if (!measurement) throw py::stop_iteration();
  return {std::move(*measurement)};
}

/// The poses and whose they are.
py::object ground_truth(PyRecording& self) {
  const std::optional<GroundTruth> truth = guarded(self.mutex, [&] { return self.dataset->ground_truth(); });
  if (!truth) return py::none();
  return py::make_tuple(truth->frame, poses_array(truth->trajectory));
}

/// The calibration of the recording, its cameras of the mode under the recording's names; with a warning for each
/// assumption.
Calibration matched_calibration(const PyRecording& self, Mode mode) {
  const DatasetInfo& info = self.dataset->info();
  if (!self.calibration)
    throw InputError::format("{}: has no calibration of cameras and IMU; open it with rig=NAME, one of known_rigs()",
                             info.name);
  Calibration calibration = *self.calibration;
  if (!calibration.has_extrinsics)
    throw InputError::format("{}: its calibration holds intrinsics only; open it with rig=NAME, one of known_rigs()",
                             info.name);
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    if (!uses(mode, modality)) continue;
    const std::string assumed = match_camera(calibration.rig, info, modality);
    if (!assumed.empty() && PyErr_WarnEx(PyExc_UserWarning, assumed.c_str(), 1) != 0) throw py::error_already_set();
  }
  return calibration;
}

std::unique_ptr<PyOdometry> odometry(const PyRecording& self, const std::string& mode, const OptionValues& options) {
  const Mode chosen = choose_mode(mode, self.dataset->info());
  OdometryConfig config = with_options(options);
  if (config.cameras.empty() && config.stereo.enabled) config.cameras = fmt::format("{}", fmt::join(self.cameras, ","));
  return std::make_unique<PyOdometry>(matched_calibration(self, chosen), chosen, config, kInOrder);
}

const char* kind(const PyMeasurement& measurement) {
  if (const auto* sample = std::get_if<ExternalSample>(&measurement.value)) return sensor_of(*sample).name.data();
  return std::array{"events", "frame", "imu"}[measurement.value.index()];
}

std::optional<std::string> camera(const PyMeasurement& measurement) {
  if (const auto* batch = std::get_if<EventBatch>(&measurement.value)) return batch->camera;
  if (const auto* frame = std::get_if<Frame>(&measurement.value)) return frame->camera;
  return std::nullopt;
}

Timestamp stamp(const PyMeasurement& measurement) { return first_stamp(measurement.value).value_or(Timestamp()); }

py::array data(const py::object& self) {
  const Measurement& measurement = self.cast<const PyMeasurement&>().value;
  if (const auto* batch = std::get_if<EventBatch>(&measurement)) return view(batch->events, self);
  if (const auto* frame = std::get_if<Frame>(&measurement)) return view(frame->image, self);
  if (const auto* sample = std::get_if<ImuSample>(&measurement)) return view(dtype_of<ImuSample>(), sample, 1, self);
  const auto& sample = std::get<ExternalSample>(measurement);
  const auto [values, sigmas] = sensor_of(sample).numbers(sample);
  py::array_t<double> rows({py::ssize_t{2}, static_cast<py::ssize_t>(values.size())});
  std::ranges::copy(values, rows.mutable_data(0));
  std::ranges::copy(sigmas, rows.mutable_data(1));
  return rows;
}

std::string measurement_text(const PyMeasurement& measurement) {
  std::string text =
      fmt::format("<edged.Measurement {} at {:.3f} s", kind(measurement), to_seconds(stamp(measurement)));
  if (const auto name = camera(measurement)) text += " of '" + *name + "'";
  if (const auto* batch = std::get_if<EventBatch>(&measurement.value))
    text += fmt::format(": {} events", batch->events.size());
  return text + ">";
}

/// "'flight' (ecd) of events, frames, imu".
std::string summary(const DatasetInfo& info) {
  std::vector<std::string> sensors;
  for (const RecordedCamera& camera : recorded_cameras(info)) sensors.push_back(camera.name);
  if (info.has_imu) sensors.emplace_back("imu");
  sensors.insert(sensors.end(), info.external.begin(), info.external.end());
  return fmt::format("'{}' ({}) of {}", info.name, info.format, fmt::join(sensors, ", "));
}

void bind_info(py::module_& module) {
  py::class_<RecordedCamera>(module, "RecordedCamera")
      .def_readonly("name", &RecordedCamera::name)
      .def_property_readonly(
          "kind",
          [](const RecordedCamera& camera) { return camera.modality == Modality::Events ? "events" : "frames"; })
      .def_readonly("stream", &RecordedCamera::stream)
      .def_property_readonly(
          "sensor",
          [](const RecordedCamera& camera) { return py::make_tuple(camera.sensor.width, camera.sensor.height); })
      .def("__repr__", [](const RecordedCamera& camera) {
        return fmt::format("<edged.RecordedCamera '{}' {}>", camera.name, kind_name(camera.modality));
      });
  py::class_<DatasetInfo>(module, "RecordingInfo")
      .def_readonly("name", &DatasetInfo::name)
      .def_readonly("format", &DatasetInfo::format)
      .def_readonly("pose_frame", &DatasetInfo::pose_frame)
      .def_readonly("begin", &DatasetInfo::begin)
      .def_readonly("end", &DatasetInfo::end)
      .def_readonly("has_events", &DatasetInfo::has_events)
      .def_readonly("has_frames", &DatasetInfo::has_frames)
      .def_readonly("has_imu", &DatasetInfo::has_imu)
      .def_readonly("external", &DatasetInfo::external)
      .def_readonly("event_camera", &DatasetInfo::event_camera)
      .def_readonly("frame_camera", &DatasetInfo::frame_camera)
      .def_property_readonly("cameras", &recorded_cameras)
      .def_property_readonly(
          "event_sensor",
          [](const DatasetInfo& info) { return py::make_tuple(info.event_sensor.width, info.event_sensor.height); })
      .def("__repr__", [](const DatasetInfo& info) { return fmt::format("<edged.RecordingInfo {}>", summary(info)); });
}

}  // namespace

void bind_recording(py::module_& module) {
  bind_info(module);
  py::class_<PyMeasurement>(module, "Measurement")
      .def_property_readonly("kind", &kind)
      .def_property_readonly("camera", &camera)
      .def_property_readonly("t", &stamp)
      .def_property_readonly("data", &data)
      .def("__repr__", &measurement_text);
  py::class_<PyRecording>(module, "Recording")
      .def_property_readonly("info", [](const PyRecording& self) { return self.dataset->info(); })
      .def_readonly("calibration", &PyRecording::calibration)
      .def_property_readonly("ground_truth", &ground_truth)
      .def_property_readonly(
          "repairs", [](PyRecording& self) { return guarded(self.mutex, [&] { return self.dataset->repairs(); }); })
      .def("odometry", &odometry, py::arg("mode") = "auto", py::arg("options") = OptionValues{})
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", &next_measurement)
      .def("__repr__",
           [](const PyRecording& self) { return fmt::format("<edged.Recording {}>", summary(self.dataset->info())); });
  module.def("open_recording", &open, py::arg("path"), py::arg("rig") = py::none(),
             py::arg("topics") = std::map<std::string, std::string>{}, py::arg("geometry") = py::none(),
             py::arg("time_unit") = py::none(), py::arg("begin_s") = py::none(), py::arg("end_s") = py::none(),
             py::arg("cameras") = py::none(), py::arg("imu_time_offset") = py::none());
  module.def("simulate", &simulate, py::arg("preset") = "room", py::arg("seed") = 1, py::arg("duration_s") = py::none(),
             py::arg("options") = OptionValues{}, py::arg("begin_s") = py::none(), py::arg("end_s") = py::none(),
             py::arg("baseline_m") = py::none());
  module.def("simulator_presets", &simulator_presets);
}

}  // namespace edged::python
