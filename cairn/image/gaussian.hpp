// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>

namespace cairn {

/// The farthest tap of a kernel from its centre.
inline constexpr int kMaxRadius = 15;
/// What the weights of a kernel sum up to.
inline constexpr int kWeightSum = 256;

/// One side of a symmetric kernel: weights[i] stands at +i and −i.
struct Kernel {
  int radius = 0;
  std::array<int, kMaxRadius + 1> weights{kWeightSum};
};

/// Weights round(256·g(i)) for |i| ≤ ⌈3σ⌉ (kMaxRadius at most), g normalised to 1; the centre takes what is
/// missing to 256. σ = 0: the centre alone.
Kernel gaussian(float sigma);

}  // namespace cairn
