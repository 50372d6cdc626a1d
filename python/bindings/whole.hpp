// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <pybind11/pybind11.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace cairn::python {

/// Whether a number of whatever type stands for a whole one: 64, 64.0, numpy's.
inline bool is_whole(double number) {
  return std::isfinite(number) && number == std::floor(number);
}

/// A whole number as an argument. pybind11's own int refuses 64.0.
struct Whole {
  int value = 0;
};

}  // namespace cairn::python

namespace pybind11::detail {

template <>
struct type_caster<cairn::python::Whole> {
  PYBIND11_TYPE_CASTER(cairn::python::Whole, const_name("int"));

  bool load(handle source, bool) {
    if (PyNumber_Check(source.ptr()) == 0) return false;
    const double number = PyFloat_AsDouble(source.ptr());
    if (PyErr_Occurred() != nullptr) {  // a complex one, an array
      PyErr_Clear();
      return false;
    }
    if (!cairn::python::is_whole(number) || std::abs(number) > std::numeric_limits<int>::max()) return false;
    value.value = static_cast<int>(number);
    return true;
  }
  static handle cast(cairn::python::Whole source, return_value_policy, handle) {
    return PyLong_FromLong(source.value);
  }
};

}  // namespace pybind11::detail
