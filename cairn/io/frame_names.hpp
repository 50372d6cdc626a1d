// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace cairn::io {

bool is_digit(char c);

/// A name that begins with a dot, such as ._left.png, which macOS writes next to left.png.
bool is_hidden(const std::filesystem::path& path);

/// The order of names with numbers: 9 before 10, zero-padded or not; ties by bytes.
bool in_natural_order(const std::string& a, const std::string& b);

/// "000012": the name of a numbered frame.
std::string number_text(std::size_t index);

}  // namespace cairn::io
