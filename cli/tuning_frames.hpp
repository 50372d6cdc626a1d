// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/tuning/measure_frames.hpp>
#include <string>
#include <vector>

#include "common.hpp"

namespace cairn::cli {

/// The images and truth of a frame in memory.
struct TuningFiles {
  std::string name;
  LoadedFrame loaded;
  bool follows = false;  // nearly equal to the frame before in the folder
  Image<TruthId> objects{};
  bool partial = false;
  Image<float> truth_px{};
  Image<std::uint8_t> hidden{};

  /// Borrows from this object.
  [[nodiscard]] TuningFrame frame() const;
};

/// All frames of the folders, with truth if `with_truth`. Throws Error for an unusable frame, one without
/// required truth, and a configuration that does not suit a frame.
std::vector<TuningFiles> load_tuning_files(const std::vector<std::string>& folders, InputOptions input,
                                           bool with_truth);

}  // namespace cairn::cli
