// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cairn::cli {

/// The options of `cairn map`.
struct MapOptions {
  std::string action;
  std::string file;
  std::vector<std::string> others;
  std::string form = "geojson";
  std::string output;
  std::vector<std::int64_t> ids;
  bool gone = false;
  std::vector<std::string> places;  // --at: NAME=x,y,deg
  std::int64_t run = 0;
};

/// Executes the action and returns the exit code. Throws Error; always if sequences are not built in.
int work_on_map(const MapOptions& options);

}  // namespace cairn::cli
