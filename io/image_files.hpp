// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cairn/disparity/reject.hpp>
#include <cairn/objects/space.hpp>
#include <cstdint>
#include <filesystem>
#include <string>

/// Pictures in and out. Read: PNG, JPEG, PGM/PPM (P2, P3, P5, P6), TIFF; 8 or 16 bits; grey or colour; by
/// content, not by extension. Every function throws Error with one line that names the file: missing, a
/// folder, empty, no picture, truncated or damaged, a side outside 1 … 32768 px or more than 2^28 px (checked
/// before anything is allocated).
namespace cairn::io {

/// One picture as the core wants it: 8 bits.
struct Picture {
  Image<Gray> gray;  // (77 R + 150 G + 29 B + 128) >> 8
  Image<Rgb> rgb;    // empty where the file is grey
};

struct PicturePair {
  Picture left;
  Picture right;
  int bits = 8;  // that the brighter one needed
};

/// A picture of more than 8 bits loses its low bits: v >> (bits − 8), where `bits` is what the brightest
/// sample needs (a PGM or PPM says it itself in its header). So 10, 12 and 16 bit cameras are all seen at
/// their full contrast, whether their bits stand at the low or the high end, and 8-bit data in 16-bit files
/// come out as they were. Alpha is ignored, and so is a JPEG's orientation mark: calibrations count pixels as
/// they are stored.
Picture load_picture(const std::filesystem::path& path, const Pool& pool = {});

/// Both pictures reduced by the same shift (the one that the brighter needs), so that a difference of
/// exposure between them stays what it was. Deep pictures that need less than `least_bits` are reduced as if
/// they needed those: the frames of a sequence keep one scale with it. Throws Error as well where sizes
/// differ, or one has 8 bits and the other more.
PicturePair load_pair(const std::filesystem::path& left, const std::filesystem::path& right,
                      const Pool& pool = {}, int least_bits = 8);

/// The grey of colours, (77 R + 150 G + 29 B + 128) >> 8.
Image<Gray> grey_of(View<const Rgb> colours, const Pool& pool = {});

/// Numbers per pixel as they stand in the file: ids, masks.
struct Labels {
  Image<std::uint16_t> ids;
  int bits = 8;  // 8 or 16, the depth of the file; 255 may mean "don't care" in an 8-bit one
};

/// A one-channel file's values, never scaled. A PNG with a palette gives the indices. Colour is refused.
Labels load_labels(const std::filesystem::path& path, const Pool& pool = {});

/// Writes a PNG atomically: grey of 8 or 16 bits, colour, or the bit set of reasons as 16-bit grey.
void save_png(const std::filesystem::path& path, View<const std::uint8_t> image);
void save_png(const std::filesystem::path& path, View<const std::uint16_t> image);
void save_png(const std::filesystem::path& path, View<const Rgb> image);
void save_png(const std::filesystem::path& path, View<const Reject> image);
void save_png(const std::filesystem::path& path, View<const Space> image);

/// The bytes of a PNG file that shows `image`. Throws Error where that is empty.
std::string png_bytes(View<const Rgb> image);

}  // namespace cairn::io
