// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <bit>
#include <cairn/core/exec.hpp>
#include <cairn/stereo/reject.hpp>
#include <cstdint>

/// The kernels of reject_inconsistent(), per pixel of a row; one set per instruction set. Private to the
/// library.
namespace cairn::kernels {

/// The claim of a left pixel to its matched right pixel, as one number: the smaller claim wins, by cost, then
/// by disparity (smaller for smaller x). Costs are not negative, so their bits order like their values; the
/// sign of a zero is masked.
using Claim = std::uint64_t;
inline constexpr Claim kNoClaim = ~Claim{0};
constexpr Claim claim_of(float cost, std::int32_t x) {
  constexpr std::uint32_t kNoSign = 0x7FFFFFFF;
  return Claim{std::bit_cast<std::uint32_t>(cost) & kNoSign} << 32 | static_cast<std::uint32_t>(x);
}
constexpr std::int32_t claimant(Claim claim) {
  return static_cast<std::int32_t>(claim & 0xFFFFFFFF);
}

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct LeftRightKernels {
  /// reject_inconsistent() for matches in the same row, by vote and by the right winners. Working memory:
  /// width numbers for `partners` and for `back`, one more for `claims`.
  void (*compare_with_votes)(const std::int16_t* best, const float* cost, int width, int max_diff,
                             std::int32_t* partners, Claim* claims, Reject* verdict);
  void (*compare_with_right)(const std::int16_t* best, const std::int16_t* best_right, int width,
                             int max_diff, std::int32_t* partners, std::int32_t* back, Reject* verdict);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const LeftRightKernels* left_right_kernels(Target target);
/// The functions for the active target of `exec`.
const LeftRightKernels& left_right_kernels(const Exec& exec);

}  // namespace cairn::kernels
