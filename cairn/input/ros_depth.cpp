// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/ros_depth.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cairn/core/error.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/raster.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

#include <cairn/ros/from_step.hpp>

namespace cairn::input {
namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();
constexpr auto kUnitsPerMetre = static_cast<float>(io::kDepthUnitsPerMetre);

float metres_of(std::uint16_t millimetres) {
  return millimetres == 0 ? kHole : static_cast<float>(millimetres) / kUnitsPerMetre;
}

std::uint16_t in_native_order(std::uint16_t value, bool is_swapped) {
  return is_swapped ? __builtin_bswap16(value) : value;
}
float in_native_order(float value, bool is_swapped) {
  return is_swapped ? std::bit_cast<float>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value))) : value;
}

/// The values of the samples of an image without channels, as `value_of` translates them.
template <class T, class ValueOf>
Image<float> values_of(const ros::Image& image, const ValueOf& value_of, const Pool& pool) {
  io::check_sides(image.width, image.height);
  if (image.step < image.width * sizeof(T) || image.data.size() < std::size_t{image.step} * image.height) {
    throw Error("has " + std::to_string(image.data.size()) + " bytes in rows of " +
                std::to_string(image.step) + ", expected those of " + std::to_string(image.width) + "x" +
                std::to_string(image.height) + " pixels of " + std::to_string(sizeof(T)));
  }
  const bool is_swapped = (image.is_bigendian != 0) != (std::endian::native == std::endian::big);
  Image<float> values({static_cast<int>(image.width), static_cast<int>(image.height)}, pool);
  for (int y = 0; y < values.height(); ++y) {
    const std::uint8_t* from = image.data.data() + static_cast<std::size_t>(y) * image.step;
    for (int x = 0; x < values.width(); ++x, from += sizeof(T)) {
      T value{};
      std::memcpy(&value, from, sizeof value);
      values(x, y) = value_of(in_native_order(value, is_swapped));
    }
  }
  return values;
}

bool is_raw(const std::string& topic) {
  return topic.find("raw") != std::string::npos;
}

float finite(float value) {
  return std::isfinite(value) ? value : kHole;
}

}  // namespace

bool is_named_depth_of(const std::string& topic, const std::string& topic_of_image) {
  const auto differ = std::ranges::mismatch(topic, topic_of_image);
  // Whole parts of the names.
  const auto same = static_cast<std::size_t>(differ.in1 - topic.begin());
  const std::size_t from = same == 0 ? 0 : std::string_view(topic).substr(0, same).rfind('/');
  const std::size_t first = from == std::string::npos ? 0 : from;
  return topic.find("depth", first) != std::string::npos &&
         topic_of_image.find("depth", first) == std::string::npos;
}

bool is_depth_of(const std::string& encoding, const std::string& encoding_of_image, const std::string& topic,
                 const std::string& topic_of_image) {
  const auto has_16_bits = [](const std::string& of) { return of == "16UC1" || of == "mono16"; };
  if (encoding == "32FC1") return true;
  if (!has_16_bits(encoding)) return false;
  return !has_16_bits(encoding_of_image) || is_named_depth_of(topic, topic_of_image);
}

RosDepth depth_of(const ros::Image& image, const Pool& pool) {
  if (image.encoding == "32FC1") return {values_of<float>(image, finite, pool), {}};
  if (image.encoding == "16UC1" || image.encoding == "mono16")
    return {values_of<std::uint16_t>(image, metres_of, pool), {}};
  throw Error("has the encoding " + image.encoding + ", expected depths: 16UC1 (mm) or 32FC1 (m)");
}

