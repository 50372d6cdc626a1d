// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/geometry.hpp>
#include <cairn/core/image.hpp>
#include <cairn/objects/obstacles.hpp>
#include <cairn/stereo/reject.hpp>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

/// Reading and writing of images. Read: PNG, JPEG, PGM/PPM (P2, P3, P5, P6); 8 or 16 bits; grey or
/// colour; by content, not by extension. Every function throws Error with one line that names the file:
/// missing, a folder, empty, not an image, truncated or damaged, a side outside 1 … 32768 px or more than
/// 2^28 px (checked before allocation).
namespace cairn::io {

/// An image as the core needs it: 8 bits.
struct LoadedImage {
  Image<Gray> gray;  // (77 R + 150 G + 29 B + 128) >> 8
  Image<Rgb> rgb;    // empty if the file is grey
};

struct LoadedPair {
  LoadedImage left;
  LoadedImage right;
  int bits = 8;  // needed by the brighter image
};

/// Reads an image. With more than 8 bits, low bits are dropped: v >> (bits − 8), where `bits` is the depth of
/// the brightest sample (PGM and PPM declare it in their header). So 10, 12 and 16 bit cameras keep their
/// full contrast, whether their bits are at the low or the high end, and 8-bit data in 16-bit files is
/// unchanged. Alpha and the orientation tag of JPEG are ignored: calibrations refer to stored pixels.
LoadedImage load_picture(const std::filesystem::path& path, const Pool& pool = {});

/// Both images, reduced by the same shift (that of the brighter one), so that a difference in exposure is
/// kept. Deep images that need less than `least_bits` are reduced as if they needed those, so that the frames
/// of a sequence have one scale. Also throws Error if sizes differ, or only one has 8 bits.
LoadedPair load_pair(const std::filesystem::path& left, const std::filesystem::path& right,
                     const Pool& pool = {}, int least_bits = 8);

/// The arrangement of the two images of a pair in one image.
enum class Layout : std::uint8_t {
  one,           // there is only one
  side_by_side,  // left and right half
  top_bottom,
};
/// Throws Error for other names. Empty: side_by_side.
Layout layout_of(std::string_view name);
/// Where the left and the right image are. Throws Error (without a file name) if the side to be halved is odd.
std::array<Rect, 2> halves_of(Size both, Layout layout);

/// The same for two images in one file, `left`; with Layout::one, in two.
LoadedPair load_pair(const std::filesystem::path& left, const std::filesystem::path& right, Layout layout,
                     const Pool& pool = {}, int least_bits = 8);

/// The grey of colours, (77 R + 150 G + 29 B + 128) >> 8.
Image<Gray> grey_of(View<const Rgb> colours, const Pool& pool = {});

/// The image with factor × factor pixels in one (cairn::binned()); the grey is that of the binned colours, if there are any.
LoadedImage binned(const LoadedImage& image, int factor, const Pool& pool = {});

/// Integers per pixel as stored in the file: ids, masks.
struct Labels {
  Image<std::uint16_t> ids;
  int bits = 8;  // 8 or 16, the depth of the file; 255 may mean "don't care" in an 8-bit one
};

/// The values of a one-channel file, never scaled. A PNG with a palette gives the indices. Colour is refused.
Labels load_labels(const std::filesystem::path& path, const Pool& pool = {});

/// Writes a PNG atomically: grey of 8 or 16 bits, colour, or the bit set of reasons as 16-bit grey.
void save_png(const std::filesystem::path& path, View<const std::uint8_t> image);
void save_png(const std::filesystem::path& path, View<const std::uint16_t> image);
void save_png(const std::filesystem::path& path, View<const Rgb> image);
void save_png(const std::filesystem::path& path, View<const Reject> image);
void save_png(const std::filesystem::path& path, View<const ObstacleLabel> image);

/// The bytes of a PNG file of `image`. Throws Error if that is empty.
std::string png_bytes(View<const Rgb> image);

}  // namespace cairn::io
