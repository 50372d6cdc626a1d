// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>

namespace cairn {

/// The left image as the stages use it. Borrows its images.
struct LeftImage {
  View<const Gray> gray;
  View<const Rgb> rgb = {};  // empty: no colour
  float noise_sigma = 0;     // grey levels, see noise_sigma()
};

}  // namespace cairn
