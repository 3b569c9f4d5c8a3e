// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// numpy arrays that share the library's memory, and checked access to arrays of the user.
#pragma once

#include <pybind11/numpy.h>

#include <opencv2/core/mat.hpp>
#include <vector>

#include "casts.hpp"
#include "edged/frontend/tracker.hpp"
#include "edged/measurement.hpp"
#include "edged/state.hpp"

namespace edged::python {

namespace py = pybind11;

/// The layout of one element; the same object each time.
template <typename T>
const py::dtype& dtype_of();
template <>
const py::dtype& dtype_of<Event>();
template <>
const py::dtype& dtype_of<ImuSample>();
template <>
const py::dtype& dtype_of<Track>();
template <>
const py::dtype& dtype_of<Landmark>();
/// One row (t, position, quaternion) a pose; a copy, as the memory layout of the quaternion is internal to Eigen.
const py::dtype& pose_dtype();

/// Read-only, without a copy; keeps `owner` alive.
py::array view(const py::dtype& dtype, const void* data, std::size_t size, const py::handle& owner);
py::array view(const cv::Mat& image, const py::handle& owner);
template <typename T>
py::array view(const std::vector<T>& items, const py::handle& owner) {
  return view(dtype_of<T>(), items.data(), items.size(), owner);
}

/// Throw TypeError for another dtype, ValueError for another shape or gaps in memory; `what` begins the message.
/// Views, not copies.
void check_events(const py::array& events);
void check_imu(const py::array& samples);
void check_image(const py::array& image);

/// Elements of arrays that have been checked; without the GIL.
std::vector<Event> copy_events(const void* data, std::size_t size);
ImuSample imu_sample(const void* data, std::size_t i);

py::array poses_array(const Trajectory& trajectory);
/// Throws as check_events does.
Trajectory trajectory_of(const py::array& poses);

}  // namespace edged::python
