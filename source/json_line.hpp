// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/error.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "../tracking/pose.hpp"

/// Values out of JSON that others wrote: each is checked for its type and range before it becomes a number.
namespace cairn::io {

/// None where the text is no JSON. Throws Error where it nests deeper than any file of ours: what walks it
/// recurses.
std::optional<nlohmann::json> parsed_json(const std::string& text);

/// A value as a message shows it: cut where it is long.
std::string shown(const nlohmann::json& value);

/// An object of keys and values. All throw Error (the key, what was found, what was expected) without a
/// file's name. A key with null is as good as missing.
class JsonLine {
 public:
  static constexpr std::int64_t kMostNumber = std::numeric_limits<std::int64_t>::max();
  static constexpr double kFarthest = 1e9;  // m, m², m/s: no honest number is larger

  explicit JsonLine(const nlohmann::json& object);

  /// Null where it is missing.
  [[nodiscard]] const nlohmann::json& at(const char* key) const;
  [[noreturn]] void refuse(const char* key, const std::string& expected) const;
  [[nodiscard]] std::optional<std::int64_t> maybe_integer(const char* key, std::int64_t least,
                                                          std::int64_t most) const;
  [[nodiscard]] std::int64_t integer(const char* key, std::int64_t least, std::int64_t most) const;
  [[nodiscard]] std::string text(const char* key) const;
  /// False where it is missing.
  [[nodiscard]] bool flag(const char* key) const;
  /// None also where one of the numbers is null: it was not finite.
  template <std::size_t n>
  [[nodiscard]] std::optional<std::array<double, n>> maybe_numbers(const char* key) const {
    std::array<double, n> numbers{};
    return fill(key, numbers.data(), n) ? std::optional(numbers) : std::nullopt;
  }
  [[nodiscard]] std::optional<Point3> maybe_point(const char* key) const;

 private:
  bool fill(const char* key, double* numbers, std::size_t count) const;

  const nlohmann::json& object_;
};

}  // namespace cairn::io
