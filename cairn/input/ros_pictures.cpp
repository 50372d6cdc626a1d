// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/ros_pictures.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cairn/core/error.hpp>
#include <cairn/io/raster.hpp>
#include <cstring>
#include <opencv2/imgproc.hpp>

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

/// An encoding that OpenCV converts to red, green and blue. OpenCV names a Bayer pattern by its first row, too.
struct Conversion {
  const char* name;
  int code;
  int bytes_each = 1;
  int channels = 1;        // of a row
  bool is_planar = false;  // colour differences below the rows of brightness, half as many
};
constexpr std::array kConversions{Conversion{"bayer_rggb8", cv::COLOR_BayerRGGB2RGB},
                                  Conversion{"bayer_bggr8", cv::COLOR_BayerBGGR2RGB},
                                  Conversion{"bayer_gbrg8", cv::COLOR_BayerGBRG2RGB},
                                  Conversion{"bayer_grbg8", cv::COLOR_BayerGRBG2RGB},
                                  Conversion{"bayer_rggb16", cv::COLOR_BayerRGGB2RGB, 2},
                                  Conversion{"bayer_bggr16", cv::COLOR_BayerBGGR2RGB, 2},
                                  Conversion{"bayer_gbrg16", cv::COLOR_BayerGBRG2RGB, 2},
                                  Conversion{"bayer_grbg16", cv::COLOR_BayerGRBG2RGB, 2},
                                  Conversion{"yuv422", cv::COLOR_YUV2RGB_UYVY, 1, 2},
                                  Conversion{"uyvy", cv::COLOR_YUV2RGB_UYVY, 1, 2},
                                  Conversion{"yuv422_yuy2", cv::COLOR_YUV2RGB_YUY2, 1, 2},
                                  Conversion{"yuyv", cv::COLOR_YUV2RGB_YUY2, 1, 2},
                                  Conversion{"nv12", cv::COLOR_YUV2RGB_NV12, 1, 1, true},
                                  Conversion{"nv21", cv::COLOR_YUV2RGB_NV21, 1, 1, true},
                                  Conversion{"i420", cv::COLOR_YUV2RGB_I420, 1, 1, true}};

/// Whether 16-bit samples are in the other byte order than this machine's.
bool has_swapped_bytes(const ros::Image& image, int bytes_each) {
  return bytes_each == 2 && (image.is_bigendian != 0) != (std::endian::native == std::endian::big);
}

void check_bytes(const ros::Image& image, std::size_t pixel, std::size_t rows) {
  if (image.step >= image.width * pixel && image.data.size() >= std::size_t{image.step} * rows) return;
  throw Error("has " + std::to_string(image.data.size()) + " bytes in rows of " + std::to_string(image.step) +
              ", expected those of " + std::to_string(image.width) + "x" + std::to_string(image.height) +
              " pixels of " + std::to_string(pixel));
}

/// An empty raster for this image.
io::Raster raster_for(const ros::Image& image, int channels, int bytes_each) {
  io::Raster raster;
  raster.size = {static_cast<int>(image.width), static_cast<int>(image.height)};
  raster.channels = channels;
  raster.bytes_each = bytes_each;
  if (bytes_each == 2) {
    raster.max_value = 65535;
    raster.declared = false;
  }
  raster.bytes.resize(std::size_t{image.width} * image.height *
                      static_cast<std::size_t>(channels * bytes_each));
  return raster;
}

io::Raster converted(const ros::Image& image, const Conversion& how) {
  if (image.width % 2 != 0 || image.height % 2 != 0) {
    throw Error("is " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                ", expected an even width and height with the encoding " + image.encoding);
  }
  const std::size_t row = std::size_t{image.width} * static_cast<std::size_t>(how.bytes_each * how.channels);
  const std::size_t rows = image.height + (how.is_planar ? image.height / 2 : 0);
  check_bytes(image, static_cast<std::size_t>(how.bytes_each * how.channels), rows);
  // Rows without padding, as planes of half the width need them, and in this machine's byte order.
  std::vector<std::uint8_t> samples(row * rows);
  for (std::size_t y = 0; y < rows; ++y)
    std::memcpy(samples.data() + y * row, image.data.data() + y * image.step, row);
  if (has_swapped_bytes(image, how.bytes_each))
    for (std::size_t i = 0; i + 1 < samples.size(); i += 2) std::swap(samples[i], samples[i + 1]);
  io::Raster raster = raster_for(image, 3, how.bytes_each);
  const int depth = how.bytes_each == 2 ? CV_16U : CV_8U;
  const cv::Mat from(static_cast<int>(rows), raster.size.width, CV_MAKETYPE(depth, how.channels),
                     samples.data());
  cv::Mat to(raster.size.height, raster.size.width, CV_MAKETYPE(depth, 3), raster.bytes.data());
  cv::cvtColor(from, to, how.code);
  return raster;
}

/// Runs `work`; prefixes its errors with the topic.
template <class Work>
auto on_topic(const std::string& topic, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    throw Error(topic + ": " + error.what());
  }
}

io::LoadedPair pair_of(const io::Raster& left, const io::Raster& right, const std::string& right_topic,
                       int least_bits, const Pool& pool) {
  io::LoadedPair pair = on_topic(right_topic, [&] { return io::pair_of(left, right, pool, least_bits); });
  pair.right.rgb = {};
  return pair;
}

}  // namespace

io::Raster raster_of(const ros::Image& image) {
  const auto has_name = [&](const auto& known) { return image.encoding == known.name; };
  const auto* const encoding = std::ranges::find_if(kEncodings, has_name);
  if (encoding == kEncodings.end()) {
    const auto* const conversion = std::ranges::find_if(kConversions, has_name);
    if (conversion != kConversions.end()) {
      io::check_sides(image.width, image.height);
      return converted(image, *conversion);
    }
    throw Error("has the encoding " + image.encoding +
                ", expected grey (mono8, mono16), colours (rgb8, bgr8, rgba8, bgra8), a Bayer pattern "
                "(bayer_rggb8 ...) or YUV (yuv422, yuv422_yuy2, nv12, nv21, i420)");
  }
  io::check_sides(image.width, image.height);
  const std::size_t pixel = encoding->channels * static_cast<std::size_t>(encoding->bytes_each);
  check_bytes(image, pixel, image.height);
  io::Raster raster = raster_for(image, encoding->channels == 1 ? 1 : 3, encoding->bytes_each);
  const std::size_t out_pixel = static_cast<std::size_t>(raster.channels * raster.bytes_each);
  const bool is_swapped = has_swapped_bytes(image, raster.bytes_each);
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
  return pair_of(first, second, right_topic, least_bits, pool);
}

io::LoadedPair pictures_of(const ros::Image& left, const std::string& left_topic, const io::Raster& right,
                           const std::string& right_topic, int least_bits, const Pool& pool) {
  const io::Raster first = on_topic(left_topic, [&] { return raster_of(left); });
  return pair_of(first, right, right_topic, least_bits, pool);
}

}  // namespace cairn::input
