// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <cstdint>

namespace cairn {

/// A region of one segmentation: index into Segmentation::regions.
enum class RegionId : std::int32_t {};

/// An object of one frame: 1 = the nearest, numbered by distance; none = no object.
enum class ObjectId : std::int32_t { none = 0 };

/// A non-negative number as an index of a container.
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
