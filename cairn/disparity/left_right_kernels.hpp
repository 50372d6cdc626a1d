// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <bit>
#include <cairn/core/exec.hpp>
#include <cairn/disparity/reject.hpp>
#include <cstdint>

/// The seam to the instruction sets: what reject_inconsistent() does for each pixel of a row. Private to the
/// library.
namespace cairn::kernels {

/// A left pixel's claim to the right pixel that it is matched with, as one number: of two the smaller wins,
/// by its cost, then by its disparity, which is the smaller one where x is. Costs are not negative, so that
/// their bits are in their order; the sign that a zero may have is left out.
using Claim = std::uint64_t;
inline constexpr Claim kNoClaim = ~Claim{0};
constexpr Claim claim_of(float cost, std::int32_t x) {
  constexpr std::uint32_t kNoSign = 0x7FFFFFFF;
  return Claim{std::bit_cast<std::uint32_t>(cost) & kNoSign} << 32 | static_cast<std::uint32_t>(x);
}
constexpr std::int32_t claimant(Claim claim) {
  return static_cast<std::int32_t>(claim & 0xFFFFFFFF);
}

/// Plain loops that compilers make vector code of; compiled once for each instruction set. None of them
/// rounds in another order than it is written in, so that each gives the same bits.
struct LeftRightKernels {
  /// reject_inconsistent() where matches lie in the pixels' own row, by vote and by the right winners.
  /// Working memory: `partners` and `back` width numbers, `claims` one more.
  void (*compare_with_votes)(const std::int16_t* best, const float* cost, int width, int max_diff,
                             std::int32_t* partners, Claim* claims, Reject* verdict);
  void (*compare_with_right)(const std::int16_t* best, const std::int16_t* best_right, int width,
                             int max_diff, std::int32_t* partners, std::int32_t* back, Reject* verdict);
};

/// The functions of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
const LeftRightKernels* left_right_kernels(Target target);
/// Those for the target that `exec` gets.
const LeftRightKernels& left_right_kernels(const Exec& exec);

}  // namespace cairn::kernels
