// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <stdexcept>

namespace cairn {

/// Bad input from outside. One sentence: what was found, what was expected, which file or option.
/// Thrown at the doors only (files, config, StereoPair::from); past them a stage cannot fail.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace cairn
