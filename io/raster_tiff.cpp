// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <tiffio.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <io/raster.hpp>
#include <memory>
#include <string>

// libtiff itself rather than OpenCV's use of it: OpenCV prints what it cannot decode.
namespace cairn::io {
namespace {

struct Source {
  std::string_view file;
  std::uint64_t at = 0;
  std::string complaint;
};

Source& source_of(thandle_t handle) {
  return *static_cast<Source*>(handle);
}

tsize_t read_bytes(thandle_t handle, tdata_t out, tsize_t count) {
  Source& source = source_of(handle);
  const std::uint64_t left = source.at < source.file.size() ? source.file.size() - source.at : 0;
  const auto taken = std::min(left, static_cast<std::uint64_t>(std::max<tsize_t>(count, 0)));
  if (taken > 0) std::memcpy(out, source.file.data() + source.at, taken);
  source.at += taken;
  return static_cast<tsize_t>(taken);
}
tsize_t write_nothing(thandle_t, tdata_t, tsize_t) {
  return 0;
}
toff_t seek(thandle_t handle, toff_t offset, int from) {
  Source& source = source_of(handle);
  source.at = offset + (from == SEEK_CUR ? source.at : from == SEEK_END ? source.file.size() : 0);
  return source.at;
}
int close_nothing(thandle_t) {
  return 0;
}
toff_t length(thandle_t handle) {
  return source_of(handle).file.size();
}

std::string formatted(const char* format, std::va_list arguments) {
  char line[200] = {};
  std::vsnprintf(line, sizeof line, format, arguments);
  return line;
}

using Tiff = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

#if TIFFLIB_VERSION >= 20221213  // 4.5 has handlers of one file's own

int remember(TIFF*, void* source, const char*, const char* format, std::va_list arguments) {
  std::string& complaint = static_cast<Source*>(source)->complaint;
  if (complaint.empty()) complaint = formatted(format, arguments);
  return 1;
}
int keep_quiet(TIFF*, void*, const char*, const char*, std::va_list) {
  return 1;
}
Tiff open(Source& source) {
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(),
                                                                                 TIFFOpenOptionsFree);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), remember, &source);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), keep_quiet, nullptr);
  return {TIFFClientOpenExt("", "rm", &source, read_bytes, write_nothing, seek, close_nothing, length,
                            nullptr, nullptr, options.get()),
          TIFFClose};
}
struct Quiet {};

#else  // before, they are the process's: silenced while a file is read

Tiff open(Source& source) {
  return {TIFFClientOpen("", "rm", &source, read_bytes, write_nothing, seek, close_nothing, length, nullptr,
                         nullptr),
          TIFFClose};
}
struct Quiet {
  TIFFErrorHandler error = TIFFSetErrorHandler(nullptr);
  TIFFErrorHandler warning = TIFFSetWarningHandler(nullptr);
  Quiet() = default;
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
  ~Quiet() {
    TIFFSetErrorHandler(error);
    TIFFSetWarningHandler(warning);
  }
};

#endif

[[noreturn]] void refuse(const Source& source) {
  throw Error("is a truncated or damaged TIFF" + (source.complaint.empty() ? "" : ": " + source.complaint));
}

template <class T>
T field(TIFF* tiff, std::uint32_t tag) {
  T value{};
  TIFFGetFieldDefaulted(tiff, tag, &value);
  return value;
}

struct Layout {
  Size size;
  std::size_t samples = 1;     // per pixel in the file, alpha counted
  std::size_t bytes_each = 1;  // per sample
  std::uint16_t photometric = 0;
  [[nodiscard]] std::size_t row_bytes() const {
    return static_cast<std::size_t>(size.width) * samples * bytes_each;
  }
};

Layout layout_of(TIFF* tiff) {
  Layout layout;
  const auto width = field<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH);
  const auto height = field<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH);
  check_sides(width, height);
  layout.size = {static_cast<int>(width), static_cast<int>(height)};
  const auto bits = field<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE);
  const auto form = field<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT);
  layout.samples = field<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL);
  layout.bytes_each = bits / 8U;
  if (TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &layout.photometric) == 0) {
    layout.photometric = layout.samples >= 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK;
  }
  const bool grey = layout.photometric == PHOTOMETRIC_MINISBLACK ||
                    layout.photometric == PHOTOMETRIC_MINISWHITE ||
                    (layout.photometric == PHOTOMETRIC_PALETTE && bits == 8);
  const bool colour = layout.photometric == PHOTOMETRIC_RGB && layout.samples >= 3;
  const bool apart =
      layout.samples > 1 && field<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG) != PLANARCONFIG_CONTIG;
  if ((bits != 8 && bits != 16) || (form != SAMPLEFORMAT_UINT && form != SAMPLEFORMAT_VOID) || apart ||
      !(grey || colour) || layout.samples < 1 || layout.samples > 8) {
    throw Error("is a TIFF with " + std::to_string(layout.samples) + " samples of " + std::to_string(bits) +
                " bits (kind " + std::to_string(layout.photometric) + (apart ? ", in separate planes" : "") +
                "), expected grey or RGB of 8 or 16 bits");
  }
  return layout;
}

