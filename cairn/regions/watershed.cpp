// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/regions/scratch.hpp>
#include <cairn/regions/watershed.hpp>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows

// Where a pixel flows to. The numbers are the order in which ties are decided. As wide as heights, so that
// the loops over both become vector code.
using Arrow = std::uint16_t;
constexpr Arrow kNowhere = 0;  // lowest around: a basin's floor, or a plateau pixel not reached yet
constexpr Arrow kUp = 1;
constexpr Arrow kLeft = 2;
constexpr Arrow kRight = 3;
constexpr Arrow kDown = 4;
constexpr Arrow kDirection = 7;  // mask of the direction
constexpr Arrow kBeside = 8;     // flows across its plateau to a pixel that flows downhill: distance 1
constexpr Arrow kDeep = 16;      // the same, from further away
constexpr Arrow kFloor = 32;     // part of a basin's floor that has been dealt with
constexpr Arrow kOutside = 64;   // frame around the image: neither flows nor is flown to

using Heights = Image<std::uint16_t>;
using Arrows = Image<Arrow>;

/// All working images have this size: a frame one pixel wide around the image, so that no neighbour needs a
/// bounds check, and a width at which images of every pixel type have the same stride, so that one index
/// serves them all.
Size framed(Size size) {
  return {(size.width + 2 + 63) / 64 * 64, size.height + 2};
}

/// Calls row(y) for the rows of the image, numbered as in the framed images: 1 … height.
template <class Row>
void for_each_row(Size size, const Exec& exec, Row row) {
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    for (int y = first + 1; y <= last; ++y) row(y);
  });
}

template <class T>
Image<T> with_frame(Size size, T frame, const Exec& exec) {
  Image<T> image(framed(size), exec.pool);
  std::fill_n(image.row(0), image.width(), frame);
  std::fill_n(image.row(size.height + 1), image.width(), frame);
  for (int y = 1; y <= size.height; ++y) {
    image(0, y) = frame;
    std::fill(image.row(y) + 1 + size.width, image.row(y) + image.width(), frame);
  }
  return image;
}

Heights heights_of(View<const std::uint16_t> gradient, const Exec& exec) {
  Heights heights =
      with_frame<std::uint16_t>(gradient.size(), UINT16_MAX, exec);  // nothing is higher: no way out
  for_each_row(gradient.size(), exec,
               [&](int y) { std::copy_n(gradient.row(y - 1), gradient.width(), heights.row(y) + 1); });
  return heights;
}

/// Arrows to the lowest neighbour, where that is lower.
Arrows flow_downhill(const Heights& heights, Size size, const Exec& exec) {
  Arrows arrows = with_frame(size, kOutside, exec);
  for_each_row(size, exec, [&](int y) {
    const std::uint16_t* const here = heights.row(y) + 1;
    const std::uint16_t* const up = heights.row(y - 1) + 1;
    const std::uint16_t* const down = heights.row(y + 1) + 1;
    Arrow* const out = arrows.row(y) + 1;
    for (int x = 0; x < size.width; ++x) {
      const std::uint16_t lowest = std::min(std::min(up[x], here[x - 1]), std::min(here[x + 1], down[x]));
      Arrow arrow = kDown;
      arrow = here[x + 1] == lowest ? kRight : arrow;
      arrow = here[x - 1] == lowest ? kLeft : arrow;
      arrow = up[x] == lowest ? kUp : arrow;
      out[x] = lowest < here[x] ? arrow : kNowhere;
    }
  });
  return arrows;
}

