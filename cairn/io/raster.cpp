// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/io/raster.hpp>
#include <cairn/io/read_file.hpp>
#include <cerrno>
#include <new>
#include <string>

namespace cairn::io {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kMaxPictureBytes = std::size_t{1} << 31;

}  // namespace

Raster decode_raster(std::string_view file, Palette palette) {
  if (file.empty()) throw Error("is empty, expected an image (PNG, JPEG, PGM, PPM)");
  if (file.starts_with("\x89PNG\r\n\x1a\n"sv)) return decode_png(file, palette);
  if (file.starts_with("\xff\xd8\xff"sv)) return decode_jpeg(file);
  if (file.starts_with("II*\0"sv) || file.starts_with("MM\0*"sv)) {
    throw Error(
        "is a TIFF, expected PNG, JPEG, PGM or PPM; convert it, e.g. with ImageMagick: convert a.tif a.png");
  }
  if (file.size() > 1 && file[0] == 'P' && file[1] >= '1' && file[1] <= '7') return decode_pnm(file);
  throw Error("is not a readable image, expected PNG, JPEG, PGM or PPM");
}

void check_sides(std::int64_t width, std::int64_t height) {
  const auto fits = [](std::int64_t side) { return side >= 1 && side <= kMaxPixelsPerSide; };
  if (fits(width) && fits(height) && width * height <= kMaxPixels) return;
  throw Error("claims " + std::to_string(width) + "x" + std::to_string(height) + " pixels, expected 1 ... " +
              std::to_string(kMaxPixelsPerSide) + " per side and at most " + std::to_string(kMaxPixels));
}

void check_memory() {
  if (errno == ENOMEM) throw std::bad_alloc();
}

Raster read_raster(const std::filesystem::path& path, Palette palette) {
  const std::string file = read_file(path, kMaxPictureBytes);
  try {
    return decode_raster(file, palette);
  } catch (const Error& error) {
    throw Error(path.string() + ": " + error.what());
  }
}

}  // namespace cairn::io
