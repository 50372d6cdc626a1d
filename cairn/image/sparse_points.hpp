// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/core/geometry.hpp>
#include <cairn/core/image.hpp>
#include <optional>
#include <vector>

/// Points with much texture and where another image shows them, between its pixels. Internal to the library.
namespace cairn::sparse {

inline constexpr int kBlock = 4;            // side of the blocks that gradients are summed over
inline constexpr int kWindow = 2 * kBlock;  // side of a point's window
inline constexpr int kWindowArea = kWindow * kWindow;

/// The weights of the four pixels around a place at 0 ≤ t < 1 between the second and the third (Keys 1981).
std::array<float, 4> cubic(float t);

/// Half as wide and high, rounded down. Each pixel stands between four and weighs the rows around it, and the
/// columns, one, three, three, one: what is too fine for half the pixels would pull sub-pixel positions.
Image<Gray> halved(View<const Gray> image, const Exec& exec);

/// Of each patch of the image the corner of the window that has most texture in its weaker direction (Shi &
/// Tomasi 1994), if it is enough; raster order, at most `most` of them, all over the image. At least a pixel
/// lies around each window.
std::vector<Point> textured_points(View<const Gray> image, std::size_t most, const Exec& exec);

/// Where a window's top left pixel comes to lie.
struct Place {
  float x = 0;
  float y = 0;
};

/// Where `right` shows the window of `left` whose top left pixel is `p`: the least squared difference near
/// `start`, by Newton's steps (Lucas & Kanade 1981; Baker & Matthews 2004); nullopt where they lead away, or
/// to what looks different. At least a pixel of `left` must lie around the window.
std::optional<Place> refine(View<const Gray> left, Point p, View<const Gray> right, Place start);

}  // namespace cairn::sparse
