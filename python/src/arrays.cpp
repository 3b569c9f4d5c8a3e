// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstddef>
#include <cstring>

namespace edged::python {
namespace {

static_assert(sizeof(Event) == 16 && offsetof(Event, t) == 0 && offsetof(Event, x) == 8 && offsetof(Event, y) == 10 &&
              offsetof(Event, positive) == 12 && sizeof(bool) == 1);

struct Field {
  const char* name;
  const char* format;
  std::size_t offset;
};

py::dtype make_dtype(std::initializer_list<Field> fields, std::size_t size) {
  py::list names, formats, offsets;
  for (const Field& field : fields) {
    names.append(field.name);
    formats.append(field.format);
    offsets.append(field.offset);
  }
  // Aligned: numpy keeps the gaps of such a one where it joins arrays, and closes those of others.
  using namespace py::literals;
  const py::dict layout("names"_a = names, "formats"_a = formats, "offsets"_a = offsets, "itemsize"_a = size);
  return py::module_::import("numpy").attr("dtype")(layout, "align"_a = true);
}

/// Where a member lies: offsetof is for simpler types than Eigen's.
template <typename T, typename Member>
std::size_t place(Member T::*member) {
  const T example{};
  return static_cast<std::size_t>(reinterpret_cast<const char*>(&(example.*member)) -
                                  reinterpret_cast<const char*>(&example));
}

/// Layout of an event in memory, whatever the byte of its polarity holds.
struct RawEvent {
  std::int64_t t;
  std::uint16_t x, y;
  std::uint8_t p;
};
static_assert(sizeof(RawEvent) == sizeof(Event) && offsetof(RawEvent, p) == offsetof(Event, positive));

/// Layout of a pose in memory.
struct PoseRow {
  std::int64_t t;
  double position[3], quaternion[4];
};
static_assert(sizeof(PoseRow) == 64);

void check_rows(const py::array& array, const char* what) {
  if (array.ndim() != 1) throw py::value_error(fmt::format("{}: has {} dimensions, must have one", what, array.ndim()));
  if (array.shape(0) > 1 && array.strides(0) != array.itemsize())
    throw py::value_error(fmt::format("{}: is not contiguous; numpy.ascontiguousarray makes a copy that is", what));
}

void check_dtype(const py::array& array, const py::dtype& wanted, const char* what, const char* remedy) {
  if (!array.dtype().equal(wanted))
    throw py::type_error(fmt::format("{}: dtype is {}; {}", what, std::string(py::str(array.dtype())), remedy));
}

py::array read_only(py::array array) {
  array.attr("flags").attr("writeable") = false;
  return array;
}

/// Never destroyed: no destructor may run after the interpreter's end.
const py::dtype& kept(py::dtype dtype) { return *new py::dtype(std::move(dtype)); }

}  // namespace

template <>
const py::dtype& dtype_of<Event>() {
  static const py::dtype& dtype =
      kept(make_dtype({{"t", "<i8", 0}, {"x", "<u2", 8}, {"y", "<u2", 10}, {"p", "?", 12}}, sizeof(Event)));
  return dtype;
}

template <>
const py::dtype& dtype_of<ImuSample>() {
  static const py::dtype& dtype = kept(make_dtype({{"t", "<i8", place(&ImuSample::t)},
                                                   {"gyro", "(3,)<f8", place(&ImuSample::gyro_B)},
                                                   {"accel", "(3,)<f8", place(&ImuSample::accel_B)},
                                                   {"interpolated", "?", place(&ImuSample::interpolated)}},
                                                  sizeof(ImuSample)));
  return dtype;
}

template <>
const py::dtype& dtype_of<Track>() {
  static const py::dtype& dtype = kept(make_dtype({{"id", "<u8", place(&Track::id)},
                                                   {"pixel", "(2,)<f8", place(&Track::pixel)},
                                                   {"point", "(2,)<f8", place(&Track::point)},
                                                   {"previous_pixel", "(2,)<f8", place(&Track::previous_pixel)},
                                                   {"age", "<i4", place(&Track::age)},
                                                   {"first_seen", "<i8", place(&Track::first_seen)}},
                                                  sizeof(Track)));
  return dtype;
}

template <>
const py::dtype& dtype_of<Landmark>() {
  static const py::dtype& dtype = kept(
      make_dtype({{"id", "<u8", place(&Landmark::id)}, {"p_W", "(3,)<f8", place(&Landmark::p_W)}}, sizeof(Landmark)));
  return dtype;
}

const py::dtype& pose_dtype() {
  static const py::dtype& dtype = kept(make_dtype({{"t", "<i8", 0},
                                                   {"position", "(3,)<f8", offsetof(PoseRow, position)},
                                                   {"quaternion", "(4,)<f8", offsetof(PoseRow, quaternion)}},
                                                  sizeof(PoseRow)));
  return dtype;
}

py::array view(const py::dtype& dtype, const void* data, std::size_t size, const py::handle& owner) {
  return read_only(py::array(dtype, std::vector<py::ssize_t>{static_cast<py::ssize_t>(size)}, data, owner));
}

py::array view(const cv::Mat& image, const py::handle& owner) {
  const std::vector<py::ssize_t> shape{image.rows, image.cols};
  const std::vector<py::ssize_t> strides{static_cast<py::ssize_t>(image.empty() ? 1 : image.step[0]), 1};
  return read_only(py::array(py::dtype::of<std::uint8_t>(), shape, strides, image.data, owner));
}

void check_events(const py::array& events) {
  static const py::dtype& with_numbers =
      kept(make_dtype({{"t", "<i8", 0}, {"x", "<u2", 8}, {"y", "<u2", 10}, {"p", "u1", 12}}, sizeof(Event)));
  if (!events.dtype().equal(with_numbers))
    check_dtype(events, dtype_of<Event>(), "events", "must be edged.EVENT: edged.make_events or .astype(edged.EVENT)");
  check_rows(events, "events");
}

void check_imu(const py::array& samples) {
  check_dtype(samples, dtype_of<ImuSample>(), "imu", "must be edged.IMU: edged.make_imu(t, gyro, accel)");
  check_rows(samples, "imu");
}

void check_image(const py::array& image) {
  check_dtype(image, py::dtype::of<std::uint8_t>(), "image", "must be uint8");
  if (image.ndim() != 2)
    throw py::value_error(fmt::format("image: has {} dimensions; must be grey, height x width", image.ndim()));
  if ((image.flags() & py::array::c_style) == 0)
    throw py::value_error("image: is not contiguous; numpy.ascontiguousarray makes a copy that is");
}

std::vector<Event> copy_events(const void* data, std::size_t size) {
  std::vector<Event> events;
  events.reserve(size);
  for (std::size_t i = 0; i < size; ++i) {
    RawEvent raw;
    std::memcpy(&raw, static_cast<const char*>(data) + i * sizeof raw, sizeof raw);
    events.push_back({timestamp_from_ns(raw.t), raw.x, raw.y, raw.p != 0});
  }
  return events;
}

ImuSample imu_sample(const void* data, std::size_t i) {
  const char* row = static_cast<const char*>(data) + i * sizeof(ImuSample);
  ImuSample sample;
  std::memcpy(&sample.t, row + place(&ImuSample::t), sizeof sample.t);
  std::memcpy(sample.gyro_B.data(), row + place(&ImuSample::gyro_B), sizeof sample.gyro_B);
  std::memcpy(sample.accel_B.data(), row + place(&ImuSample::accel_B), sizeof sample.accel_B);
  sample.interpolated = row[place(&ImuSample::interpolated)] != 0;
  return sample;
}

py::array poses_array(const Trajectory& trajectory) {
  py::array result(pose_dtype(), std::vector<py::ssize_t>{static_cast<py::ssize_t>(trajectory.size())});
  auto* row = static_cast<PoseRow*>(result.mutable_data());
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d& p = pose.T.translation();
    const Eigen::Quaterniond& q = pose.T.rotation();
    *row++ = {to_ns(pose.t), {p.x(), p.y(), p.z()}, {q.x(), q.y(), q.z(), q.w()}};
  }
  return result;
}

Trajectory trajectory_of(const py::array& poses) {
  check_dtype(poses, pose_dtype(), "poses", "must be edged.POSE: edged.make_poses(t, position, quaternion)");
  check_rows(poses, "poses");
  Trajectory trajectory;
  for (py::ssize_t i = 0; i < poses.shape(0); ++i) {
    PoseRow row;
    std::memcpy(&row, static_cast<const char*>(poses.data()) + i * static_cast<py::ssize_t>(sizeof row), sizeof row);
    const auto& [x, y, z, w] = row.quaternion;
    const Eigen::Quaterniond q(w, x, y, z);
    if (!(std::abs(q.norm() - 1.0) < 1e-3))
      throw py::value_error(fmt::format("poses: quaternion {} is not a rotation (x, y, z, w of norm 1)", i));
    trajectory.push_back({timestamp_from_ns(row.t), SE3(q, Eigen::Vector3d(row.position))});
  }
  return trajectory;
}

}  // namespace edged::python
