// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace cairn::io {

/// A whole file's bytes. Throws Error (names `path`): missing, a folder, unreadable, or longer than
/// `most_bytes`.
std::string read_file(const std::filesystem::path& path, std::size_t most_bytes);

/// What is read as text (calibration, configuration): no honest file of these kinds is longer.
inline constexpr std::size_t kMostTextBytes = std::size_t{1} << 20;

}  // namespace cairn::io
