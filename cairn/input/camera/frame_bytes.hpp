// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/geometry.hpp>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <cairn/io/image_files.hpp>

/// Images in the memory layout of cameras, and their conversion. Internal to source.
namespace cairn::input {

/// One channel: the sample of pixel (x, y) is at data[(y >> shift_y) * row + (x >> shift_x) * step].
struct Samples {
  const std::uint8_t* data = nullptr;
  std::ptrdiff_t row = 0;
  std::ptrdiff_t step = 1;
  int shift_x = 0;  // 1: two neighbours share a sample
  int shift_y = 0;
};

/// The conversion of luminance and chrominance to RGB.
enum class YuvCoding : std::uint8_t { bt601, bt601_full, bt709, bt709_full };

/// A borrowed image: grey, luminance with chrominance, or red, green and blue.
struct FrameBytes {
  Size size;
  enum class Kind : std::uint8_t { grey, yuv, rgb } kind = Kind::grey;
  Samples first;   // grey, luminance or red
  Samples second;  // U or green
  Samples third;   // V or blue
  YuvCoding coding = YuvCoding::bt601;
};

// The pixel formats of cameras; `stride`: bytes between rows.
FrameBytes grey_bytes(Size size, const std::uint8_t* data, std::ptrdiff_t stride);
FrameBytes yuyv_bytes(Size size, const std::uint8_t* data, std::ptrdiff_t stride, YuvCoding coding);
/// `step`: bytes between pixels; red, green and blue are at these offsets.
FrameBytes rgb_bytes(Size size, const std::uint8_t* data, std::ptrdiff_t stride, int step, int red, int green,
                     int blue);

using io::Layout;
using io::layout_of;

struct TwoFrames {
  FrameBytes left;
  FrameBytes right;
};
/// Both halves. Throws Error (without the name of a source) if a side is odd.
TwoFrames halves_of(const FrameBytes& bytes, Layout layout);

/// Grey: the unchanged grey or luminance samples, of colours as in grey_of(). With colour if `with_colour`
/// and the frame has any.
io::LoadedImage picture_of(const FrameBytes& bytes, bool with_colour, const Pool& pool);

}  // namespace cairn::input
