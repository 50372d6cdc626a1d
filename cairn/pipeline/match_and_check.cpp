// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// From a pair to disparities, one call a stage. A check of single pixels stands here, for both methods.
#include <cairn/pipeline/match_and_check.hpp>
#include <utility>

namespace cairn {

Matched match_and_check(Given& given, const Config& config, const Exec& exec, Observed& stage) {
  if (given.right.empty()) return {{}, {}, std::move(given.disparity)};
  auto pair = StereoPair::from(given.left, given.right, given.left_rgb);

  EpipolarCorrection aligned;
  if (config.epipolar_correction.max_rows >= 0) {
    aligned = correct_epipolar(pair, config.match, config.epipolar_correction, exec);
    aligned.right = stage("correct_epipolar", std::move(aligned.right));
    if (!aligned.right.empty()) pair = StereoPair::from(given.left, aligned.right, given.left_rgb);
  }
  Matches matches = stage("match", match(pair, config.match, config.semi_global, exec));
  auto refined = stage("refine_subpixel", refine_subpixel(matches, config.subpixel, exec));

  // What speaks against each match. The checks know nothing of each other; each leaves its own bit.
  const auto inconsistent =
      stage("reject_inconsistent", reject_inconsistent(matches, config.left_right, exec));
  const auto ambiguous = stage("reject_ambiguous", reject_ambiguous(matches, config.uniqueness, exec));
  const auto flat = stage("reject_flat", reject_flat(matches, config.flatness, exec));
  const auto textureless = stage("reject_textureless", reject_textureless(given.left, config.texture, exec));
  DisparityMap disparity =
      stage("combine", combine(std::move(refined), {inconsistent, ambiguous, flat, textureless}, exec));
  return {aligned.offset, std::move(matches), std::move(disparity)};
}

}  // namespace cairn
