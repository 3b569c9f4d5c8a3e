// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Stamps and durations of the library as whole nanoseconds in Python.
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "edged/time.hpp"

namespace pybind11::detail {

template <typename Time>
struct nanoseconds_caster {  // NOLINT: the names that pybind11 expects
  PYBIND11_TYPE_CASTER(Time, const_name("int"));

  bool load(handle source, bool convert) {
    type_caster<std::int64_t> number;
    if (!number.load(source, convert)) return false;
    value = Time(edged::Duration(static_cast<std::int64_t>(number)));
    return true;
  }
  static handle cast(Time time, return_value_policy, handle) { return PyLong_FromLongLong(count(time)); }

 private:
  static std::int64_t count(edged::Timestamp t) { return edged::to_ns(t); }
  static std::int64_t count(edged::Duration d) { return d.count(); }
};

template <>
struct type_caster<edged::Timestamp> : nanoseconds_caster<edged::Timestamp> {};
template <>
struct type_caster<edged::Duration> : nanoseconds_caster<edged::Duration> {};

}  // namespace pybind11::detail
