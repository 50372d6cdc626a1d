// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// Tables of numbers as text, line by line; internal to source.
namespace cairn::io {

/// No honest log is longer: an hour of an IMU at 1 kHz has half of it.
inline constexpr std::size_t kMostLogBytes = std::size_t{1} << 30;

struct TextLine {
  std::size_t number = 0;  // from 1
  std::string_view text;
};
/// The lines that are neither empty nor comments (#), without blanks at their ends; views of `text`.
std::vector<TextLine> lines_of(std::string_view text);

/// The fields between commas, semicolons or blanks. Two commas in a row have an empty field between them.
std::vector<std::string_view> fields_of(std::string_view line);

/// A number; NaN for an empty field, "nan" and what is too large. Throws Error where the field is none,
/// naming the file and the line.
double number_in(std::string_view field, const std::filesystem::path& path, std::size_t line);

/// "FILE:LINE".
std::string place(const std::filesystem::path& path, std::size_t line);

/// printf's format for one number.
std::string text_of(const char* format, double value);

/// At most 40 characters of it, quoted.
std::string quoted(std::string_view text);

}  // namespace cairn::io
