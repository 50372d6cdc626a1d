// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/image/gradient.hpp>
#include <cairn/regions/textured.hpp>
#include <cstdint>

/// The slow twins of texture, noise and contrast: each pixel by its definition alone.
namespace cairn::reference {

float noise_sigma(View<const Gray> image);
Image<float> select_textured(View<const Gray> left, const DisparityMap& disparity,
                             const TexturedConfig& config);
Image<std::uint16_t> edge_strength(View<const Gray> gray, View<const Rgb> rgb, float smoothing_sigma);

}  // namespace cairn::reference
