// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <png.h>
#include <zlib.h>

#include <bit>
#include <cairn/core/error.hpp>
#include <cairn/io/raster.hpp>
#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <new>
#include <string>

// libpng is used directly to catch its errors, which OpenCV only prints.
namespace cairn::io {
namespace {

struct Complaint {
  char text[200] = {};
};

void complain(png_structp png, png_const_charp message) {
  Complaint& complaint = *static_cast<Complaint*>(png_get_error_ptr(png));
  std::snprintf(complaint.text, sizeof complaint.text, "%s", message);
  png_longjmp(png, 1);
}
void keep_quiet(png_structp, png_const_charp) {}

void read_bytes(png_structp png, png_bytep out, std::size_t count) {
  auto& rest = *static_cast<std::string_view*>(png_get_io_ptr(png));
  if (count > rest.size()) png_error(png, "the file ends too early");
  std::memcpy(out, rest.data(), count);
  rest.remove_prefix(count);
}

/// No exception may cross libpng, and no destructor its longjmp.
void append_bytes(png_structp png, png_bytep bytes, std::size_t count) {
  bool has_room = true;
  try {
    static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(bytes), count);
  } catch (const std::exception&) {
    has_room = false;
  }
  if (has_room) return;
  errno = ENOMEM;
  png_error(png, "no room for the file");
}
void flush_nothing(png_structp) {}

struct Reader {
  explicit Reader(std::string_view& rest)
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &complaint, complain, keep_quiet)),
        info(png != nullptr ? png_create_info_struct(png) : nullptr) {
    if (info == nullptr) {
      png_destroy_read_struct(&png, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png, &rest, read_bytes);
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    errno = 0;
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  Complaint complaint;
  png_structp png;
  png_infop info;
};

struct Writer {
  explicit Writer(std::string& file)
      : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, &complaint, complain, keep_quiet)),
        info(png != nullptr ? png_create_info_struct(png) : nullptr) {
    if (info == nullptr) {
      png_destroy_write_struct(&png, nullptr);
      throw std::bad_alloc();
    }
    png_set_write_fn(png, &file, append_bytes, flush_nothing);
    errno = 0;
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() { png_destroy_write_struct(&png, &info); }
  Complaint complaint;
  png_structp png;
  png_infop info;
};

/// Runs `steps`, which must own nothing, since libpng leaves it by longjmp; the caller owns all objects.
/// False if libpng failed other than by lack of memory.
template <class Steps>
bool succeeds(png_structp png, const Steps& steps) {
  if (setjmp(png_jmpbuf(png)) != 0) {  // NOLINT(cert-err52-cpp): libpng's only way out
    check_memory();
    return false;
  }
  steps();
  return true;
}

void run(const Reader& reader, const auto& steps) {
  if (!succeeds(reader.png, steps))
    throw Error(std::string("is a truncated or damaged PNG: ") + reader.complaint.text);
}

/// Deflate compresses at most 1032:1, so a short file that claims a huge size is rejected before memory is
/// allocated.
void check_plausible(Size size, std::size_t raster_bytes, std::size_t file_bytes) {
  // Samples of less than 8 bits are first packed, up to eight per byte.
  if (raster_bytes / 8 / 1032 <= file_bytes) return;
  throw Error("is a truncated or damaged PNG: " + std::to_string(file_bytes) + " bytes cannot hold " +
              text(size) + " pixels");
}

}  // namespace

Raster decode_png(std::string_view file, Palette palette) {
  std::string_view rest = file;
  const Reader reader(rest);
  Raster raster;
  png_uint_32 width = 0;
  png_uint_32 height = 0;
  int depth = 0;
  int colour = 0;
  run(reader, [&] {
    png_read_info(reader.png, reader.info);
    png_get_IHDR(reader.png, reader.info, &width, &height, &depth, &colour, nullptr, nullptr, nullptr);
  });
  check_sides(width, height);
  raster.size = {static_cast<int>(width), static_cast<int>(height)};
  const bool indexed = colour == PNG_COLOR_TYPE_PALETTE;
  raster.channels = (colour & PNG_COLOR_MASK_COLOR) != 0 && !(indexed && palette == Palette::indices) ? 3 : 1;
  raster.bytes_each = depth == 16 ? 2 : 1;
  raster.max_value = indexed ? 255 : (1 << depth) - 1;
  raster.declared = depth != 16;

  std::size_t row_bytes = 0;
  run(reader, [&] {
    if (indexed && palette == Palette::colours) png_set_palette_to_rgb(reader.png);
    png_set_packing(reader.png);  // less than 8 bits: one byte each, values unchanged
    png_set_strip_alpha(reader.png);
    if (std::endian::native == std::endian::little) png_set_swap(reader.png);
    png_set_interlace_handling(reader.png);
    png_read_update_info(reader.png, reader.info);
    row_bytes = png_get_rowbytes(reader.png, reader.info);
  });
  if (row_bytes != static_cast<std::size_t>(raster.row_length() * raster.bytes_each)) {
    throw Error("is a PNG of an unknown form (colour type " + std::to_string(colour) + ", " +
                std::to_string(depth) + " bits)");
  }
  std::vector<png_bytep> rows(height);
  const std::size_t bytes = row_bytes * height;
  check_plausible(raster.size, bytes, file.size());
  raster.bytes.resize(bytes);
  for (std::size_t y = 0; y < height; ++y) rows[y] = raster.bytes.data() + y * row_bytes;
  run(reader, [&] {
    png_read_image(reader.png, rows.data());
    png_read_end(reader.png, nullptr);
  });
  return raster;
}

std::string encode_png(const PixelRows& rows) {
  std::string file;
  const Writer writer(file);
  const auto steps = [&] {
    png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(rows.size.width),
                 static_cast<png_uint_32>(rows.size.height), 8 * rows.bytes_each,
                 rows.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    // The "up" filter with run-length encoding: on photographs and id maps smaller than deflate at middle
    // levels, in a quarter of the time.
    png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
    png_set_compression_strategy(writer.png, Z_RLE);
    png_write_info(writer.png, writer.info);
    if (std::endian::native == std::endian::little) png_set_swap(writer.png);
    for (int y = 0; y < rows.size.height; ++y) png_write_row(writer.png, rows.first + y * rows.stride_bytes);
    png_write_end(writer.png, nullptr);
  };
  if (!succeeds(writer.png, steps)) {
    throw Error(std::string("cannot be encoded as PNG: ") + writer.complaint.text);
  }
  return file;
}

}  // namespace cairn::io
