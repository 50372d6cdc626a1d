// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/tuning/measure_frames.hpp>
#include <string>
#include <vector>

#include "common.hpp"

namespace cairn::cli {

/// A frame's files in memory.
struct TuningFiles {
  std::string name;
  LoadedFrame loaded;
  bool follows = false;  // the frame before it in the folder shows nearly the same
  Image<TruthId> objects{};
  bool partial = false;
  Image<float> truth_px{};
  Image<std::uint8_t> hidden{};

  /// Borrows from this.
  [[nodiscard]] TuningFrame frame() const;
};

/// Every frame of the folders, with its truth where `with_truth`. Throws Error for a bad frame, one without
/// truth where that is asked for, and for a configuration that does not fit a frame.
std::vector<TuningFiles> load_tuning_files(const std::vector<std::string>& folders, InputOptions input,
                                           bool with_truth);

}  // namespace cairn::cli
