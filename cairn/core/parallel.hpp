// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <functional>

namespace cairn {

/// Calls body(first, last) for consecutive ranges that together cover [0, count), on the threads of `exec`.
/// Ranges hold at least `grain` elements (but the last). How the split falls must not change a result.
void parallel_for(const Exec& exec, int count, int grain,
                  const std::function<void(int first, int last)>& body);

}  // namespace cairn
