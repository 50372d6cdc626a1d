// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/image/gradient.hpp>
#include <cairn/regions/cue_kernels.hpp>
#include <cairn/regions/fuse_basins.hpp>
#include <cairn/regions/object_hints.hpp>
#include <cairn/regions/percent.hpp>
#include <cairn/regions/refine_outlines.hpp>
#include <cairn/regions/superpixel_regions.hpp>
#include <cairn/regions/superpixels.hpp>
#include <cairn/regions/watershed.hpp>
#include <cairn/stereo/label_kernels.hpp>
#include <cstdint>
#include <utility>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 16;            // rows
constexpr float kSmoothing = 0.7F;    // px
constexpr float kStepWeight = 8.0F;   // 1/4 grey level for each px of a step of disparity
constexpr float kLargestStep = 4.0F;  // px
constexpr float kFlat = 4.0F;         // 1/4 grey level; weaker edges are ignored …
constexpr float kFlatInNoise = 4.0F;  // … and this much more per grey level of noise
constexpr int kMinCells = 1600;       // per superpixel, to be halved
constexpr int kOutlineGain = 4;       // of the edges where the network is sure of an outline …
constexpr int kOutlineStep = 32;      // … and 1/4 grey levels added
constexpr int kStrongest = 65000;     // steps of disparity are added to it

/// How far from the last cell's centre to the next one's a pixel is, in 1/256. Cells beyond the border are those at it.
struct Between {
  int first = 0;
  int next = 0;
  int part = 0;
};

Between between(int pixel, int pixels, int cells) {
  const int twice = 2 * pixels;
  const int position = (2 * pixel + 1) * cells - pixels + twice;  // in 1/twice of a cell, one cell added
  const int first = position / twice - 1;
  return {std::max(first, 0), std::min(first + 1, cells - 1), position % twice * 256 / twice};
}

/// Edges, stronger where the network expects outlines.
Image<std::uint16_t> with_outlines(View<const std::uint16_t> edges, View<const ObjectHint> hints,
                                   const Exec& exec) {
  const Size size = edges.size();
  Image<Between> across({size.width, 1}, exec.pool);
  for (int x = 0; x < size.width; ++x) across(x, 0) = between(x, size.width, hints.width());
  Image<int> shares({hints.width(), size.height}, exec.pool);  // of a row's pixels at the cells' centres
  Image<std::uint16_t> stronger(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first_row, int last_row) {
    for (int y = first_row; y < last_row; ++y) {
      const Between down = between(y, size.height, hints.height());
      const ObjectHint* const above = hints.row(down.first);
      const ObjectHint* const below = hints.row(down.next);
      int* const row = shares.row(y);
      for (int c = 0; c < hints.width(); ++c) {
        row[c] =
            outline_share(above[c].outline) * (256 - down.part) + outline_share(below[c].outline) * down.part;
      }
      const std::uint16_t* const in = edges.row(y);
      std::uint16_t* const out = stronger.row(y);
      for (int x = 0; x < size.width; ++x) {
        const auto [first, next, part] = across(x, 0);
        const int share = (row[first] * (256 - part) + row[next] * part) >> 16;
        const int edge = in[x];
        out[x] = static_cast<std::uint16_t>(
            std::min(edge + (((kOutlineGain - 1) * edge + kOutlineStep) * share >> 8), kStrongest));
      }
    }
  });
  return stronger;
}

/// Edges plus steps of disparity; 0 where neither exceeds the noise, which would cause most of the basins.
Image<std::uint16_t> with_steps(View<const std::uint16_t> edges, View<const float> disparity_px,
                                float noise_sigma, const Exec& exec) {
  const int least = static_cast<int>(kFlat + kFlatInNoise * noise_sigma);
  const kernels::CueKernels& run = kernels::cue_kernels(exec);
  const int height = edges.height();
  Image<std::uint16_t> sum(edges.size(), exec.pool);
  parallel_for(exec, height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      run.add_steps(edges.row(y),
                    {disparity_px.row(std::max(y - 1, 0)), disparity_px.row(y),
                     disparity_px.row(std::min(y + 1, height - 1))},
                    edges.width(), {kStepWeight, kLargestStep, least}, sum.row(y));
    }
  });
  return sum;
}

/// Half the size, rounded up: means of 2×2. The last column and row of odd sizes count twice.
Image<std::uint16_t> halved(View<const std::uint16_t> edges, const Exec& exec) {
  const int width = edges.width();
  const int last_row = edges.height() - 1;
  Image<std::uint16_t> half({(width + 1) / 2, (last_row + 2) / 2}, exec.pool);
  const kernels::CueKernels& run = kernels::cue_kernels(exec);
  parallel_for(exec, half.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y)
      run.halve(edges.row(2 * y), edges.row(std::min(2 * y + 1, last_row)), width, half.row(y));
  });
  return half;
}

}  // namespace

int most_superpixels(Size image, const SuperpixelsConfig& config) {
  return static_cast<int>(config.count * pixels_of_detail(image) / pixels_of_detail({320, 240}));
}

Image<std::uint16_t> superpixel_edges(const LeftImage& left, const Exec& exec) {
  return edge_strength(left.gray, left.rgb, kSmoothing, exec);
}

Superpixels cut_superpixels(Image<std::uint16_t> edges, View<const ObjectHint> hints,
                            View<const float> disparity_px, float noise_sigma,
                            const SuperpixelsConfig& config, const Exec& exec) {
  // Levels of half the size each: superpixels are cut at the last, and their outlines refined at those before.
  std::vector<Image<std::uint16_t>> levels;
  if (hints.empty()) {
    levels.push_back(with_steps(edges, disparity_px, noise_sigma, exec));
  } else {
    const Image<std::uint16_t> stronger = with_outlines(edges, hints, exec);
    levels.push_back(with_steps(stronger, disparity_px, noise_sigma, exec));
  }
  const int most = most_superpixels(edges.size(), config);
  while (levels.back().size().area() / most >= kMinCells) levels.push_back(halved(levels.back(), exec));
  Basins basins = fuse_basins(watershed(levels.back(), exec), levels.back(), most, exec);
  for (std::size_t level = levels.size() - 1; level-- > 0;)
    basins.labels = refine_outlines(basins.labels, levels[level], exec);
  return {std::move(basins.labels), basins.count, std::move(edges)};
}

Superpixels cut_superpixels(const LeftImage& left, View<const float> disparity_px,
                            const SuperpixelsConfig& config, const Exec& exec) {
  return cut_superpixels(superpixel_edges(left, exec), {}, disparity_px, left.noise_sigma, config, exec);
}

Segmentation superpixel_regions(const Superpixels& superpixels, View<const Gray> left, const Exec& exec) {
  constexpr int kMaxSummed = 1 << 15;  // pixels: fewer than those at which the kernel's sums overflow
  std::vector<std::uint64_t> up_to(slot(left.width()) + 1);
  return superpixel_regions(
      superpixels.labels.clone(exec.pool), slot(superpixels.count), exec,
      [&](const Run& run, Region& region) {
        if (run.first == 0)
          kernels::label_kernels(exec).sum_grey(left.row(run.y), left.width(), up_to.data());
        region.valid_count += run.length();
        for (int x = run.first; x < run.last; x += kMaxSummed) {
          const std::uint64_t sums = up_to[slot(std::min(x + kMaxSummed, run.last))] - up_to[slot(x)];
          region.mean += static_cast<double>(sums >> 40U);
          region.variance += static_cast<double>(sums & ((std::uint64_t{1} << 40U) - 1));
        }
      });
}

}  // namespace cairn
