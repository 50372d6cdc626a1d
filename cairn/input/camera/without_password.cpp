// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/camera/without_password.hpp>

namespace cairn::input {

std::string without_password(std::string text) {
  std::size_t from = 0;
  while ((from = text.find("://", from)) != std::string::npos) {
    from += 3;
    const std::size_t end = text.find_first_of("/ \"'", from);
    const std::size_t at = text.substr(0, end).rfind('@');
    if (at != std::string::npos && at >= from) text.replace(from, at - from, "***");
  }
  // Names of GStreamer properties.
  for (const char* property : {"user-id=", "user-pw=", "proxy-id=", "proxy-pw=", "password="}) {
    std::size_t at = 0;
    while ((at = text.find(property, at)) != std::string::npos) {
      at += std::char_traits<char>::length(property);
      const bool is_quoted = at < text.size() && (text[at] == '"' || text[at] == '\'');
      const std::size_t end = is_quoted ? text.find(text[at], at + 1) : text.find_first_of(" !", at);
      text.replace(at, (end == std::string::npos ? text.size() : end + (is_quoted ? 1 : 0)) - at, "***");
    }
  }
  return text;
}

}  // namespace cairn::input
