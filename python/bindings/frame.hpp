// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/io/image_files.hpp>
#include <cairn/output/results.hpp>

#include "values.hpp"

namespace cairn::python {

CAIRN_MEMBERS(output::StageTime, _stage, _milliseconds)
CAIRN_MEMBERS(output::Provenance, _preset, _config, rig, _timings, _external_disparity, _stamp_ns)

}  // namespace cairn::python

namespace pybind11::detail {

/// A file's image: colour if it has it, else grey.
template <>
struct type_caster<cairn::io::LoadedImage> {
  static constexpr auto name = const_name("array");
  static handle cast(cairn::io::LoadedImage from, return_value_policy, handle) {
    return (from.rgb.empty() ? cairn::python::array_from(std::move(from.gray))
                             : cairn::python::array_from(std::move(from.rgb)))
        .release();
  }
};

}  // namespace pybind11::detail
