// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <cairn/core/fields.hpp>
#include <cairn/core/image.hpp>
#include <cstdint>
#include <string_view>

namespace cairn {

/// Why a pixel has no disparity: a bit set, because the checks are independent and each sets its own bit.
/// Files and Python use the same numbers: do not change them.
enum class Reject : std::uint16_t {
  none = 0,
  border = 1,
  left_right = 2,
  not_unique = 4,
  flat = 8,
  no_texture = 16,
  below_ground = 32,
  speckle = 64,
  no_data = 128,
  sky = 256,
  unlikely = 512,
};

/// Name, text and colour of a reason.
struct Reason {
  Reject bit = Reject::none;
  std::string_view name;   // in files and options
  std::string_view label;  // in legends
  Rgb colour;
  std::string_view says;
};

/// All reasons, the source of legends, names, the browser page and Python. If several bits are set, the first
/// of these is drawn: limits of the input before decisions of the matcher.
// clang-format off
inline constexpr std::array kReasons{
    Reason{Reject::no_data, "no_data", "no data", {25, 25, 25}, "no value in the external disparity map"},
    Reason{Reject::sky, "sky", "sky", {170, 215, 250}, "sky: free, and infinitely far"},
    Reason{Reject::border, "border", "border", {60, 60, 60}, "no candidate inside the right image"},
    Reason{Reject::below_ground, "below_ground", "below ground", {205, 185, 255}, "below the floor: a reflection"},
    Reason{Reject::speckle, "speckle", "speckle", {255, 240, 200}, "a small island of disparity"},
    Reason{Reject::no_texture, "no_texture", "no texture", {105, 105, 105}, "too little texture to match"},
    Reason{Reject::not_unique, "not_unique", "not unique", {150, 135, 135}, "another disparity fits nearly as well"},
    Reason{Reject::flat, "flat", "flat", {125, 150, 140}, "all disparities fit about equally well"},
    Reason{Reject::left_right, "left_right", "left-right", {205, 205, 205},
           "the match in the right image does not lead back"},
    Reason{Reject::unlikely, "unlikely", "unlikely", {190, 165, 140}, "no disparity is likely there (refined disparities only)"},
};
// clang-format on

/// The names in the order of the bits.
inline constexpr auto kRejects = [] {
  std::array<Choice<Reject>, kReasons.size()> all{};
  std::transform(kReasons.begin(), kReasons.end(), all.begin(), [](const Reason& r) {
    return Choice<Reject>{r.name, r.bit};
  });
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  return all;
}();
static_assert(std::adjacent_find(kRejects.begin(), kRejects.end(), [](const auto& a, const auto& b) {
                return a.value == b.value;
              }) == kRejects.end());

constexpr Reject operator|(Reject a, Reject b) {
  return static_cast<Reject>(static_cast<std::uint16_t>(a) | static_cast<std::uint16_t>(b));
}
constexpr Reject operator&(Reject a, Reject b) {
  return static_cast<Reject>(static_cast<std::uint16_t>(a) & static_cast<std::uint16_t>(b));
}
constexpr Reject operator~(Reject a) {
  return static_cast<Reject>(~static_cast<std::uint16_t>(a) & 0xFFFFU);
}
constexpr Reject& operator|=(Reject& a, Reject b) {
  return a = a | b;
}
constexpr bool has(Reject set, Reject bit) {
  return (set & bit) != Reject::none;
}

/// Whether legends and tables list a reason: if it is in force or occurs. Sky is listed only where it occurs, since
/// there is none indoors, nor before the objects are known.
constexpr bool is_listed(Reject reason, Reject in_force, std::int64_t pixels) {
  return pixels > 0 || has(in_force & ~Reject::sky, reason);
}

}  // namespace cairn
