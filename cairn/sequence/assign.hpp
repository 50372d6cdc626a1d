// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <vector>

namespace cairn {

/// The costs of assigning a column to each row.
struct CostTable {
  static constexpr std::int64_t kForbidden = -1;
  int rows = 0;
  int columns = 0;
  std::vector<std::int64_t> costs;  // row-major: 0 … 2³¹, or kForbidden
  std::int64_t alone = 0;  // ≥ 0, even: of an unassigned row and an unassigned column, half for each
};

/// For each row its column, or −1: the assignment of lowest total cost. Of several, the one whose first row
/// has the lowest column (−1 counts as the highest), then the second, and so on. Private to the library.
/// (Kuhn 1955; the exhaustive slow twin is in tests/unit/sequence/association_test.cpp.)
std::vector<int> assign(const CostTable& table);

}  // namespace cairn
