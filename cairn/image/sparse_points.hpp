// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/core/geometry.hpp>
#include <cairn/core/image.hpp>
#include <optional>
#include <vector>

/// Textured points and their subpixel matches in a second image. Internal to the library.
namespace cairn::sparse {

inline constexpr int kBlock = 4;            // side of the blocks over which gradients are summed
inline constexpr int kWindow = 2 * kBlock;  // side of the window of a point
inline constexpr int kWindowArea = kWindow * kWindow;

/// Cubic weights of four pixels for a position 0 ≤ t < 1 between the second and the third (Keys 1981).
std::array<float, 4> cubic(float t);

/// The image at half width and height, rounded down. Each output pixel weights the four nearest rows, and
/// columns, by 1 3 3 1: finer detail would alias and bias sub-pixel positions.
Image<Gray> halved(View<const Gray> image, const Exec& exec);

/// For each patch of the image, the top left corner of the window with the most texture in its weaker
/// direction (Shi & Tomasi 1994), if above a threshold; in raster order, at most `most` points, spread over
/// the image. Each window is at least one pixel away from the border.
std::vector<Point> textured_points(View<const Gray> image, std::size_t most, const Exec& exec);

/// The position of the top left pixel of a window.
struct Place {
  float x = 0;
  float y = 0;
};

/// The position in `right` of the window of `left` whose top left pixel is `p`: the minimum of the squared
/// difference near `start`, by Newton steps (Lucas & Kanade 1981; Baker & Matthews 2004); nullopt if they
/// diverge, or end at a dissimilar place. The window must be at least one pixel away from the border of
/// `left`.
std::optional<Place> refine(View<const Gray> left, Point p, View<const Gray> right, Place start);

}  // namespace cairn::sparse
