// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <stdexcept>
#include <string>

namespace cairn {

/// Bad input from outside. One sentence: what was found, what was expected, which file or option.
/// Thrown at the doors only (files, config, StereoPair::from); past them a stage cannot fail.
class Error : public std::runtime_error {
 public:
  /// What it says may quote names and contents from anywhere: control characters, which would break the line
  /// or steer a terminal, are written as escapes ("\n", "\x1b").
  explicit Error(const std::string& says);
};

}  // namespace cairn
