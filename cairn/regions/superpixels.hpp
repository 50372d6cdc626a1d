// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cairn/core/left_image.hpp>
#include <cairn/regions/region_graph.hpp>
#include <cstdint>

namespace cairn {

struct ObjectHint;

struct SuperpixelsConfig {
  int count = 150;  // superpixels of 320×240 px; more follow small objects, and take longer
};
template <class V>
void fields(SuperpixelsConfig& c, V&& v) {
  v("count", c.count, "",
    "largest number of superpixels of 320x240 pixels; more for small objects, but slower", range(1, 100000),
    when("pipeline.method", "region_tree"));
}

/// Connected pieces of the image without a clear edge of brightness, colour or depth inside.
struct Superpixels {
  Image<RegionId> labels;  // 0 … count−1 in raster order of their first pixel, before outlines are refined
  int count = 0;
  Image<std::uint16_t> edges;  // superpixel_edges(), in 1/4 grey level
};

/// The largest number of superpixels of an image: config.count up to 320×240 pixels, in proportion to the pixels up to
/// 480×360, and 2.25 · config.count from there on.
int most_superpixels(Size image, const SuperpixelsConfig& config);

/// How likely an outline is, 0 … 256, from its log-odds in 1/16: 0 up to −2, 256 from 2 on, straight in between.
constexpr int outline_share(int log_odds) {
  return 4 * std::clamp(log_odds + 32, 0, 64);
}

/// Superpixels by watershed and merging. The edge image is edge_strength() at σ = 0.7 px, stronger where the network
/// expects the outline of an object (four times as strong plus 8 grey levels where it is sure: see
/// outline_share()), plus 2 grey levels per px of the largest disparity step to one of the four neighbours (at most 8, rounded to 1/4), so that
/// depth separates surfaces of equal brightness; values below 1 + noise_sigma grey levels (rounded down to
/// 1/4) are set to 0. While it has at least 1600 pixels per superpixel, it is halved: means of 2×2, rounded. Basins of
/// its watershed with less than 1/40 of the pixels of an average superpixel join the neighbour across their lowest
/// pass, all at once. Then they are merged in pairs, in ascending order of
///
///     (mean edge along the common border + 1/2 grey level) · sqrt(area of the smaller one)
///
/// until most_superpixels() are left: small and similar ones first. The edge (or pass) between two pixels is the stronger
/// one of theirs, depth included. Ties: the border that occurs first, row by row, from each pixel to the right before down.
///
/// If the edges were halved, labels are doubled again as often, and outlines moved after each time, twice by at most
/// one pixel: a pixel goes over to the superpixel of a neighbour if the opposite neighbour, of its own superpixel, is a
/// stronger edge than both, and if its superpixel stays connected. `disparity_px`: NaN for holes, which add no edge.
/// (docs/stages/superpixels.md, beyond the paper)
Superpixels cut_superpixels(const LeftImage& left, View<const float> disparity_px,
                            const SuperpixelsConfig& config, const Exec& exec);

/// The same in steps: first the edges of the image, edge_strength() at σ = 0.7 px …
Image<std::uint16_t> superpixel_edges(const LeftImage& left, const Exec& exec);
/// … then the superpixels. `hints`: hint_objects(); may be empty.
Superpixels cut_superpixels(Image<std::uint16_t> edges, View<const ObjectHint> hints,
                            View<const float> disparity_px, float noise_sigma,
                            const SuperpixelsConfig& config, const Exec& exec);

/// The superpixels as a segmentation, with their grey level statistics.
Segmentation superpixel_regions(const Superpixels& superpixels, View<const Gray> left, const Exec& exec);

}  // namespace cairn
