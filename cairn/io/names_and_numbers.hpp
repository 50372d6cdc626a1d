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

/// Names of files and computers, and numbers in them; internal to source.
namespace cairn::io {

/// The number that is the whole text; nullopt if it is empty, has other characters, or is too large.
template <class Number>
std::optional<Number> whole(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// The name of this computer in its network; empty if it is not known.
std::string host_name();

/// Whether `path` is an accessible folder.
bool is_folder(const std::filesystem::path& path);

}  // namespace cairn::io
