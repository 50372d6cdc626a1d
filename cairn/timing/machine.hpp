// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <fstream>
#include <string>

/// Machine and build of a measurement, part of every report.
namespace cairn::timing {

/// The name in /proc/cpuinfo; on ARM, which has none there, that of the board.
inline std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  std::string board;
  std::getline(std::ifstream("/proc/device-tree/model"), board, '\0');
  return board.empty() ? "unknown processor" : board;
}

/// The compiler of the calling program; the library is from the same build.
inline std::string compiler() {
#if defined(__clang__)
  return "Clang " __clang_version__;
#elif defined(__GNUC__)
  return "GCC " __VERSION__;
#else
  return "unknown compiler";
#endif
}

}  // namespace cairn::timing
