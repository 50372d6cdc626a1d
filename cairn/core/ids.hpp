// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <cstdint>

namespace cairn {

/// A region of one segmentation: 0 … regions.size()-1, so it indexes Segmentation::regions.
enum class RegionId : std::int32_t {};

/// An object of one frame: 1 = the nearest, counting up with distance; none = no object here.
enum class ObjectId : std::int32_t { none = 0 };

/// A number that is never negative, as containers count.
constexpr std::size_t slot(std::int32_t i) {
  return static_cast<std::size_t>(i);
}
constexpr std::size_t index(RegionId id) {
  return static_cast<std::size_t>(id);
}
constexpr std::int32_t number(RegionId id) {
  return static_cast<std::int32_t>(id);
}
constexpr std::int32_t number(ObjectId id) {
  return static_cast<std::int32_t>(id);
}

}  // namespace cairn
