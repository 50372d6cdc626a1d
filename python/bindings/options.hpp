// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/io/calibration_files.hpp>
#include <cairn/pipeline/config.hpp>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "members.hpp"

namespace cairn::python {

/// A calibration and its file, for messages.
struct PyCalibration {
  io::Calibration calibration;
  std::filesystem::path path;

  /// Throws Error if it is for images of another size.
  void check(Size size) const {
    (void)io::suited(calibration, size, path);
    io::check_search_range(calibration, path);
  }
  [[nodiscard]] const std::optional<StereoRig>& rig() const { return calibration.rig; }
};

/// A configuration and its origin.
struct PyConfig {
  std::string preset = "default";
  Config config;
  bool range_given = false;  // match.num_disparities was set explicitly

  /// The configuration for frames with this calibration: uses its number of disparities as the default, and
  /// its ground.
  [[nodiscard]] PyConfig suited(const io::Calibration& calibration) const;
};

/// Options as text, by full name.
using Settings = std::vector<std::pair<std::string, std::string>>;
/// Applies the options of a file that belong to another configuration, see io::load_config().
using Elsewhere = std::function<bool(std::string_view name, std::string_view value)>;
/// Preset, then file, then settings; later ones win, as in the command. Throws Error.
PyConfig make_config(const std::string& preset, const std::optional<std::string>& file,
                     const Settings& settings, const Elsewhere& elsewhere = {});

CAIRN_MEMBERS(KnownGround, points, camera_height_m, camera_pitch_deg, camera_roll_deg)
CAIRN_MEMBERS(StereoRig, focal_px, cx_px, cy_px, baseline_m, doffs_px)
CAIRN_MEMBERS(io::Calibration, rig, image_size, num_disparities, _ground, of_raw_cameras, remarks,
              _one_camera)
CAIRN_MEMBERS(PyCalibration, _calibration, _path)
CAIRN_MEMBERS(PyConfig, preset, _config, _range_given)

}  // namespace cairn::python
