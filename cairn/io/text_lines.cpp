// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/io/text_lines.hpp>

#include <array>
#include <cairn/core/error.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

namespace cairn::io {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

std::string_view trimmed_of(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

}  // namespace

std::vector<TextLine> lines_of(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::vector<TextLine> lines;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed_of(text.substr(0, end));
    if (!line.empty() && line.front() != '#') lines.push_back({number, line});
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::vector<std::string_view> fields_of(std::string_view line) {
  const bool has_separators = line.find_first_of(",;") != std::string_view::npos;
  std::vector<std::string_view> fields;
  while (true) {
    if (!has_separators) line = trimmed_of(line);
    const std::size_t end = std::min(line.find_first_of(has_separators ? ",;" : kBlanks), line.size());
    fields.push_back(trimmed_of(line.substr(0, end)));
    if (end == line.size()) return fields;
    line.remove_prefix(end + 1);
  }
}

double number_in(std::string_view field, const std::filesystem::path& path, std::size_t line) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  if (field.empty()) return kNaN;
  const std::string_view digits = field.front() == '+' ? field.substr(1) : field;
  double number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (end == digits.data() + digits.size() && error == std::errc::result_out_of_range) return kNaN;
  if (end != digits.data() + digits.size() || error != std::errc{})
    throw Error(place(path, line) + ": found " + quoted(field) + ", expected a number");
  return std::isfinite(number) ? number : kNaN;
}

std::string place(const std::filesystem::path& path, std::size_t line) {
  return path.string() + ":" + std::to_string(line);
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kMax = 40;
  std::string shown = "'";
  for (const char c : text.substr(0, kMax)) shown += c >= 0x20 && c < 0x7f ? c : '?';
  return shown + (text.size() > kMax ? "...'" : "'");
}

std::string text_of(const char* format, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

}  // namespace cairn::io
