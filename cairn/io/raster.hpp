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

#include <cairn/io/image_files.hpp>

/// Decoded images as stored in the file; internal to io. image_files and disparity_files convert them.
namespace cairn::io {

inline constexpr int kMaxPixelsPerSide = 32768;
inline constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

/// Throws Error (without a file name) unless both sides are in 1 … kMaxPixelsPerSide and the area ≤
/// kMaxPixels.
void check_sides(std::int64_t width, std::int64_t height);

/// Samples, rows top-down without padding, channels interleaved (grey or R, G, B), in native byte order.
struct Raster {
  Size size;
  int channels = 1;      // 1 or 3
  int bytes_each = 1;    // per sample: 1 or 2
  int max_value = 255;   // full scale declared in the header
  bool declared = true;  // false: a 16-bit container whose real depth follows from the values
  std::vector<std::uint8_t> bytes;

  template <class T>
  [[nodiscard]] const T* row(int y) const {
    const auto step = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(channels) * sizeof(T);
    return reinterpret_cast<const T*>(bytes.data() + static_cast<std::size_t>(y) * step);
  }
  /// Samples per row.
  [[nodiscard]] int row_length() const { return size.width * channels; }
};

/// The meaning of palette indices: colours, or numbers.
enum class Palette : std::uint8_t { colours, indices };

/// Reads and decodes a file by its content. Throws Error that names `path`; never prints, never returns
/// partial data.
Raster read_raster(const std::filesystem::path& path, Palette palette);
/// The same for the bytes of a file; throws Error without a file name.
Raster decode_raster(std::string_view file, Palette palette);

/// Both reduced to 8 bits as in load_pair(). Throws Error, without file names, if sizes or depths differ.
LoadedPair pair_of(const Raster& left, const Raster& right, const Pool& pool, int least_bits = 8);

/// Call after a C library has failed: throws std::bad_alloc if the cause is missing memory (errno, which the
/// caller set to 0 before), which is no fault of the file.
void check_memory();

// One function per format; they throw Error without a file name.
Raster decode_png(std::string_view file, Palette palette);
Raster decode_jpeg(std::string_view file);
Raster decode_pnm(std::string_view file);

/// Rows of samples to encode: grey of 8 or 16 bits, or RGB of 8.
struct PixelRows {
  Size size;
  int channels = 1;
  int bytes_each = 1;
  const std::uint8_t* first = nullptr;
  std::ptrdiff_t stride_bytes = 0;
};
/// The bytes of a PNG file. Throws Error without a file name.
std::string encode_png(const PixelRows& rows);
/// The bytes of a JPEG file, for viewing; 8 bits only. `quality`: 1 … 100. Throws Error without a file name.
std::string encode_jpeg(const PixelRows& rows, int quality = 90);

}  // namespace cairn::io
