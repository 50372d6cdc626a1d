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

#include <cairn/sequence/pose.hpp>

/// Access to JSON from outside: type and range of each value are checked.
namespace cairn::output {

/// nullopt if the text is not JSON. Throws Error for excessive nesting, since readers recurse.
std::optional<nlohmann::json> parsed_json(const std::string& text);

/// A value for messages: truncated if long.
std::string shown(const nlohmann::json& value);

/// An object of keys and values. All members throw Error (key, found, expected) without the name of a file. A
/// null value counts as missing.
class JsonLine {
 public:
  static constexpr std::int64_t kMaxNumber = std::numeric_limits<std::int64_t>::max();
  static constexpr double kMaxDistance = 1e9;  // m, m², m/s: no valid number is larger

  explicit JsonLine(const nlohmann::json& object);

  /// Null if missing.
  [[nodiscard]] const nlohmann::json& at(const char* key) const;
  [[noreturn]] void refuse(const char* key, const std::string& expected) const;
  [[nodiscard]] std::optional<std::int64_t> maybe_integer(const char* key, std::int64_t least,
                                                          std::int64_t most) const;
  [[nodiscard]] std::int64_t integer(const char* key, std::int64_t least, std::int64_t most) const;
  [[nodiscard]] std::string text(const char* key) const;
  /// False if missing.
  [[nodiscard]] bool flag(const char* key) const;
  /// nullopt also if one of the numbers is null: it was not finite.
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

}  // namespace cairn::output
