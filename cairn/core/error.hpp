// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <stdexcept>
#include <string>

namespace cairn {

/// `text` with its control characters, which would break a line or steer a terminal, as escapes ("\n",
/// "\x1b").
std::string on_one_line(const std::string& text);

/// Bad input from outside. One sentence: what was found, what was expected, in which file or option. Thrown
/// only where input enters (files, config, StereoPair::from); stages do not fail.
class Error : public std::runtime_error {
 public:
  /// `says` may quote names and contents from anywhere: see on_one_line().
  explicit Error(const std::string& says);
};

}  // namespace cairn
