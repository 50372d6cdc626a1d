// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstddef>
#include <functional>

namespace cairn {

/// Calls body(i, exec) for i = 0 … count−1 on `threads` threads, each with its own Exec and pool. Rethrows
/// the first exception.
void for_each_index(std::size_t count, int threads,
                    const std::function<void(std::size_t index, const Exec& exec)>& body,
                    Target target = Target::best);

}  // namespace cairn
