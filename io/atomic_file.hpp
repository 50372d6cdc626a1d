// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <string_view>

namespace cairn::io {

/// Writes a whole file or nothing: the bytes go to a temporary name in the same folder, which then takes the
/// final name. Whoever reads `path` meanwhile sees the old file or the new one, never a part; after a failure
/// no trace is left. A symbolic link is followed; a device (/dev/null, /dev/stdout) is written directly.
/// Throws Error (names `path` and the system's reason).
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// Makes a folder with all its parents; fine where it is there already. Throws Error.
void make_folder(const std::filesystem::path& path);

}  // namespace cairn::io
