// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <io/calibration_files.hpp>
#include <optional>

namespace cairn::python {

namespace py = pybind11;

/// A calibration and its file, for messages.
struct PyCalibration {
  io::Calibration calibration;
  std::filesystem::path path;

  /// Throws Error if it is for images of another size.
  void check(Size size) const {
    io::check_size(calibration, size, path);
    io::check_search_range(calibration, path);
  }
};

/// Accepts a Rig, a Calibration or None. Throws Error for anything else.
struct KnownRig : PyCalibration {
  static constexpr const char* kType = "RigLike";
  KnownRig(const py::object& value, const char* name);
  [[nodiscard]] const std::optional<StereoRig>& rig() const { return calibration.rig; }
};

}  // namespace cairn::python
