// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/diagnosis/findings.hpp>
#include <optional>
#include <span>

namespace cairn {

/// Whether the two cameras of a sequence took their pictures at the same moments.
struct Synchrony {
  static constexpr int kMostLag = 2;
  static constexpr int kLags = 2 * kMostLag + 1;
  int frames = 0;
  /// Where the left pictures change from one to the next, the right ones should change as well. For a right
  /// camera that is −2 … 2 frames late, the correlation of the changes, by 16 bands of rows, over all frames;
  /// 0 where nothing changes in time.
  std::array<double, kLags> motion{};
  /// For the same lags, share of the textured points whose rows agree, over some frames; 0 where not tried.
  std::array<double, kLags> agreement{};
  int left_repeats = 0;   // frames in which only the left picture is the one before once more
  int right_repeats = 0;  // the same of the right one

  /// How many frames the right camera is late, as the numbers say; 0 without evidence.
  [[nodiscard]] int lag() const;
};

/// Of consecutive pairs of one size. Fewer than 8 frames: nothing is measured but repeats.
Synchrony measure_synchrony(std::span<const StereoPair> sequence, const Exec& exec);

/// nullopt where the cameras run together, or where nothing tells.
std::optional<Finding> diagnose(const Synchrony& synchrony);

}  // namespace cairn
