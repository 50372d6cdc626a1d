// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "lab/worlds/dice.hpp"
#include "lab/worlds/mesh.hpp"

namespace cairn::worlds {

/// The fit must not see the families of the yardstick.
enum class Use : std::uint8_t { fit, yardstick };

/// A kind of thing with continuous random parameters.
struct Family {
  std::string_view name;
  Use use = Use::fit;
  double least_m = 0;  // of the longest side of the bounding box of what is drawn
  double most_m = 0;
  Mesh (*make)(Dice& dice) = nullptr;
};
std::span<const Family> families();

}  // namespace cairn::worlds
