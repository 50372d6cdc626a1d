// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/cairn.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/image_files.hpp>
#include <filesystem>
#include <string>

namespace cairn::samples {

inline constexpr std::array kNames{"dim_light", "four_in_a_row", "glossy_floor", "overlap"};

inline std::filesystem::path folder(const std::string& name) {
  return std::filesystem::path(CAIRN_SOURCE_DIR) / "data" / "samples" / name;
}

/// A pair of data/samples/ with its calibration.
struct Sample {
  io::LoadedPair images;
  io::Calibration calibration;

  [[nodiscard]] StereoPair pair() const& {
    return StereoPair::from(images.left.gray, images.right.gray, images.left.rgb);
  }
  StereoPair pair() && = delete;  // borrows the images
  /// `config` with the search range of the calibration, as the command uses it.
  [[nodiscard]] Config suited(Config config = {}) const {
    config.match.num_disparities = calibration.num_disparities.value_or(config.match.num_disparities);
    return config;
  }
};

inline Sample load(const std::string& name) {
  return {io::load_pair(folder(name) / "left.png", folder(name) / "right.png"),
          io::load_calibration(folder(name) / "calib.txt")};
}

}  // namespace cairn::samples
