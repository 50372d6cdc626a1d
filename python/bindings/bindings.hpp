// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <pybind11/pybind11.h>

/// The module _cairn: what the package (python/cairn) calls. It has no help; the package checks arguments,
/// describes, and adds what is shorter in Python.
namespace cairn::python {

// One file each, in the order in which the types need each other.
void bind_options(pybind11::module_& m);  // options, rigs, images as input
void bind_values(pybind11::module_& m);   // results of stages
void bind_stages(pybind11::module_& m);   // every stage
void bind_frame(pybind11::module_& m);    // the whole method; files and images
void bind_scores(pybind11::module_& m);   // evaluation, diagnosis, tuning
void bind_follow(pybind11::module_& m);   // sequences

}  // namespace cairn::python
