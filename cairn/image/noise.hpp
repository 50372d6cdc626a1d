// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/view.hpp>

namespace cairn {

/// The standard deviation of the image's noise in grey levels: the median of |response| to a kernel that
/// answers to neither steps nor ramps (1 −2 1; −2 4 −2; 1 −2 1), over 6·0.6745. Images under 3×3 have none
/// (0). (docs/stages/evidence.md, beyond the paper)
float noise_sigma(View<const Gray> image, const Exec& exec = {});

}  // namespace cairn
