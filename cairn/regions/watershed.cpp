// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/regions/watershed.hpp>
#include <cstring>

namespace cairn {
namespace {

// Where a pixel flows to. The numbers are the order in which ties are decided.
constexpr std::uint8_t kNowhere = 0;  // lowest around: a basin's floor, or a plateau pixel not reached yet
constexpr std::uint8_t kUp = 1;
constexpr std::uint8_t kLeft = 2;
constexpr std::uint8_t kRight = 3;
constexpr std::uint8_t kDown = 4;
constexpr std::uint8_t kDirection = 7;   // mask of the direction
constexpr std::uint8_t kAcross = 8;      // set where the pixel flows to a neighbour on its own plateau
constexpr std::uint8_t kOutside = 0xFF;  // frame around the image: neither flows nor is flown to

using Heights = Image<std::uint16_t>;
using Arrows = Image<std::uint8_t>;

/// All working images have this size: a frame one pixel wide around the image, so that no neighbour needs a
/// bounds check, and a width at which images of every pixel type have the same stride, so that one index
/// serves them all.
Size framed(Size size) {
  return {(size.width + 2 + 63) / 64 * 64, size.height + 2};
}

std::ptrdiff_t index_of(int x, int y, std::ptrdiff_t stride) {
  return (y + 1) * stride + x + 1;
}

Heights with_frame(View<const std::uint16_t> gradient, const Exec& exec) {
  const Size size = gradient.size();
  Heights heights(framed(size), exec.pool);
  std::fill_n(heights.row(0), heights.width(), UINT16_MAX);  // nothing is higher, so nothing flows out
  for (int y = 0; y < size.height; ++y) {
    std::uint16_t* const row = heights.row(y + 1);
    row[0] = UINT16_MAX;
    std::copy_n(gradient.row(y), size.width, row + 1);
    std::fill(row + 1 + size.width, row + heights.width(), UINT16_MAX);
  }
  std::fill_n(heights.row(size.height + 1), heights.width(), UINT16_MAX);
  return heights;
}

/// Arrows to the lowest neighbour, where that is lower.
Arrows downhill(const Heights& heights, Size size, const Exec& exec) {
  Arrows arrows(heights.size(), exec.pool);
  std::fill_n(arrows.row(0), arrows.width(), kOutside);
  for (int y = 1; y <= size.height; ++y) {
    const std::uint16_t* const here = heights.row(y) + 1;
    const std::uint16_t* const up = heights.row(y - 1) + 1;
    const std::uint16_t* const down = heights.row(y + 1) + 1;
    std::uint8_t* const out = arrows.row(y) + 1;
    for (int x = 0; x < size.width; ++x) {
      const std::uint16_t lowest = std::min(std::min(up[x], here[x - 1]), std::min(here[x + 1], down[x]));
      std::uint16_t arrow = down[x] == lowest ? kDown : kNowhere;
      arrow = here[x + 1] == lowest ? kRight : arrow;
      arrow = here[x - 1] == lowest ? kLeft : arrow;
      arrow = up[x] == lowest ? kUp : arrow;
      out[x] = static_cast<std::uint8_t>(lowest < here[x] ? arrow : kNowhere);
    }
    out[-1] = kOutside;
    std::fill(out + size.width, arrows.row(y) + arrows.width(), kOutside);
  }
  std::fill_n(arrows.row(size.height + 1), arrows.width(), kOutside);
  return arrows;
}

/// Calls found(x) for every x whose arrow is kNowhere. Eight at a time: most pixels have one.
template <class Found>
void for_each_nowhere(const std::uint8_t* arrows, int width, Found found) {
  int x = 0;
  for (; x + 8 <= width; x += 8) {
    std::uint64_t eight = 0;
    std::memcpy(&eight, arrows + x, 8);
    constexpr std::uint64_t kOnes = 0x0101010101010101;
    if (((eight - kOnes) & ~eight & (kOnes << 7U)) == 0) continue;
    for (int i = x; i < x + 8; ++i) {
      if (arrows[i] == kNowhere) found(i);
    }
  }
  for (; x < width; ++x) {
    if (arrows[x] == kNowhere) found(x);
  }
}

/// Arrows on plateaus: every pixel without a lower neighbour flows towards the plateau's lower border, one
/// level of distance after the other. Plateaus without lower border are left without arrows.
void cross_plateaus(Arrows& arrows, const Heights& heights, Size size, const Exec& exec) {
  Image<std::int32_t> queue_image(heights.size(), exec.pool);
  std::int32_t* const queue = queue_image.row(0);
  std::int32_t* last = queue;
  const std::ptrdiff_t stride = heights.width();
  const std::uint16_t* const height = heights.row(0);
  std::uint8_t* const arrow = arrows.row(0);

  // Distance 1: beside a pixel of the same height that flows downhill (its arrow has no kAcross).
  const std::array<std::ptrdiff_t, 4> steps{-stride, -1, 1, stride};
  for (int y = 0; y < size.height; ++y) {
    const std::ptrdiff_t start = index_of(0, y, stride);
    for_each_nowhere(arrow + start, size.width, [&](int x) {
      const std::ptrdiff_t p = start + x;
      for (std::uint8_t k = 0; k < 4; ++k) {
        const std::ptrdiff_t q = p + steps[k];
        if (height[q] == height[p] && arrow[q] >= kUp && arrow[q] <= kDown) {
          arrow[p] = static_cast<std::uint8_t>((k + 1) | kAcross);
          *last++ = static_cast<std::int32_t>(p);
          return;
        }
      }
    });
  }

  // Distance n+1 from distance n. Ties: a pixel may be reached from several sides, and "up" must win. So the
  // whole level first claims the pixels below (for them it is "up"), then those to the right, to the left,
  // and above.
  struct Claim {
    std::ptrdiff_t step;
    std::uint8_t arrow;
  };
  const std::array<Claim, 4> claims{Claim{stride, kUp}, Claim{1, kLeft}, Claim{-1, kRight},
                                    Claim{-stride, kDown}};
  for (const std::int32_t* first = queue; first != last;) {
    const std::int32_t* const level_end = last;
    for (const Claim& claim : claims) {
      for (const std::int32_t* p = first; p != level_end; ++p) {
        const std::ptrdiff_t q = *p + claim.step;
        if (arrow[q] == kNowhere && height[q] == height[*p]) {
          arrow[q] = claim.arrow | kAcross;
          *last++ = static_cast<std::int32_t>(q);
        }
      }
    }
    first = level_end;
  }
}

/// Gives a whole basin floor its label: pixels without arrow that touch have the same height.
void flood_basin(std::ptrdiff_t start, std::int32_t id, const std::uint8_t* arrow, std::int32_t* label,
                 std::ptrdiff_t stride, std::int32_t* stack) {
  std::int32_t* top = stack;
  label[start] = id;
  *top++ = static_cast<std::int32_t>(start);
  while (top != stack) {
    const std::ptrdiff_t p = *--top;
    for (const std::ptrdiff_t q : {p - stride, p - 1, p + 1, p + stride}) {
      if (arrow[q] == kNowhere && label[q] < 0) {
        label[q] = id;
        *top++ = static_cast<std::int32_t>(q);
      }
    }
  }
}

}  // namespace

Basins watershed(View<const std::uint16_t> gradient, const Exec& exec) {
  const Size size = gradient.size();
  const Heights heights = with_frame(gradient, exec);
  Arrows arrows = downhill(heights, size, exec);
  cross_plateaus(arrows, heights, size, exec);

  const std::ptrdiff_t stride = heights.width();
  Image<std::int32_t> labels(heights.size(), -1, exec.pool);
  Image<std::int32_t> stack(heights.size(), exec.pool);
  const std::uint8_t* const arrow = arrows.row(0);
  std::int32_t* const label = labels.row(0);
  const std::array<std::ptrdiff_t, 8> step{0, -stride, -1, 1, stride, 0, 0, 0};

  // In raster order, so that basins are numbered by their first pixel: follow the arrows to a pixel that has
  // its label, then go the same way again and hand the label to every pixel on it. No pixel is walked through
  // more than twice.
  Basins basins{Image<RegionId>(size, exec.pool), 0};
  for (int y = 0; y < size.height; ++y) {
    const std::ptrdiff_t start = index_of(0, y, stride);
    for (std::ptrdiff_t p = start; p < start + size.width; ++p) {
      if (label[p] >= 0) continue;
      std::ptrdiff_t q = p;
      while (label[q] < 0 && arrow[q] != kNowhere) q += step[arrow[q] & kDirection];
      if (label[q] < 0) flood_basin(q, basins.count++, arrow, label, stride, stack.row(0));
      const std::int32_t id = label[q];
      for (q = p; label[q] < 0; q += step[arrow[q] & kDirection]) label[q] = id;
    }
    // Nothing changes a label once given, and every pixel up to here has its own.
    std::memcpy(basins.labels.row(y), label + start, static_cast<std::size_t>(size.width) * sizeof(RegionId));
  }
  return basins;
}

}  // namespace cairn
