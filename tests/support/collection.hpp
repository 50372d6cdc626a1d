// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdlib>
#include <filesystem>

namespace cairn {

/// The data collection: CAIRN_DATA, else next to the project. It may be missing.
inline std::filesystem::path collection() {
  const char* const named = std::getenv("CAIRN_DATA");
  return named != nullptr ? std::filesystem::path(named)
                          : std::filesystem::path(CAIRN_SOURCE_DIR) / "../shared/data";
}

}  // namespace cairn
