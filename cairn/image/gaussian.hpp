// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>

namespace cairn {

/// The largest radius of a kernel.
inline constexpr int kMaxRadius = 15;
/// The sum of the weights of a kernel.
inline constexpr int kWeightSum = 256;

/// Half of a symmetric kernel: weights[i] applies to +i and −i.
struct Kernel {
  int radius = 0;
  std::array<int, kMaxRadius + 1> weights{kWeightSum};
};

/// Weights round(256·g(i)) for |i| ≤ ⌈3σ⌉ (at most kMaxRadius), g normalised to 1; the centre absorbs the
/// rounding, so the sum is 256. σ = 0: the centre only.
Kernel gaussian(float sigma);

}  // namespace cairn
