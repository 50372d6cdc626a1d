// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <vector>

namespace cairn {

/// What it costs to give each row one column of its own.
struct CostTable {
  static constexpr std::int64_t kForbidden = -1;
  int rows = 0;
  int columns = 0;
  std::vector<std::int64_t> costs;  // row by row: 0 … 2³¹, or kForbidden
  std::int64_t alone = 0;           // ≥ 0: of a row and a column that are left alone, half for each; even
};

/// For each row its column, or −1: the assignment of the least total cost. Of several, the one whose first
/// row has the lowest column (−1 counts as the highest), then the second, and so on. Private to the library.
/// (Kuhn 1955; the slow twin, all of them, is in tests/unit/association_test.cpp.)
std::vector<int> assign(const CostTable& table);

}  // namespace cairn
