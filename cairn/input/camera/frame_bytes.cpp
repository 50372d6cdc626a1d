// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/camera/frame_bytes.hpp>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cstring>
#include <string>

namespace cairn::input {
namespace {

const std::uint8_t* row_of(const Samples& samples, int y) {
  return samples.data + (y >> samples.shift_y) * samples.row;
}

template <std::ptrdiff_t kStep>
void copy_row(const std::uint8_t* from, Gray* to, int width) {
  for (int x = 0; x < width; ++x) to[x] = from[x * kStep];
}

Image<Gray> copied(Size size, const Samples& samples, const Pool& pool) {
  Image<Gray> gray(size, pool);
  for (int y = 0; y < size.height; ++y) {
    const std::uint8_t* from = row_of(samples, y);
    Gray* to = gray.row(y);
    if (samples.step == 1) {
      std::memcpy(to, from, static_cast<std::size_t>(size.width));
    } else if (samples.step == 2) {
      copy_row<2>(from, to, size.width);
    } else {
      for (int x = 0; x < size.width; ++x) to[x] = from[x * samples.step];
    }
  }
  return gray;
}

/// Scale factors of luminance and of the colour differences, in 1/256.
struct Weights {
  int black;
  int luminance;
  int red_of_v;
  int green_of_u;
  int green_of_v;
  int blue_of_u;
};
Weights weights_of(YuvCoding coding) {
  switch (coding) {
    case YuvCoding::bt601:
      return {16, 298, 409, 100, 208, 516};
    case YuvCoding::bt601_full:
      return {0, 256, 359, 88, 183, 454};
    case YuvCoding::bt709:
      return {16, 298, 459, 55, 136, 541};
    case YuvCoding::bt709_full:
      return {0, 256, 403, 48, 120, 475};
  }
  return {};
}

std::uint8_t clamped(int value) {
  return static_cast<std::uint8_t>(std::clamp(value >> 8, 0, 255));
}

/// Converts a row; colour differences are computed once for 1 << kShift pixels.
template <int kStep, int kShift>
void colour_row(const FrameBytes& bytes, int y, const Weights& weights, Rgb* to) {
  constexpr int kShared = 1 << kShift;
  const std::uint8_t* luminance = row_of(bytes.first, y);
  const std::uint8_t* u_at = row_of(bytes.second, y);
  const std::uint8_t* v_at = row_of(bytes.third, y);
  const std::ptrdiff_t u_step = bytes.second.step;
  const std::ptrdiff_t v_step = bytes.third.step;
  const std::ptrdiff_t step = kStep > 0 ? kStep : bytes.first.step;
  const int width = bytes.size.width;
  for (int x = 0; x < width; x += kShared, u_at += u_step, v_at += v_step) {
    const int u = *u_at - 128;
    const int v = *v_at - 128;
    const int red = weights.red_of_v * v + 128;
    const int green = -weights.green_of_u * u - weights.green_of_v * v + 128;
    const int blue = weights.blue_of_u * u + 128;
    for (int i = x; i < std::min(x + kShared, width); ++i) {
      const int light = weights.luminance * (luminance[i * step] - weights.black);
      to[i] = {clamped(light + red), clamped(light + green), clamped(light + blue)};
    }
  }
}

Image<Rgb> colours_of_yuv(const FrameBytes& bytes, const Pool& pool) {
  const Weights weights = weights_of(bytes.coding);
  const auto row = [&] {
    if (bytes.second.shift_x == 0) return colour_row<0, 0>;
    if (bytes.first.step == 1) return colour_row<1, 1>;
    if (bytes.first.step == 2) return colour_row<2, 1>;
    return colour_row<0, 1>;
  }();
  Image<Rgb> rgb(bytes.size, pool);
  for (int y = 0; y < bytes.size.height; ++y) row(bytes, y, weights, rgb.row(y));
  return rgb;
}

Image<Rgb> colours_of_rgb(const FrameBytes& bytes, const Pool& pool) {
  Image<Rgb> rgb(bytes.size, pool);
  const std::ptrdiff_t step = bytes.first.step;
  for (int y = 0; y < bytes.size.height; ++y) {
    const std::uint8_t* red = row_of(bytes.first, y);
    const std::uint8_t* green = row_of(bytes.second, y);
    const std::uint8_t* blue = row_of(bytes.third, y);
    Rgb* to = rgb.row(y);
    for (int x = 0; x < bytes.size.width; ++x) to[x] = {red[x * step], green[x * step], blue[x * step]};
  }
  return rgb;
}

Samples moved(Samples samples, int x, int y) {
  if (samples.data != nullptr)
    samples.data += (y >> samples.shift_y) * samples.row + (x >> samples.shift_x) * samples.step;
  return samples;
}

FrameBytes part_of(const FrameBytes& bytes, int x, int y, Size size) {
  FrameBytes part = bytes;
  part.size = size;
  part.first = moved(bytes.first, x, y);
  part.second = moved(bytes.second, x, y);
  part.third = moved(bytes.third, x, y);
  return part;
}

}  // namespace

FrameBytes grey_bytes(Size size, const std::uint8_t* data, std::ptrdiff_t stride) {
  return {size, FrameBytes::Kind::grey, {data, stride}, {}, {}, {}};
}

FrameBytes yuyv_bytes(Size size, const std::uint8_t* data, std::ptrdiff_t stride, YuvCoding coding) {
  return {size,  FrameBytes::Kind::yuv, {data, stride, 2}, {data + 1, stride, 4, 1}, {data + 3, stride, 4, 1},
          coding};
}

FrameBytes rgb_bytes(Size size, const std::uint8_t* data, std::ptrdiff_t stride, int step, int red, int green,
                     int blue) {
  return {size,
          FrameBytes::Kind::rgb,
          {data + red, stride, step},
          {data + green, stride, step},
          {data + blue, stride, step},
          {}};
}

TwoFrames halves_of(const FrameBytes& bytes, Layout layout) {
  const bool side_by_side = layout == Layout::side_by_side;
  // Halves must not share colour differences.
  const int parts = 2 << (side_by_side ? bytes.second.shift_x : bytes.second.shift_y);
  const int length = side_by_side ? bytes.size.width : bytes.size.height;
  if (length < parts || length % parts != 0) {
    throw Error("is " + text(bytes.size) + ", expected a " + (side_by_side ? "width" : "height") +
                " that is a multiple of " + std::to_string(parts) + " for two images " +
                (side_by_side ? "side by side" : "one above the other"));
  }
  const auto part = [&](const Rect& place) {
    return part_of(bytes, place.x, place.y, {place.width, place.height});
  };
  const auto halves = io::halves_of(bytes.size, layout);
  return {part(halves[0]), part(halves[1])};
}

io::LoadedImage picture_of(const FrameBytes& bytes, bool with_colour, const Pool& pool) {
  io::LoadedImage picture;
  if (bytes.kind == FrameBytes::Kind::rgb) {
    picture.rgb = colours_of_rgb(bytes, pool);
    picture.gray = io::grey_of(picture.rgb.view(), pool);
    if (!with_colour) picture.rgb = {};
    return picture;
  }
  picture.gray = copied(bytes.size, bytes.first, pool);
  if (with_colour && bytes.kind == FrameBytes::Kind::yuv) picture.rgb = colours_of_yuv(bytes, pool);
  return picture;
}

}  // namespace cairn::input
