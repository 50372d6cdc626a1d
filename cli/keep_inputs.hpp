// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common.hpp"

namespace cairn::cli {

/// Throws Error where a file to be written is one of those that are read, whatever links lead there.
void keep_inputs(const std::vector<std::filesystem::path>& outputs, const io::FrameFiles& files,
                 const InputOptions& options);

/// Throws Error if the file is a folder, or its folder is missing or write-protected.
void require_writable(const std::string& file);

}  // namespace cairn::cli
