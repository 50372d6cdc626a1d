// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/tuning/frame_loss.hpp>
#include <cmath>
#include <random>

namespace cairn {

Loss loss_of(const FrameObjects& frame) {
  Loss loss;
  loss.weight = static_cast<double>(frame.errors.truth.size());
  for (const TrueObjectScore& score : frame.errors.truth) loss.sum += score.capped_error();
  const ObjectSummary summary = summarise({frame});
  loss.faults = summary.our_objects - summary.right_50;  // both exclude frames with partial truth
  return loss;
}

Loss loss_of(const DisparityErrors& errors) {
  constexpr std::size_t kOnePixel = 1;
  static_assert(kBadThresholdsPx[kOnePixel] == 1.0F);
  const auto holes = static_cast<double>(errors.known - errors.matched);
  return {kHoleCost * holes + static_cast<double>(errors.bad[kOnePixel]), static_cast<double>(errors.known)};
}

Loss loss_of(const Consistency& frame, const std::optional<Steadiness>& since_last) {
  Loss loss{frame.loss(), 1};
  if (since_last && since_last->seen > 0) loss.sum += kUnsteadyWeight * since_last->unsteady_share();
  return loss;
}

std::vector<bool> held_out(int count, double share, bool sequence, std::uint32_t seed) {
  std::vector<bool> out(static_cast<std::size_t>(std::max(count, 0)), false);
  if (count < 2) return out;
  const int wanted = std::clamp(static_cast<int>(std::lround(share * count)), 1, count - 1);
  std::fill(out.end() - wanted, out.end(), true);
  if (sequence) return out;
  std::mt19937 random(seed);
  // std::shuffle's result differs between standard libraries.
  for (std::size_t i = out.size(); i > 1; --i) {
    const bool last = out[i - 1];
    const std::size_t other = random() % i;
    out[i - 1] = out[other];
    out[other] = last;
  }
  return out;
}

}  // namespace cairn
