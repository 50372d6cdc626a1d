// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace cairn::lab {

/// A number in printf's format; a dash for NaN.
inline std::string text_of(const char* format, double value) {
  if (std::isnan(value)) return "–";
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

/// 0.621 as "62.1"; a dash for NaN.
inline std::string percent(double share) {
  return text_of("%.1f", 100 * share);
}

/// A Markdown table: leading text columns are left-aligned, the number columns after them right-aligned.
class MarkdownTable {
 public:
  explicit MarkdownTable(std::vector<std::string> header, std::size_t columns_of_words = 1)
      : header_(std::move(header)), columns_of_words_(columns_of_words) {}

  /// Shorter rows are padded with empty cells.
  void add(std::vector<std::string> row) {
    row.resize(header_.size());
    rows_.push_back(std::move(row));
  }

  [[nodiscard]] std::string text() const {
    std::string all = line(header_) + "|";
    for (std::size_t i = 0; i < header_.size(); ++i) all += i < columns_of_words_ ? "---|" : "---:|";
    all += "\n";
    for (const auto& row : rows_) all += line(row);
    return all;
  }

 private:
  static std::string line(const std::vector<std::string>& cells) {
    std::string all = "|";
    for (const std::string& cell : cells) {
      all += ' ';
      for (const char c : cell) all += c == '|' ? "\\|" : std::string(1, c);  // a bare bar ends the cell
      all += " |";
    }
    return all + "\n";
  }

  std::vector<std::string> header_;
  std::size_t columns_of_words_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace cairn::lab
