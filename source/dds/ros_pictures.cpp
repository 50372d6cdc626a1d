// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "ros_pictures.hpp"

#include <algorithm>
#include <bit>
#include <cairn/core/error.hpp>
#include <optional>

namespace cairn::dds {
namespace {

constexpr std::uint32_t kLongestSide = 32768;
constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 28;

struct Form {
  std::uint32_t pixel_bytes = 1;
  int red = 0;  // where it stands in a pixel; blue is at 2 − red
};

std::optional<Form> form_of(const std::string& encoding) {
  if (encoding == "mono8" || encoding == "8UC1") return Form{1};
  if (encoding == "mono16" || encoding == "16UC1") return Form{2};
  if (encoding == "rgb8") return Form{3, 0};
  if (encoding == "bgr8" || encoding == "8UC3") return Form{3, 2};
  return std::nullopt;
}

Form checked(const ros::Image& image, const std::string& topic) {
  const std::optional<Form> form = form_of(image.encoding);
  if (!form) {
    throw Error(topic + ": found the encoding \"" + image.encoding +
                "\", expected mono8, mono16, rgb8 or bgr8");
  }
  const bool is_sound = image.width > 0 && image.height > 0 && image.width <= kLongestSide &&
                        image.height <= kLongestSide &&
                        std::uint64_t{image.width} * image.height <= kMostPixels &&
                        image.step >= image.width * form->pixel_bytes &&
                        image.data.size() >= std::uint64_t{image.step} * image.height;
  if (!is_sound) {
    throw Error(topic + ": found " + std::to_string(image.data.size()) + " bytes for an image of " +
                std::to_string(image.width) + " x " + std::to_string(image.height) + " " + image.encoding +
                " with rows of " + std::to_string(image.step) +
                ", expected consistent width, height, step and bytes");
  }
  return *form;
}

std::uint16_t deep_sample(const ros::Image& image, const std::uint8_t* row, int x) {
  const std::uint8_t first = row[2 * x];
  const std::uint8_t second = row[2 * x + 1];
  return static_cast<std::uint16_t>(image.is_bigendian != 0 ? first << 8 | second : second << 8 | first);
}

const std::uint8_t* row_of(const ros::Image& image, int y) {
  return image.data.data() + std::size_t{image.step} * static_cast<std::size_t>(y);
}

Size size_of(const ros::Image& image) {
  return {static_cast<int>(image.width), static_cast<int>(image.height)};
}

/// Bits that the brightest sample needs; 8 of images with 8 bits.
int depth_of(const ros::Image& image, Form form) {
  if (form.pixel_bytes != 2) return 8;
  unsigned most = 0;
  for (int y = 0; y < size_of(image).height; ++y)
    for (int x = 0; x < size_of(image).width; ++x)
      most = std::max<unsigned>(most, deep_sample(image, row_of(image, y), x));
  return std::max(8, static_cast<int>(std::bit_width(most)));
}

io::Picture picture_of(const ros::Image& image, Form form, int depth, const Pool& pool) {
  const Size size = size_of(image);
  io::Picture picture;
  if (form.pixel_bytes != 3)
    picture.gray = Image<Gray>(size, pool);
  else
    picture.rgb = Image<Rgb>(size, pool);
  for (int y = 0; y < size.height; ++y) {
    const std::uint8_t* const from = row_of(image, y);
    if (form.pixel_bytes == 1) {
      std::copy_n(from, size.width, picture.gray.row(y));
    } else if (form.pixel_bytes == 2) {
      Gray* const to = picture.gray.row(y);
      for (int x = 0; x < size.width; ++x)
        to[x] = static_cast<Gray>(std::min(255, deep_sample(image, from, x) >> (depth - 8)));
    } else {
      Rgb* const to = picture.rgb.row(y);
      for (int x = 0; x < size.width; ++x)
        to[x] = {from[3 * x + form.red], from[3 * x + 1], from[3 * x + 2 - form.red]};
    }
  }
  if (form.pixel_bytes == 3) picture.gray = io::grey_of(picture.rgb, pool);
  return picture;
}

}  // namespace

io::PicturePair pictures_of(const ros::Image& left, const std::string& left_topic, const ros::Image& right,
                            const std::string& right_topic, int least_bits, const Pool& pool) {
  const Form left_form = checked(left, left_topic);
  const Form right_form = checked(right, right_topic);
  if (size_of(left) != size_of(right)) {
    throw Error(right_topic + ": is " + text(size_of(right)) + ", expected " + text(size_of(left)) + " as " +
                left_topic + " is: a rectified pair has equal sizes");
  }
  if ((left_form.pixel_bytes == 2) != (right_form.pixel_bytes == 2)) {
    throw Error(right_topic + ": is " + right.encoding + ", and " + left_topic + " is " + left.encoding +
                "; expected 8 or 16 bits of both: a pair has one scale");
  }
  int depth = std::max(depth_of(left, left_form), depth_of(right, right_form));
  if (left_form.pixel_bytes == 2) depth = std::max(depth, least_bits);
  io::PicturePair pair{picture_of(left, left_form, depth, pool), picture_of(right, right_form, depth, pool),
                       depth};
  pair.right.rgb = {};
  return pair;
}

}  // namespace cairn::dds
