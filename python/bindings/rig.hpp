// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/stereo_pair.hpp>
#include <filesystem>
#include <io/calibration_files.hpp>
#include <optional>
#include <tuple>

#include "arrays.hpp"

namespace cairn::python {

/// A calibration and its file, for messages.
struct PyCalibration {
  io::Calibration calibration;
  std::filesystem::path path;
};

/// What a Rig, a Calibration or None says. Throws Error for anything else.
PyCalibration calibration_of(const RigArgument& rig);
/// Only the rig of it.
std::optional<StereoRig> rig_of(const RigArgument& rig);

using Triple = std::tuple<float, float, float>;
inline Triple triple(Vec3 v) {
  return {v.x, v.y, v.z};
}
inline std::optional<Triple> triple(const std::optional<Vec3>& v) {
  if (!v) return std::nullopt;
  return triple(*v);
}

/// x, y, width, height
using Box = std::tuple<int, int, int, int>;
inline Box box(Rect r) {
  return {r.x, r.y, r.width, r.height};
}

}  // namespace cairn::python