RosDepth depth_of(const ros::CompressedImage& image, const Pool& pool) {
  std::string_view bytes{reinterpret_cast<const char*>(image.data.data()), image.data.size()};
  // Of compressed_depth_image_transport: a number and the two parameters of inverse depths.
  std::array<float, 2> inverse{};
  const bool has_header = image.format.find("compressedDepth") != std::string::npos;
  if (has_header) {
    constexpr std::size_t kHeader = 12;
    if (bytes.size() < kHeader) throw Error("has " + std::to_string(bytes.size()) + " bytes of depth");
    std::memcpy(inverse.data(), bytes.data() + 4, sizeof inverse);
    bytes.remove_prefix(kHeader);
  }
  const bool is_inverse = has_header && image.format.find("32FC1") != std::string::npos;
  const io::Raster raster = io::decode_raster(bytes, io::Palette::indices);
  if (raster.channels != 1 || raster.bytes_each != 2)
    throw Error("has the format " + image.format + ", expected depths in 16-bit PNG");
  Image<float> values(raster.size, pool);
  for (int y = 0; y < values.height(); ++y) {
    const auto* const from = raster.row<std::uint16_t>(y);
    std::transform(from, from + values.width(), values.row(y), [&](std::uint16_t v) {
      if (!is_inverse) return metres_of(v);
      return v == 0 ? kHole : finite(inverse[0] / (static_cast<float>(v) - inverse[1]));
    });
  }
  return {std::move(values), {}};
}

RosDepth depth_of(const ros::DisparityImage& image, const Pool& pool) {
  if (image.image.encoding != "32FC1") {
    throw Error("has the encoding " + image.image.encoding + ", expected disparities in 32FC1");
  }
  const auto seen = [&](float d) { return std::isfinite(d) && d >= image.min_disparity ? d : kHole; };
  return {values_of<float>(image.image, seen, pool), RosDepth::FocalAndBaseline{image.f, std::abs(image.t)}};
}

void set_cameras(io::Calibration& calibration, const ros::CameraInfo& left, const ros::CameraInfo* right,
                 const std::string& topic, std::optional<Size> images) {
  calibration.one_camera = ros::one_camera_of(left, is_raw(topic), images);
  if (right != nullptr && right->p[3] != 0) calibration.rig = ros::rig_of(left, *right, images);
}

std::vector<SourceRemark> remarks_on(const DepthNames& names, const ros::CameraInfo* info) {
  std::vector<SourceRemark> remarks;
  if (names.image_frame != names.depth_frame && !names.depth_frame.empty()) {
    remarks.push_back({"depth in the frame " + names.depth_frame + ", its image in " + names.image_frame +
                           ": is it aligned to the image?",
                       0, names.depth_topic, false, false});
  }
  if (info != nullptr && is_raw(names.image_topic) &&
      std::ranges::any_of(info->d, [](double d) { return d != 0; })) {
    remarks.push_back(
        {"image with distortion, expected a rectified one: positions away from its centre are off", 0,
         names.image_topic, false, false});
  }
  return remarks;
}

void complete(io::Calibration& calibration, const RosDepth& first) {
  if (calibration.rig || !calibration.one_camera) return;
  if (!first.of_message) {
    calibration.rig = io::rig_of_depth(calibration);
  } else if (first.of_message->focal_px > 0 && first.of_message->baseline_m > 0) {
    calibration.rig = calibration.one_camera;
    calibration.rig->focal_px = first.of_message->focal_px;
    calibration.rig->baseline_m = first.of_message->baseline_m;
  }
}

void check_baseline(const io::Calibration& calibration, const RosDepth& first, const std::string& source) {
  if (calibration.rig || first.of_message) return;
  throw Error(
      source +
      ": has no baseline, without which no right image can check depths in m: expected camera_info of both "
      "cameras, or --calib FILE with baseline=");
}

std::string unchecked_on(const std::string& topic) {
  return "depth not checked, without a right image on " + topic;
}

Image<float> disparity_of(const RosDepth& depth, Size image, const std::optional<StereoRig>& rig,
                          const Pool& pool) {
  if (depth.values.size() != image) {
    throw Error("is " + text(depth.values.size()) + ", its image " + text(image) +
                ", expected depth for each pixel of the image (align_depth, depth_registered)");
  }
  if (!depth.of_message) {
    if (!rig)
      throw Error("is a depth image, which needs the focal length: expected camera_info, or --calib FILE");
    return disparity_of_depth(depth.values, *rig, pool);
  }
  Image<float> disparity_px = depth.values.clone(pool);
  const float offset = rig ? rig->doffs_px : 0.0F;
  for (int y = 0; y < disparity_px.height(); ++y) {
    std::for_each(disparity_px.row(y), disparity_px.row(y) + disparity_px.width(), [&](float& d) {
      d -= offset;
      if (std::abs(d) > kMaxDisparity) d = kHole;
    });
  }
  return disparity_px;
}

}  // namespace cairn::input
