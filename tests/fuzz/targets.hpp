// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>
#include <string_view>
#include <vector>

/// What is fuzzed: everything that reads what others wrote, and the method itself with any options. Used by
/// the fuzzers (./dev fuzz) and by unit/foreign_bytes_test.cpp.
namespace cairn::fuzz {

struct Target {
  const char* name;
  /// Does with the bytes what the program would. Returns whether they were taken; what is not taken ends in
  /// an Error of one line, which is checked. Anything else that is thrown goes on.
  bool (*run)(std::string_view bytes);
  /// Small inputs that are taken, made by our own code or written by hand.
  std::vector<std::string> (*seeds)();
};

const std::vector<Target>& targets();

}  // namespace cairn::fuzz
