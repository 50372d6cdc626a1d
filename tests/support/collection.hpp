// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdlib>
#include <filesystem>

namespace cairn {

/// The data collection: where CAIRN_DATA says, else beside the project. It need not be there.
inline std::filesystem::path collection() {
  const char* const named = std::getenv("CAIRN_DATA");
  return named != nullptr ? std::filesystem::path(named)
                          : std::filesystem::path(CAIRN_SOURCE_DIR) / "../shared/data";
}

}  // namespace cairn
