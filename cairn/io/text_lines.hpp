// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// Reading of numeric tables as text, line by line; internal to source.
namespace cairn::io {

/// A generous limit: an hour of an IMU at 1 kHz has half of it.
inline constexpr std::size_t kMaxLogBytes = std::size_t{1} << 30;

struct TextLine {
  std::size_t number = 0;  // from 1
  std::string_view text;
};
/// The lines that are neither empty nor comments (#), trimmed; views of `text`.
std::vector<TextLine> lines_of(std::string_view text);

/// The fields between commas, semicolons or blanks. Consecutive commas have an empty field between them.
std::vector<std::string_view> fields_of(std::string_view line);

/// A number; NaN for an empty field, "nan" and overflow. Throws Error naming file and line if the field is
/// invalid.
double number_in(std::string_view field, const std::filesystem::path& path, std::size_t line);

/// "FILE:LINE".
std::string place(const std::filesystem::path& path, std::size_t line);

/// printf's format for one number.
std::string text_of(const char* format, double value);

/// At most 40 characters, quoted.
std::string quoted(std::string_view text);

}  // namespace cairn::io
