// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// From a pair to disparities: one call per stage.
#include <cairn/image/noise.hpp>
#include <cairn/pipeline/methods.hpp>
#include <type_traits>
#include <utility>
#include <vector>

namespace cairn {
namespace {

StereoMatch match_pair(FrameInput& in, const Run& run, StageClock& stage) {
  const Config& config = run.config;
  const Exec& exec = run.exec;
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
  std::vector<Image<Reject>> verdicts;
  for_each_check(config, [&](const char* name, Reject, auto* check, const auto& section, bool) {
    if constexpr (std::is_invocable_v<decltype(check), const Matches&, decltype(section), const Exec&>) {
      verdicts.push_back(stage(name, check(found.matches, section, exec)));
    } else {
      verdicts.push_back(stage(name, check(in.left.gray, section, exec)));
    }
  });
  found.stereo.disparity =
      stage("combine", combine(std::move(refined), {verdicts.begin(), verdicts.end()}, exec));
  return found;
}

}  // namespace

StereoMatch match_and_check(FrameInput& in, const Run& run, StageClock& stage) {
  StereoMatch found = in.right.empty() ? StereoMatch{{std::move(in.disparity)}} : match_pair(in, run, stage);
  in.left.noise_sigma = stage("noise_sigma", noise_sigma(in.left.gray, run.exec));
  return found;
}

}  // namespace cairn
