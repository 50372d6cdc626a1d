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

/// The place in a sequence from which on the right camera is late by another number of frames.
struct LagChange {
  int from = 0;  // first frame after it; may be one too few or too many
  int before = 0;
  int after = 0;
  double motion = 0;  // the correlation below, over both parts with a lag each
};

/// Whether the two cameras of a sequence took their pictures at the same moments.
struct Synchrony {
  static constexpr int kLeastFrames = 8;  // fewer tell nothing
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
  /// Where two lags, one after the other, explain the changes clearly better than any one does.
  std::optional<LagChange> change;

  /// How many frames the right camera is late, as the numbers say; 0 without evidence. It is one lag for the
  /// whole sequence: see `change` for one that sets in later.
  [[nodiscard]] int lag() const;
  /// Whether the numbers tell one lag from another: false where too little moves, or too evenly.
  [[nodiscard]] bool tells() const;
};

/// Of consecutive pairs of one size. Fewer than 8 frames: nothing is measured but repeats.
Synchrony measure_synchrony(std::span<const StereoPair> sequence, const Exec& exec);

/// nullopt where the cameras run together, and for fewer than 8 frames, which are no sequence; a note where
/// the sequence does not tell. `names` of the frames are for the sentence; without them they are counted from
/// 0. The finding's frames are those out of step.
std::optional<Finding> diagnose(const Synchrony& synchrony, std::span<const std::string> names = {});

}  // namespace cairn
