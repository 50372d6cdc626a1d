// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <pybind11/pybind11.h>

#include <cairn/core/error.hpp>
#include <string>

/// Calls that cannot be. pybind11 answers them with every signature and every argument on many lines; here
/// they are told in one, which names the argument.
namespace cairn::python {

/// cairn.ArgumentError, an Error and a TypeError: an argument of a wrong type, one too many, none.
class ArgumentError : public Error {
 public:
  using Error::Error;
};

/// What an error message shows of a value: '3', "'x'", or its type where it is no plain number or text.
std::string shown(const pybind11::handle& value);

/// After all is bound: makes each public function, method and constructor refuse in one line.
void refuse_plainly(const pybind11::module_& module);

}  // namespace cairn::python
