// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "without_password.hpp"

namespace cairn::io {

std::string without_password(std::string text) {
  std::size_t from = 0;
  while ((from = text.find("://", from)) != std::string::npos) {
    from += 3;
    const std::size_t end = text.find_first_of("/ \"'", from);
    const std::size_t at = text.substr(0, end).rfind('@');
    if (at != std::string::npos && at >= from) text.replace(from, at - from, "***");
  }
  return text;
}

}  // namespace cairn::io
