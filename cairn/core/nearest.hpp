// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cairn {

/// The candidate of least edit distance, where one that begins or ends with four or more characters of the name counts as
/// 1, for "did you mean …?"; empty if more than a third of the name would have to change.
std::string nearest(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace cairn
