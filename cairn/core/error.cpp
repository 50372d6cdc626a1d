// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>

#include <algorithm>

namespace cairn {
namespace {

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
}

}  // namespace

std::string on_one_line(const std::string& text) {
  if (std::none_of(text.begin(), text.end(), is_control)) return text;
  constexpr const char* kDigits = "0123456789abcdef";
  std::string line;
  for (const char c : text) {
    if (c == '\n') {
      line += "\\n";
    } else if (is_control(c)) {
      const auto value = static_cast<unsigned char>(c);
      line += {'\\', 'x', kDigits[value / 16], kDigits[value % 16]};
    } else {
      line += c;
    }
  }
  return line;
}

Error::Error(const std::string& says) : std::runtime_error(on_one_line(says)) {}

}  // namespace cairn
