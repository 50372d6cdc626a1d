// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/objects/measure.hpp>
#include <optional>
#include <string_view>
#include <tuple>
#include <vector>

/// The members of the library's structs, each listed once: from this list follow attributes and pickling.
namespace cairn::python {

/// A struct's members as a tuple of references, and their names in Python.
template <class T>
struct Members;

// Naming too few or too many members does not compile, so new members cannot be forgotten. Those whose names
// begin with an underscore are no attributes.
#define CAIRN_MEMBERS(Type, ...)                             \
  template <>                                                \
  struct Members<Type> {                                     \
    static constexpr std::string_view kNames = #__VA_ARGS__; \
    template <class Value>                                   \
    static auto of(Value& value) {                           \
      auto& [__VA_ARGS__] = value;                           \
      return std::tie(__VA_ARGS__);                          \
    }                                                        \
  };

/// Structs that are tuples in Python.
template <class T>
inline constexpr bool kIsTuple = false;
#define CAIRN_TUPLE(Type, ...)     \
  CAIRN_MEMBERS(Type, __VA_ARGS__) \
  template <>                      \
  inline constexpr bool kIsTuple<Type> = true;
CAIRN_TUPLE(Size, width, height)
CAIRN_TUPLE(Rect, x, y, width, height)
CAIRN_TUPLE(Vec3, x, y, z)
CAIRN_TUPLE(Rgb, r, g, b)
CAIRN_TUPLE(Interval, low, high)
CAIRN_TUPLE(PointPair, x_left, y_left, x_right, y_right)

template <class T>
inline constexpr bool kIsImage = false;
template <class T>
inline constexpr bool kIsImage<Image<T>> = true;
template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;
template <class T>
inline constexpr bool kIsList = false;
template <class T>
inline constexpr bool kIsList<std::vector<T>> = true;
template <class T, std::size_t N>
inline constexpr bool kIsList<std::array<T, N>> = true;

}  // namespace cairn::python
