// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/geometry.hpp>
#include <cairn/core/image.hpp>
#include <string_view>

/// Lines, areas and text on colour images, anti-aliased. Everything is clipped at the border of the image. Internal to
/// output.
namespace cairn::output::drawing {

struct Point {
  int x = 0;
  int y = 0;
};

void fill(Image<Rgb>& canvas, Rect area, Rgb colour);
/// One pixel wide.
void draw_line(Image<Rgb>& canvas, Point from, Point to, Rgb colour);

struct TextExtent {
  int width = 0;
  int above = 0;  // px above the baseline
  int below = 0;
};
/// `height`: of a capital letter, px.
TextExtent text_extent(std::string_view text, float height);
/// Text with a black outline; its baseline begins at `at`. Characters other than printable ASCII become boxes.
void draw_text(Image<Rgb>& canvas, std::string_view text, Point at, float height, Rgb colour);

/// The image at `factor` times its size, by bicubic interpolation (Keys 1981).
Image<Rgb> enlarged(const Image<Rgb>& image, int factor);

}  // namespace cairn::output::drawing
