// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace cairn::io {

/// The bytes of a file. Throws Error (names `path`): missing, a folder, unreadable, or longer than
/// `most_bytes`.
std::string read_file(const std::filesystem::path& path, std::size_t most_bytes);

/// Size limit of text files (calibration, configuration).
inline constexpr std::size_t kMaxTextBytes = std::size_t{1} << 20;

}  // namespace cairn::io
