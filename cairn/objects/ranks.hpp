// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstddef>
#include <span>
#include <utility>

namespace cairn {

/// The values at the ranks `low` ≤ `high` < values.size() in ascending order, rank 0 = the minimum. No value
/// is NaN. Permutes `values`. Private to the library.
std::pair<float, float> values_at_ranks(std::span<float> values, std::size_t low, std::size_t high,
                                        const Exec& exec);

}  // namespace cairn
