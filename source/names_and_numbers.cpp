// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "names_and_numbers.hpp"

namespace cairn::io {

std::string number_text(std::size_t index) {
  constexpr std::size_t kDigits = 6;
  std::string text = std::to_string(index);
  if (text.size() < kDigits) text.insert(0, kDigits - text.size(), '0');
  return text;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_folder(const std::filesystem::path& path) {
  std::error_code unknown;
  return std::filesystem::is_directory(path, unknown);
}

}  // namespace cairn::io
