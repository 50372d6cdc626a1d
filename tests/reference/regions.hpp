// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/image/gradient.hpp>
#include <cairn/objects/fuse.hpp>
#include <cairn/regions/grow_near_to_far.hpp>
#include <cairn/regions/segment_disparity.hpp>
#include <cairn/regions/segment_intensity.hpp>
#include <cairn/regions/watershed.hpp>
#include <cairn/stereo/gradient.hpp>

/// The slow twins of regions/ and objects/; the fast functions must give the same bits. Written for clarity,
/// with sets, maps and searches over the whole image; only for small images.
namespace cairn::reference {

Image<std::uint16_t> gradient(View<const Gray> image, float smoothing_sigma);
Image<std::int16_t> quantised(const DisparityMap& disparity);
Image<std::uint16_t> gradient(View<const std::int16_t> disparity16, float smoothing_sigma);
Image<std::uint16_t> levelled_below(double threshold, View<const std::uint16_t> gradient);
Basins watershed(View<const std::uint16_t> gradient);
Image<std::uint8_t> floor_with_holes(const Basins& basins, View<const std::uint8_t> floor,
                                     View<const std::int16_t> values);
Basins split_floor(const Basins& basins, View<const std::uint8_t> floor);
RegionGraph build_graph(View<const RegionId> labels, int count, View<const std::int16_t> values,
                        View<const std::uint8_t> floor);
bool may_fuse(const RegionGraph::Node& visited, const RegionGraph::Node& neighbour,
              const GrowCriteria& criteria);
Merges grow_statistical(const RegionGraph& graph, const GrowCriteria& criteria);
Merges grow_near_to_far(const RegionGraph& graph, const GrowCriteria& criteria);
Merges fuse_small_regions(const RegionGraph& graph, const Merges& merged_into, std::int64_t min_region_area);
Segmentation apply_merges(View<const RegionId> labels, const RegionGraph& graph, const Merges& merged_into,
                          double value_scale);
Segmentation segment_intensity(View<const Gray> image, const IntensityConfig& config);
Segmentation segment_disparity(const DisparityMap& disparity, View<const std::uint8_t> floor,
                               const DisparityConfig& config);
Fusion fuse(const Segmentation& by_intensity, const Segmentation& by_disparity);

}  // namespace cairn::reference
