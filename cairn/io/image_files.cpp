// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <bit>
#include <cairn/core/error.hpp>
#include <cairn/image/binning.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/io/raster.hpp>
#include <string>

namespace cairn::io {
namespace {

namespace fs = std::filesystem;

/// Number of bits of the samples; 8 for every 8-bit file.
int depth_of(const Raster& raster) {
  if (raster.bytes_each == 1) return 8;
  auto most = static_cast<unsigned>(raster.max_value);
  if (!raster.declared) {
    most = 0;
    for (int y = 0; y < raster.size.height; ++y) {
      const auto* row = raster.row<std::uint16_t>(y);
      most = std::max<unsigned>(most, *std::max_element(row, row + raster.row_length()));
    }
  }
  return std::max(8, static_cast<int>(std::bit_width(most)));
}

/// Converts samples to 8 bits: drops the low bits of deep ones, scales shallow ones (a PGM up to 15) to 255.
class Reduction {
 public:
  Reduction(const Raster& raster, int depth)
      : shift_(depth - 8), full_(raster.bytes_each == 1 ? raster.max_value : 255) {}
  [[nodiscard]] std::uint8_t operator()(int sample) const {
    return static_cast<std::uint8_t>(full_ == 255 ? sample >> shift_
                                                  : std::min(255, (sample * 255 + full_ / 2) / full_));
  }

