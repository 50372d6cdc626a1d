// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <vector>

namespace cairn {

/// What it costs to part two nodes.
struct Tie {
  std::int32_t a = 0;
  std::int32_t b = 0;
  std::int64_t cost = 0;
};

/// Labels every node 0 or 1 so that the sum of cost_0 of the nodes labelled 0, cost_1 of those labelled 1,
/// and the costs of ties between differently labelled nodes is least; of several such labellings the one with
/// the fewest 1s. Exact: a minimum s-t cut (Greig, Porteous & Seheult 1989), found with Dinic's augmenting
/// paths. No cost is negative.
std::vector<std::int32_t> minimum_cut(const std::vector<std::int64_t>& cost_0,
                                      const std::vector<std::int64_t>& cost_1, const std::vector<Tie>& ties);

}  // namespace cairn
