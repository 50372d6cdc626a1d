// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace cairn {

/// The values of the ranks `low` ≤ `high` < values.size() in ascending order, 0 being the least. No value is
/// NaN. Leaves `values` in any order. Private to the library.
std::pair<float, float> values_at_ranks(std::vector<float>& values, std::size_t low, std::size_t high);

}  // namespace cairn
