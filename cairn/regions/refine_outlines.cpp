// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/geometry.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/regions/refine_outlines.hpp>
#include <cairn/stereo/label_kernels.hpp>
#include <utility>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows
constexpr int kPasses = 2;  // at most one pixel each: as far as a pixel of the coarse image

/// Whether a region stays connected (or at all) without a pixel, by its neighbours that are of the region: bit 0 above,
/// then clockwise.
constexpr std::array<bool, 256> kCanLeave = [] {
  std::array<bool, 256> can{};
  for (unsigned around = 0; around < can.size(); ++around) {
    const auto has = [&](unsigned i) { return (around >> (i % 8) & 1U) != 0; };
    int pieces = 0;
    for (unsigned i = 0; i < 8; i += 2) pieces += has(i) && !(has(i + 7) && has(i + 6)) ? 1 : 0;
    can[around] = pieces == 1;
  }
  return can;
}();

class Outlines {
 public:
  Outlines(Image<RegionId>& labels, View<const std::uint16_t> edges) : labels_(labels), edges_(edges) {}

  /// Gives the pixel to a neighbouring region if it is on that side of the crest: if the pixel behind it is a stronger
  /// edge than itself and the pixel of the other region.
  void move(int x, int y) {
    const RegionId here = labels_(x, y);
    const int edge = edges_(x, y);
    int gain = 0;
    RegionId to = here;
    const auto look = [&](Point p, Point q) {
      if ((labels_(p.x, p.y) == here) == (labels_(q.x, q.y) == here)) return;
      const auto [behind, ahead] = labels_(p.x, p.y) == here ? std::pair{p, q} : std::pair{q, p};
      const int rise = edges_(behind.x, behind.y) - std::max<int>(edge, edges_(ahead.x, ahead.y));
      if (rise <= gain) return;
      gain = rise;
      to = labels_(ahead.x, ahead.y);
    };
    // Outside the image it goes on like at its border.
    const int up = std::max(y - 1, 0);
    const int down = std::min(y + 1, labels_.height() - 1);
    const int left = std::max(x - 1, 0);
    const int right = std::min(x + 1, labels_.width() - 1);
    look({x, up}, {x, down});
    look({left, y}, {right, y});
    if (gain > 0 && can_leave(x, y)) labels_(x, y) = to;
  }

 private:
  [[nodiscard]] bool can_leave(int x, int y) const {
    constexpr std::array<Point, 8> kAround{
        {{0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}}};
    unsigned around = 0;
    for (unsigned i = 0; i < kAround.size(); ++i) {
      const int nx = x + kAround[i].x;
      const int ny = y + kAround[i].y;
      if (edges_.contains(nx, ny) && labels_(nx, ny) == labels_(x, y)) around |= 1U << i;
    }
    return kCanLeave[around];
  }

  Image<RegionId>& labels_;
  View<const std::uint16_t> edges_;
};

Image<RegionId> doubled(View<const RegionId> coarse, Size size, const Exec& exec) {
  Image<RegionId> labels(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const RegionId* const from = coarse.row(y / 2);
      RegionId* const to = labels.row(y);
      for (int x = 0; x < size.width / 2; ++x) to[2 * x] = to[2 * x + 1] = from[x];
      if (size.width % 2 != 0) to[size.width - 1] = from[size.width / 2];
    }
  });
  return labels;
}

}  // namespace

Image<RegionId> refine_outlines(View<const RegionId> coarse, View<const std::uint16_t> edges,
                                const Exec& exec) {
  const kernels::LabelKernels& run = kernels::label_kernels(exec);
  const int width = edges.width();
  const int height = edges.height();
  Image<RegionId> labels = doubled(coarse, edges.size(), exec);
  Outlines outlines(labels, edges);
  struct Found {
    std::vector<std::int32_t> pixels;
    int count = 0;
  };
  std::array<Found, 2> found;  // of rows with an even and with an odd number
  for (Found& row : found) row.pixels.resize(slot(width) + kernels::kListSlack);
  const auto find = [&](int y) {
    const auto rows = [&]<class T>(View<const T> image) {
      return kernels::ThreeRows<T>{image.row(std::max(y - 1, 0)), image.row(y),
                                   image.row(std::min(y + 1, height - 1))};
    };
    Found& row = found[slot(y % 2)];
    row.count = run.past_crest(rows(View<const RegionId>(labels)), rows(edges), width, row.pixels.data());
  };
  for (int pass = 0; pass < kPasses; ++pass) {
    find(0);
    for (int y = 0; y < height; ++y) {
      if (y + 1 < height) find(y + 1);  // before pixels above it move
      const Found& row = found[slot(y % 2)];
      for (std::size_t i = 0; i < slot(row.count); ++i) outlines.move(row.pixels[i], y);
    }
  }
  return labels;
}

}  // namespace cairn
