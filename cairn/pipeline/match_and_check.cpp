// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// From a pair to disparities: one call per stage.
#include <cairn/image/noise.hpp>
#include <cairn/pipeline/methods.hpp>
#include <utility>

namespace cairn {
namespace {

StereoMatch match_pair(FrameInput& in, const Run& run, StageClock& stage) {
  const auto& [rig, config, exec] = run;
  StereoMatch found;
  auto pair = StereoPair::from(in.left.gray, in.right, in.left.rgb);
  if (config.epipolar_correction.max_rows >= 0) {
    EpipolarCorrection aligned = correct_epipolar(pair, config.match, config.epipolar_correction, exec);
    found.stereo.epipolar = aligned.offset;
    found.right = stage("correct_epipolar", std::move(aligned.right));
    if (!found.right.empty()) in.right = found.right;
    pair = StereoPair::from(in.left.gray, in.right, in.left.rgb);
  }
  found.matches = stage("match", match(pair, config.match, config.semi_global, exec));
  auto refined = stage("refine_subpixel", refine_subpixel(found.matches, config.subpixel, exec));

  // Independent checks of each match; each sets its own bit.
  const auto inconsistent =
      stage("reject_inconsistent", reject_inconsistent(found.matches, config.left_right, exec));
  const auto ambiguous = stage("reject_ambiguous", reject_ambiguous(found.matches, config.uniqueness, exec));
  const auto flat = stage("reject_flat", reject_flat(found.matches, config.flatness, exec));
  const auto textureless =
      stage("reject_textureless", reject_textureless(in.left.gray, config.texture, exec));
  found.stereo.disparity =
      stage("combine", combine(std::move(refined), {inconsistent, ambiguous, flat, textureless}, exec));
  return found;
}

}  // namespace

StereoMatch match_and_check(FrameInput& in, const Run& run, StageClock& stage) {
  StereoMatch found = in.right.empty() ? StereoMatch{{std::move(in.disparity)}} : match_pair(in, run, stage);
  in.left.noise_sigma = stage("noise_sigma", noise_sigma(in.left.gray, run.exec));
  return found;
}

}  // namespace cairn
