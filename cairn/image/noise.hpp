// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/view.hpp>

namespace cairn {

/// The standard deviation of the image noise in grey levels: the median of |response| to a kernel that
/// ignores steps and ramps (1 −2 1; −2 4 −2; 1 −2 1), divided by 6·0.6745. 0 for images smaller than 3×3.
/// (docs/stages/textured.md, beyond the paper)
float noise_sigma(View<const Gray> image, const Exec& exec = {});

}  // namespace cairn
