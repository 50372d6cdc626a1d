// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/regions/region_features.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "grids.hpp"

/// An image of regions drawn as text in a test's source, with all per-pixel inputs.
namespace cairn::support {

struct RegionScene {
  Superpixels superpixels;
  Image<Gray> gray;
  Image<Rgb> rgb;  // initially empty
  Image<float> disparity_px;
  Image<float> textured_px;
  Ground ground;
  Background background;

  /// Uniform grey, without edges or disparities.
  explicit RegionScene(Image<RegionId> labels) {
    const Size size = labels.size();
    int last = 0;
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) last = std::max(last, number(labels(x, y)));
    }
    superpixels.labels = std::move(labels);
    superpixels.count = last + 1;
    superpixels.edges = Image<std::uint16_t>(size, std::uint16_t{0}, {});
    gray = Image<Gray>(size, Gray{100}, {});
    disparity_px = Image<float>(size, std::numeric_limits<float>::quiet_NaN(), {});
    textured_px = disparity_px.clone();
  }

  /// `shades[i]`: grey level of region i.
  void paint(const std::vector<int>& shades) {
    for_each_pixel([&](int x, int y, std::size_t region) { gray(x, y) = static_cast<Gray>(shades[region]); });
  }
  /// Disparities everywhere, supported at every third pixel: at(x, y, region).
  template <class At>
  void place(At at) {
    for_each_pixel([&](int x, int y, std::size_t region) {
      disparity_px(x, y) = at(x, y, region);
      if ((x + y) % 3 == 0) textured_px(x, y) = disparity_px(x, y);
    });
  }
  template <class Visit>
  void for_each_pixel(Visit visit) {
    for (int y = 0; y < gray.height(); ++y) {
      for (int x = 0; x < gray.width(); ++x) visit(x, y, index(superpixels.labels(x, y)));
    }
  }

  [[nodiscard]] Cues cues() const {
    return {{gray, rgb.empty() ? View<const Rgb>{} : rgb.view(), 1},
            disparity_px,
            textured_px,
            ground,
            background};
  }
};

}  // namespace cairn::support
