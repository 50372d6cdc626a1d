// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cairn {

/// The candidate of least edit distance, for "did you mean …?"; empty if no candidate is close.
std::string nearest(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace cairn