/// Adds the arrows of plateau pixels at distance 1: beside a pixel of the same height that flows downhill.
Arrows flow_beside(const Arrows& downhill, const Heights& heights, Size size, const Exec& exec) {
  Arrows arrows = with_frame(size, kOutside, exec);
  for_each_row(size, exec, [&](int y) {
    const std::uint16_t* const here = heights.row(y) + 1;
    const std::uint16_t* const up = heights.row(y - 1) + 1;
    const std::uint16_t* const down = heights.row(y + 1) + 1;
    const Arrow* const arrow = downhill.row(y) + 1;
    const Arrow* const arrow_up = downhill.row(y - 1) + 1;
    const Arrow* const arrow_down = downhill.row(y + 1) + 1;
    Arrow* const out = arrows.row(y) + 1;
    // A neighbour with the flag kOutside has the height UINT16_MAX, as a hole may have: so it must be asked
    // for an arrow.
    const auto flows = [](Arrow a) { return static_cast<Arrow>(a - 1) < kDown; };
    for (int x = 0; x < size.width; ++x) {
      Arrow to = kNowhere;
      to = (down[x] == here[x]) & flows(arrow_down[x]) ? kBeside | kDown : to;
      to = (here[x + 1] == here[x]) & flows(arrow[x + 1]) ? kBeside | kRight : to;
      to = (here[x - 1] == here[x]) & flows(arrow[x - 1]) ? kBeside | kLeft : to;
      to = (up[x] == here[x]) & flows(arrow_up[x]) ? kBeside | kUp : to;
      out[x] = arrow[x] != kNowhere ? arrow[x] : to;
    }
  });
  return arrows;
}

/// The pixels that have no arrow yet but a neighbour of the same height: the inner parts of plateaus.
ScratchList<std::int32_t> inner_plateaus(const Arrows& arrows, const Heights& heights, Size size,
                                         const Exec& exec) {
  const std::ptrdiff_t stride = heights.width();
  const std::uint16_t* const height = heights.row(0);
  ScratchList<std::int32_t> inner(static_cast<std::size_t>(size.area()), exec.pool);
  std::vector<std::int32_t> nowhere(static_cast<std::size_t>(size.width));
  for (int y = 1; y <= size.height; ++y) {
    const Arrow* const arrow = arrows.row(y) + 1;
    const auto start = static_cast<std::int32_t>(y * stride + 1);
    // Both loops without a branch: what they look for comes irregularly.
    std::size_t found = 0;
    for (int x = 0; x < size.width; ++x) {
      nowhere[found] = start + x;
      found += arrow[x] == kNowhere ? 1 : 0;
    }
    std::int32_t* const room = inner.room_for(found);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < found; ++i) {
      const std::uint16_t* const p = height + nowhere[i];
      const bool has_equal = (p[-stride] == *p) | (p[-1] == *p) | (p[1] == *p) | (p[stride] == *p);
      room[kept] = nowhere[i];
      kept += has_equal ? 1 : 0;
    }
    inner.grown(kept);
  }
  return inner;
}

/// Arrows of plateau pixels from distance 2 on, one level of distance after the other. Plateaus without lower
/// border are left without arrows.
void flow_across(const ScratchList<std::int32_t>& inner, Arrows& arrows, const Heights& heights,
                 const Exec& exec) {
  const std::ptrdiff_t stride = heights.width();
  const std::uint16_t* const height = heights.row(0);
  Arrow* const arrow = arrows.row(0);
  Scratch<std::int32_t> queue(inner.size(), exec.pool);
  std::int32_t* last = queue.begin();

  const std::array<std::ptrdiff_t, 4> steps{-stride, -1, 1, stride};
  for (const std::int32_t p : inner) {
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const std::ptrdiff_t q = p + steps[k];
      if (height[q] != height[p] || (arrow[q] & kBeside) == 0) continue;
      arrow[p] = static_cast<Arrow>((k + 1) | kDeep);
      *last++ = p;
      break;
    }
  }

  // Distance n+1 from distance n. Ties: a pixel may be reached from several sides, and "up" must win. So the
  // whole level first claims the pixels below (for them it is "up"), then those to the right, to the left,
  // and above.
  struct Claim {
    std::ptrdiff_t step;
    Arrow arrow;
  };
  const std::array<Claim, 4> claims{Claim{stride, kUp | kDeep}, Claim{1, kLeft | kDeep},
                                    Claim{-1, kRight | kDeep}, Claim{-stride, kDown | kDeep}};
  for (const std::int32_t* first = queue.begin(); first != last;) {
    const std::int32_t* const level_end = last;
    for (const Claim& claim : claims) {
      for (const std::int32_t* p = first; p != level_end; ++p) {
        const std::ptrdiff_t q = *p + claim.step;
        if (arrow[q] != kNowhere || height[q] != height[*p]) continue;
        arrow[q] = claim.arrow;
        *last++ = static_cast<std::int32_t>(q);
      }
    }
    first = level_end;
  }
}

