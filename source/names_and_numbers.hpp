// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <charconv>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

/// Names of files, and numbers in them; internal to source.
namespace cairn::io {

/// The number that the whole text is; none where it is empty, has more than a number, or one that is too
/// large.
template <class Number>
std::optional<Number> whole(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// "000012": the name of a frame that has only a number.
std::string number_text(std::size_t index);

bool is_digit(char c);

/// 9 before 10, whether or not the numbers are padded with zeros; ties by bytes.
bool in_natural_order(const std::string& a, const std::string& b);

/// Whether it is one that can be looked at.
bool is_folder(const std::filesystem::path& path);

}  // namespace cairn::io
