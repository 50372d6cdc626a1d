// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/image.hpp>
#include <cstdint>

namespace cairn {

/// Sets the gradient to 0 where it is below `threshold` (in its own units), so that a uniform surface with
/// noise is one plateau without lower border, hence one basin. 0 or less: no effect.
/// (docs/stages/intensity.md)
void level_below(double threshold, Image<std::uint16_t>& gradient, const Exec& exec);

}  // namespace cairn
