// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/fields.hpp>
#include <cstdint>

namespace cairn {

/// Why a pixel has no disparity: a bit set, since the per-pixel checks are independent and each leaves its
/// own bit.
enum class Reject : std::uint8_t {
  none = 0,
  border = 1,         // no candidate lay inside the right image
  left_right = 2,     // followed back from the right image, the match does not return
  not_unique = 4,     // another disparity fits nearly as well
  flat = 8,           // every disparity fits equally badly or well
  no_texture = 16,    // too little texture to match at all
  below_ground = 32,  // under the floor: a reflection
  speckle = 64,       // a small island of disparity
  no_data = 128,      // the external disparity map had no value here
};

inline constexpr std::array kRejects{
    Choice<Reject>{"border", Reject::border},         Choice<Reject>{"left_right", Reject::left_right},
    Choice<Reject>{"not_unique", Reject::not_unique}, Choice<Reject>{"flat", Reject::flat},
    Choice<Reject>{"no_texture", Reject::no_texture}, Choice<Reject>{"below_ground", Reject::below_ground},
    Choice<Reject>{"speckle", Reject::speckle},       Choice<Reject>{"no_data", Reject::no_data}};

constexpr Reject operator|(Reject a, Reject b) {
  return static_cast<Reject>(static_cast<std::uint8_t>(a) | static_cast<std::uint8_t>(b));
}
constexpr Reject operator&(Reject a, Reject b) {
  return static_cast<Reject>(static_cast<std::uint8_t>(a) & static_cast<std::uint8_t>(b));
}
constexpr Reject& operator|=(Reject& a, Reject b) {
  return a = a | b;
}
constexpr bool has(Reject set, Reject bit) {
  return (set & bit) != Reject::none;
}

}  // namespace cairn
