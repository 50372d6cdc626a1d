// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/ros_pictures.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cairn/core/error.hpp>
#include <cstring>

namespace cairn::input {
namespace {

/// Pixel layout of an encoding.
struct Encoding {
  const char* name;
  std::size_t channels;  // in the message
  int bytes_each;
  bool is_reversed;  // blue before red
};
constexpr std::array kEncodings{
    Encoding{"mono8", 1, 1, false}, Encoding{"8UC1", 1, 1, false},   Encoding{"rgb8", 3, 1, false},
    Encoding{"bgr8", 3, 1, true},   Encoding{"8UC3", 3, 1, true},    Encoding{"rgba8", 4, 1, false},
    Encoding{"bgra8", 4, 1, true},  Encoding{"mono16", 1, 2, false}, Encoding{"16UC1", 1, 2, false}};

/// Runs `work`; prefixes its errors with the topic.
template <class Work>
auto on_topic(const std::string& topic, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    throw Error(topic + ": " + error.what());
  }
}

}  // namespace

io::Raster raster_of(const ros::Image& image) {
  const auto* const encoding =
      std::ranges::find_if(kEncodings, [&](const Encoding& e) { return image.encoding == e.name; });
  if (encoding == kEncodings.end()) {
    throw Error("has the encoding " + image.encoding +
                ", expected mono8, mono16, rgb8, bgr8, rgba8 or bgra8 (convert others first)");
  }
  io::check_sides(image.width, image.height);
  const std::size_t pixel = encoding->channels * static_cast<std::size_t>(encoding->bytes_each);
  if (image.step < image.width * pixel || image.data.size() < std::size_t{image.step} * image.height) {
    throw Error("has " + std::to_string(image.data.size()) + " bytes in rows of " +
                std::to_string(image.step) + ", expected those of " + std::to_string(image.width) + "x" +
                std::to_string(image.height) + " pixels of " + std::to_string(pixel));
  }
  io::Raster raster;
  raster.size = {static_cast<int>(image.width), static_cast<int>(image.height)};
  raster.channels = encoding->channels == 1 ? 1 : 3;
  raster.bytes_each = encoding->bytes_each;
  if (raster.bytes_each == 2) {
    raster.max_value = 65535;
    raster.declared = false;
  }
  const std::size_t out_pixel = static_cast<std::size_t>(raster.channels * raster.bytes_each);
  raster.bytes.resize(std::size_t{image.width} * image.height * out_pixel);
  const bool is_swapped =
      raster.bytes_each == 2 && (image.is_bigendian != 0) != (std::endian::native == std::endian::big);
  for (std::size_t y = 0; y < image.height; ++y) {
    const std::uint8_t* from = image.data.data() + y * image.step;
    std::uint8_t* to = raster.bytes.data() + y * image.width * out_pixel;
    if (pixel == out_pixel && !encoding->is_reversed && !is_swapped) {
      std::memcpy(to, from, image.width * pixel);
      continue;
    }
    for (std::size_t x = 0; x < image.width; ++x, from += pixel, to += out_pixel) {
      std::copy_n(from, out_pixel, to);
      if (encoding->is_reversed) std::swap(to[0], to[2]);
      if (is_swapped) std::swap(to[0], to[1]);
    }
  }
  return raster;
}

io::LoadedPair pictures_of(const ros::Image& left, const std::string& left_topic, const ros::Image& right,
                           const std::string& right_topic, int least_bits, const Pool& pool) {
  const io::Raster first = on_topic(left_topic, [&] { return raster_of(left); });
  const io::Raster second = on_topic(right_topic, [&] { return raster_of(right); });
  io::LoadedPair pair = on_topic(right_topic, [&] { return io::pair_of(first, second, pool, least_bits); });
  pair.right.rgb = {};
  return pair;
}

}  // namespace cairn::input
