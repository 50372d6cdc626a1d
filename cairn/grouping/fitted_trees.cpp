// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/grouping/fitted_trees.hpp>

namespace cairn {
const FittedTrees kSameThing{};
const FittedTrees kWholeObject{};
}  // namespace cairn