 private:
  int shift_;
  int full_;
};

Gray grey_of(Rgb c) {
  return static_cast<Gray>((77 * c.r + 150 * c.g + 29 * c.b + 128) >> 8);
}

template <class Sample>
LoadedImage to_picture(const Raster& raster, int depth, const Pool& pool) {
  const Reduction reduced(raster, depth);
  LoadedImage picture{Image<Gray>(raster.size, pool), {}};
  if (raster.channels == 3) picture.rgb = Image<Rgb>(raster.size, pool);
  for (int y = 0; y < raster.size.height; ++y) {
    const auto* from = raster.row<Sample>(y);
    Gray* grey = picture.gray.row(y);
    if (raster.channels == 1) {
      std::transform(from, from + raster.size.width, grey, reduced);
      continue;
    }
    Rgb* rgb = picture.rgb.row(y);
    for (int x = 0; x < raster.size.width; ++x, from += 3) {
      rgb[x] = {reduced(from[0]), reduced(from[1]), reduced(from[2])};
      grey[x] = grey_of(rgb[x]);
    }
  }
  return picture;
}

LoadedImage picture_of(const Raster& raster, int depth, const Pool& pool) {
  return raster.bytes_each == 1 ? to_picture<std::uint8_t>(raster, depth, pool)
                                : to_picture<std::uint16_t>(raster, depth, pool);
}

Raster part_of(const Raster& raster, const Rect& place) {
  Raster part = raster;
  part.size = {place.width, place.height};
  const auto pixel = static_cast<std::size_t>(raster.channels * raster.bytes_each);
  const std::size_t from = static_cast<std::size_t>(raster.size.width) * pixel;
  const std::size_t to = static_cast<std::size_t>(place.width) * pixel;
  part.bytes.resize(to * static_cast<std::size_t>(place.height));
  for (std::size_t row = 0; row < static_cast<std::size_t>(place.height); ++row) {
    std::copy_n(raster.bytes.data() + (static_cast<std::size_t>(place.y) + row) * from +
                    static_cast<std::size_t>(place.x) * pixel,
                to, part.bytes.data() + row * to);
  }
  return part;
}

template <class T>
std::string encoded(View<const T> image, int channels) {
  if (image.empty()) throw Error("cannot be written: the image is empty");
  constexpr auto kBytes = static_cast<std::ptrdiff_t>(sizeof(T));
  return encode_png({image.size(), channels, static_cast<int>(kBytes) / channels,
                     reinterpret_cast<const std::uint8_t*>(image.data()), image.stride() * kBytes});
}

template <class T>
void save(const fs::path& path, View<const T> image, int channels) {
  std::string file;
  try {
    file = encoded(image, channels);
  } catch (const Error& error) {
    throw Error(path.string() + ": " + error.what());
  }
  write_file(path, file);
}

}  // namespace

LoadedImage load_picture(const fs::path& path, const Pool& pool) {
  const Raster raster = read_raster(path, Palette::colours);
  return picture_of(raster, depth_of(raster), pool);
}

LoadedPair load_pair(const fs::path& left, const fs::path& right, const Pool& pool, int least_bits) {
  const Raster first = read_raster(left, Palette::colours);
  const Raster second = read_raster(right, Palette::colours);
  if (first.size != second.size) {
    throw Error(right.string() + ": is " + text(second.size) + ", expected " + text(first.size) + " as " +
                left.string() + " is: a rectified pair has equal sizes");
  }
  if (first.bytes_each != second.bytes_each) {
    throw Error(right.string() + ": has " + std::to_string(8 * second.bytes_each) + " bits, expected " +
                std::to_string(8 * first.bytes_each) + " as " + left.string() + " has: a pair has one scale");
  }
  return pair_of(first, second, pool, least_bits);
}

Layout layout_of(std::string_view name) {
  if (name.empty() || name == "side_by_side") return Layout::side_by_side;
  if (name == "top_bottom") return Layout::top_bottom;
  throw Error("--layout: found " + std::string(name) + ", expected side_by_side or top_bottom");
}

std::array<Rect, 2> halves_of(Size both, Layout layout) {
  const bool side_by_side = layout == Layout::side_by_side;
  if ((side_by_side ? both.width : both.height) % 2 != 0) {
    throw Error("is " + text(both) + ", expected an even " +
                (side_by_side ? "width with --layout side_by_side" : "height with --layout top_bottom"));
  }
  const int width = side_by_side ? both.width / 2 : both.width;
  const int height = side_by_side ? both.height : both.height / 2;
  return {Rect{0, 0, width, height},
          Rect{side_by_side ? width : 0, side_by_side ? 0 : height, width, height}};
}

LoadedPair load_pair(const fs::path& left, const fs::path& right, Layout layout, const Pool& pool,
                     int least_bits) {
  if (layout == Layout::one) return load_pair(left, right, pool, least_bits);
  const Raster both = read_raster(left, Palette::colours);
  try {
    const auto halves = halves_of(both.size, layout);
    return pair_of(part_of(both, halves[0]), part_of(both, halves[1]), pool, least_bits);
  } catch (const Error& error) {
    throw Error(left.string() + ": " + error.what());
  }
}

LoadedPair pair_of(const Raster& left, const Raster& right, const Pool& pool, int least_bits) {
  if (left.size != right.size)
    throw Error("the left image is " + text(left.size) + ", the right one " + text(right.size));
  if (left.bytes_each != right.bytes_each) {
    throw Error("the left image has " + std::to_string(8 * left.bytes_each) + " bits, the right one " +
                std::to_string(8 * right.bytes_each));
  }
  int depth = std::max(depth_of(left), depth_of(right));
  if (left.bytes_each > 1) depth = std::max(depth, least_bits);
  return {picture_of(left, depth, pool), picture_of(right, depth, pool), depth};
}

LoadedImage binned(const LoadedImage& image, int factor, const Pool& pool) {
  if (image.rgb.empty()) return {cairn::binned(image.gray, factor, pool), {}};
  Image<Rgb> colours = cairn::binned(image.rgb, factor, pool);
  Image<Gray> grey = grey_of(colours, pool);
  return {std::move(grey), std::move(colours)};
}

Image<Gray> grey_of(View<const Rgb> colours, const Pool& pool) {
  Image<Gray> grey(colours.size(), pool);
  for (int y = 0; y < grey.height(); ++y) {
    const Rgb* from = colours.row(y);
    std::transform(from, from + grey.width(), grey.row(y), [](Rgb c) { return grey_of(c); });
  }
  return grey;
}

Labels load_labels(const fs::path& path, const Pool& pool) {
  const Raster raster = read_raster(path, Palette::indices);
  if (raster.channels != 1) throw Error(path.string() + ": is in colour, expected one channel of numbers");
  Labels labels{Image<std::uint16_t>(raster.size, pool), 8 * raster.bytes_each};
  for (int y = 0; y < raster.size.height; ++y) {
    std::uint16_t* row = labels.ids.row(y);
    if (raster.bytes_each == 1) {
      std::copy_n(raster.row<std::uint8_t>(y), raster.size.width, row);
    } else {
      std::copy_n(raster.row<std::uint16_t>(y), raster.size.width, row);
    }
  }
  return labels;
}

static_assert(sizeof(Rgb) == 3, "a row of colours is a row of samples");

void save_png(const fs::path& path, View<const std::uint8_t> image) {
  save(path, image, 1);
}

void save_png(const fs::path& path, View<const std::uint16_t> image) {
  save(path, image, 1);
}

void save_png(const fs::path& path, View<const Rgb> image) {
  save(path, image, 3);
}

void save_png(const fs::path& path, View<const Reject> image) {
  save(path, image, 1);
}

void save_png(const fs::path& path, View<const ObstacleLabel> image) {
  save(path, image, 1);
}

std::string png_bytes(View<const Rgb> image) {
  return encoded(image, 3);
}

}  // namespace cairn::io
