// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <array>
#include <cairn/grouping/fitted_trees.hpp>

namespace cairn {
namespace {

#include <cairn/grouping/fitted_same_thing.inc>
#include <cairn/grouping/fitted_whole_object.inc>

}  // namespace

constinit const FittedTrees kSameThing{kSameThingBase, kSameThingRoots, kSameThingNodes};
constinit const FittedTrees kWholeObject{kWholeObjectBase, kWholeObjectRoots, kWholeObjectNodes};

}  // namespace cairn