/// Calls take(x, y, pointer, pixels) for runs of pixels that together cover the picture.
template <class Take>
void read_pixels(TIFF* tiff, const Source& source, const Layout& layout, const Take& take) {
  const auto width = static_cast<std::uint32_t>(layout.size.width);
  const auto height = static_cast<std::uint32_t>(layout.size.height);
  if (TIFFIsTiled(tiff) == 0) {
    if (static_cast<std::size_t>(TIFFScanlineSize(tiff)) != layout.row_bytes()) refuse(source);
    std::vector<std::uint8_t> row(layout.row_bytes());
    for (std::uint32_t y = 0; y < height; ++y) {
      if (TIFFReadScanline(tiff, row.data(), y) < 0) refuse(source);
      take(0U, y, row.data(), width);
    }
    return;
  }
  const auto tile_width = field<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH);
  const auto tile_height = field<std::uint32_t>(tiff, TIFFTAG_TILELENGTH);
  check_sides(tile_width, tile_height);
  const std::size_t step = tile_width * layout.samples * layout.bytes_each;
  if (static_cast<std::size_t>(TIFFTileSize(tiff)) != step * tile_height) refuse(source);
  std::vector<std::uint8_t> tile(step * tile_height);
  for (std::uint32_t y = 0; y < height; y += tile_height) {
    for (std::uint32_t x = 0; x < width; x += tile_width) {
      if (TIFFReadTile(tiff, tile.data(), x, y, 0, 0) < 0) refuse(source);
      for (std::uint32_t row = 0; row < std::min(tile_height, height - y); ++row) {
        take(x, y + row, tile.data() + row * step, std::min(tile_width, width - x));
      }
    }
  }
}

/// The palette's colours instead of its indices.
Raster coloured(const Raster& indices, TIFF* tiff, const Source& source) {
  const std::uint16_t* channels[3] = {};
  if (TIFFGetField(tiff, TIFFTAG_COLORMAP, &channels[0], &channels[1], &channels[2]) == 0) refuse(source);
  Raster raster = indices;
  raster.channels = 3;
  raster.bytes.resize(3 * indices.bytes.size());
  for (std::size_t i = 0; i < indices.bytes.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      raster.bytes[3 * i + c] = static_cast<std::uint8_t>(channels[c][indices.bytes[i]] >> 8);
    }
  }
  return raster;
}

void invert(Raster& raster) {
  // All bits of a sample turned over is its greatest value less itself.
  for (std::uint8_t& byte : raster.bytes) byte = static_cast<std::uint8_t>(~byte);
}

}  // namespace

Raster decode_tiff(std::string_view file, Palette palette) {
  [[maybe_unused]] const Quiet quiet;
  Source source{file, 0, {}};
  const Tiff tiff = open(source);
  if (!tiff) refuse(source);
  const Layout layout = layout_of(tiff.get());
  Raster raster;
  raster.size = layout.size;
  raster.channels = layout.photometric == PHOTOMETRIC_RGB ? 3 : 1;
  raster.bytes_each = static_cast<int>(layout.bytes_each);
  raster.declared = raster.bytes_each == 1;
  raster.max_value = raster.declared ? 255 : 65535;
  const std::size_t wanted = static_cast<std::size_t>(raster.channels) * layout.bytes_each;
  const std::size_t given = layout.samples * layout.bytes_each;
  raster.bytes.resize(static_cast<std::size_t>(layout.size.area()) * wanted);
  read_pixels(tiff.get(), source, layout,
              [&](std::size_t x, std::size_t y, const std::uint8_t* from, std::size_t n) {
                std::uint8_t* to =
                    raster.bytes.data() + (y * static_cast<std::size_t>(layout.size.width) + x) * wanted;
                for (std::size_t i = 0; i < n; ++i) std::memcpy(to + i * wanted, from + i * given, wanted);
              });
  if (layout.photometric == PHOTOMETRIC_MINISWHITE) invert(raster);
  if (layout.photometric == PHOTOMETRIC_PALETTE && palette == Palette::colours) {
    return coloured(raster, tiff.get(), source);
  }
  return raster;
}

}  // namespace cairn::io
