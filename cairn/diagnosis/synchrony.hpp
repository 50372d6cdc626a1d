// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/diagnosis/findings.hpp>
#include <optional>
#include <span>
#include <string>

namespace cairn {

/// The frame of a sequence from which the lag of the right camera differs.
struct LagChange {
  int from = 0;  // first frame after the change, ± 1
  int before = 0;
  int after = 0;
  double motion = 0;  // Synchrony::motion over both parts, each with its lag
};

/// Whether the two cameras of a sequence took their images at the same time.
struct Synchrony {
  static constexpr int kMinFrames = 8;  // fewer are inconclusive
  static constexpr int kMaxLag = 2;
  static constexpr int kLags = 2 * kMaxLag + 1;
  int frames = 0;
  /// If the left images change from frame to frame, the right ones should too. For a right camera −2 … 2
  /// frames late: the correlation of the changes, in 16 bands of rows, over all frames; 0 if nothing changes.
  std::array<double, kLags> motion{};
  /// For the same lags: share of the textured points with matching rows, over some frames; 0 if not tried.
  std::array<double, kLags> agreement{};
  int left_repeats = 0;   // frames in which only the left image repeats the one before
  int right_repeats = 0;  // the same for the right image
  /// Set if two lags, one after the other, explain the changes clearly better than one.
  std::optional<LagChange> change;

  /// The lag of the right camera in frames according to the measurements; 0 without evidence. One lag for the
  /// whole sequence: see `change` for a lag that begins later.
  [[nodiscard]] int lag() const;
  /// Whether the measurements distinguish the lags: false if there is too little motion, or too even motion.
  [[nodiscard]] bool tells() const;
};

/// Measures consecutive pairs of one size. Fewer than 8 frames: only repeats are measured.
Synchrony measure_synchrony(std::span<const StereoPair> sequence, const Exec& exec);

/// nullopt if the cameras are synchronous, and for fewer than 8 frames; a note if the sequence is
/// inconclusive. `names` of the frames are used in the sentence; without them frames are numbered from 0. The
/// frames of the finding are those out of step.
std::optional<Finding> diagnose(const Synchrony& synchrony, std::span<const std::string> names = {});

}  // namespace cairn
