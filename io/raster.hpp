// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/geometry.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "image_files.hpp"

/// Decoded pictures as they stand in the file; internal to io. What becomes of them is decided by image_files
/// and disparity_files.
namespace cairn::io {

inline constexpr int kMostPixelsPerSide = 32768;
inline constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;

/// Throws Error (without a file's name) unless both sides are in 1 … kMostPixelsPerSide and the area ≤
/// kMostPixels.
void check_sides(std::int64_t width, std::int64_t height);

/// Samples, rows top-down without padding, channels interleaved (grey or R, G, B), in this machine's byte
/// order.
struct Raster {
  Size size;
  int channels = 1;      // 1 or 3
  int bytes_each = 1;    // per sample: 1 or 2
  int max_value = 255;   // full scale as the file's header declares it
  bool declared = true;  // false: a 16-bit container whose real depth only the values tell
  std::vector<std::uint8_t> bytes;

  template <class T>
  [[nodiscard]] const T* row(int y) const {
    const auto step = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(channels) * sizeof(T);
    return reinterpret_cast<const T*>(bytes.data() + static_cast<std::size_t>(y) * step);
  }
  /// Samples per row.
  [[nodiscard]] int row_length() const { return size.width * channels; }
};

/// What a palette's indices are: colours, or the numbers themselves.
enum class Palette : std::uint8_t { colours, indices };

/// Reads and decodes a file by its content. Throws Error that names `path`; never prints, never half-decodes.
Raster read_raster(const std::filesystem::path& path, Palette palette);
/// The same of a file's bytes; throws Error without a file's name.
Raster decode_raster(std::string_view file, Palette palette);

/// Both reduced to 8 bits as load_pair() does it. Throws Error, without files' names, where sizes or depths
/// differ.
PicturePair pair_of(const Raster& left, const Raster& right, const Pool& pool, int least_bits = 8);

// One per form; they throw Error without a file's name.
Raster decode_png(std::string_view file, Palette palette);
Raster decode_jpeg(std::string_view file);
Raster decode_tiff(std::string_view file, Palette palette);
Raster decode_pnm(std::string_view file);

/// Rows of samples to be encoded: grey of 8 or 16 bits, or RGB of 8.
struct PixelRows {
  Size size;
  int channels = 1;
  int bytes_each = 1;
  const std::uint8_t* first = nullptr;
  std::ptrdiff_t stride_bytes = 0;
};
/// A PNG file's bytes. Throws Error without a file's name.
std::string encode_png(const PixelRows& rows);
/// A JPEG file's bytes, for looking at; 8 bits only. `quality`: 1 … 100. Throws Error without a file's name.
std::string encode_jpeg(const PixelRows& rows, int quality = 90);

}  // namespace cairn::io
