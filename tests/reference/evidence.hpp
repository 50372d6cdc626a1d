// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/grouping/evidence.hpp>
#include <cairn/grouping/facets.hpp>
#include <cairn/grouping/figure.hpp>
#include <cairn/grouping/minimum_cut.hpp>
#include <cairn/image/gradient.hpp>
#include <cstdint>
#include <vector>

/// The slow twins of the way from evidence to figure: each pixel and each facet by its definition alone.
namespace cairn::reference {

float noise_sigma(View<const Gray> image);
Image<float> find_evidence(View<const Gray> left, const DisparityMap& disparity,
                           const EvidenceConfig& config);
Image<std::uint16_t> edge_strength(View<const Gray> gray, View<const Rgb> rgb, float smoothing_sigma);
std::vector<Border> borders_of(View<const RegionId> labels, View<const std::uint16_t> edges);
std::vector<std::int32_t> flooded(std::vector<std::int32_t> labels, const std::vector<Border>& borders,
                                  std::int32_t otherwise);
std::vector<std::int32_t> minimum_cut(const std::vector<std::int64_t>& cost_0,
                                      const std::vector<std::int64_t>& cost_1, const std::vector<Tie>& ties);
std::vector<std::int32_t> separate_figure(const Facets& facets, View<const Gray> gray, View<const Rgb> rgb,
                                          View<const float> evidence_px, const Background& background,
                                          const FigureConfig& config);

}  // namespace cairn::reference