/// For each pixel the index of the pixel that it flows to; its own on a basin's floor.
Image<std::int32_t> targets_of(const Arrows& arrows, Size size, const Exec& exec) {
  Image<std::int32_t> targets(arrows.size(), exec.pool);
  const auto stride = static_cast<std::int32_t>(arrows.width());
  const std::array<std::int32_t, kDirection + 1> steps{0, -stride, -1, 1, stride, 0, 0, 0};
  for_each_row(size, exec, [&](int y) {
    const Arrow* const arrow = arrows.row(y) + 1;
    std::int32_t* const target = targets.row(y) + 1;
    for (int x = 0; x < size.width; ++x) {
      target[x] = y * stride + 1 + x + steps[arrow[x] & kDirection];
    }
  });
  return targets;
}

/// Basin floors of several pixels: leads all of them to one.
void join_floors(ScratchList<std::int32_t>& inner, Arrows& arrows, Image<std::int32_t>& targets,
                 const Exec& exec) {
  const std::ptrdiff_t stride = arrows.width();
  Arrow* const arrow = arrows.row(0);
  std::int32_t* const target = targets.row(0);
  Scratch<std::int32_t> stack(inner.size(), exec.pool);
  for (const std::int32_t start : inner) {
    if (arrow[start] != kNowhere) continue;
    std::int32_t* top = stack.begin();
    const auto reach = [&](std::ptrdiff_t p) {
      arrow[p] = kFloor;
      target[p] = start;
      *top++ = static_cast<std::int32_t>(p);
    };
    reach(start);
    while (top != stack.begin()) {
      const std::ptrdiff_t p = *--top;
      // Pixels without arrow that touch have the same height: the higher one would flow.
      for (const std::ptrdiff_t q : {p - stride, p - 1, p + 1, p + stride}) {
        if (arrow[q] == kNowhere) reach(q);
      }
    }
  }
}

/// Leads every pixel to the end of its way: to a pixel that is its own target. Sweeps to and fro, since a
/// sweep follows a way in its own direction to the end, and at least halves what is left of any other.
void follow_targets(Image<std::int32_t>& targets, Size size) {
  std::int32_t* const target = targets.row(0);
  const std::ptrdiff_t stride = targets.width();
  const auto advance = [&](std::ptrdiff_t p) {
    const std::int32_t before = target[p];
    target[p] = target[before];
    return before ^ target[p];
  };
  for (std::int32_t moved = 1; moved != 0;) {
    moved = 0;
    for (std::ptrdiff_t y = 1; y <= size.height; ++y) {
      for (std::ptrdiff_t p = y * stride + 1; p <= y * stride + size.width; ++p) moved |= advance(p);
    }
    if (moved == 0) break;
    moved = 0;
    for (std::ptrdiff_t y = size.height; y >= 1; --y) {
      for (std::ptrdiff_t p = y * stride + size.width; p > y * stride; --p) moved |= advance(p);
    }
  }
}

/// Numbers the ends of the ways in raster order of the first pixel that leads there.
Basins numbered(const Image<std::int32_t>& targets, Size size, const Exec& exec) {
  Basins basins{Image<RegionId>(size, exec.pool), 0};
  Image<std::int32_t> ids(targets.size(), -1, exec.pool);
  std::int32_t* const id = ids.row(0);
  for (int y = 0; y < size.height; ++y) {
    const std::int32_t* const target = targets.row(y + 1) + 1;
    RegionId* const label = basins.labels.row(y);
    for (int x = 0; x < size.width; ++x) {
      std::int32_t& known = id[target[x]];
      if (known < 0) known = basins.count++;
      label[x] = RegionId{known};
    }
  }
  return basins;
}

}  // namespace

Basins watershed(View<const std::uint16_t> gradient, const Exec& exec) {
  const Size size = gradient.size();
  const Heights heights = heights_of(gradient, exec);
  Arrows arrows = flow_beside(flow_downhill(heights, size, exec), heights, size, exec);
  ScratchList<std::int32_t> inner = inner_plateaus(arrows, heights, size, exec);
  flow_across(inner, arrows, heights, exec);
  Image<std::int32_t> targets = targets_of(arrows, size, exec);
  join_floors(inner, arrows, targets, exec);
  follow_targets(targets, size);
  return numbered(targets, size, exec);
}

}  // namespace cairn
