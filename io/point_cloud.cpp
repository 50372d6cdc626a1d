// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <bit>
#include <cmath>
#include <cstdint>
#include <io/atomic_file.hpp>
#include <io/point_cloud.hpp>
#include <string>

namespace cairn::io {
namespace {

/// The lowest byte first, on every machine.
void append(std::string& bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((value >> shift) & 0xff);
}
void append(std::string& bytes, float value) {
  append(bytes, std::bit_cast<std::uint32_t>(value));
}
void append(std::string& bytes, Rgb c) {
  for (const std::uint8_t channel : {c.r, c.g, c.b}) bytes += static_cast<char>(channel);
}

std::string header(std::size_t points, bool with_objects) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\n"
      "comment cairn " CAIRN_VERSION
      "\n"
      "comment metres in the left camera's frame: x right, y down, z forward\n";
  if (with_objects) text += "comment object: the id in objects.json, 0 = none\n";
  text += "element vertex " + std::to_string(points) +
          "\n"
          "property float x\nproperty float y\nproperty float z\n"
          "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (with_objects) text += "property int object\n";
  return text + "end_header\n";
}

}  // namespace

void save_ply(const std::filesystem::path& path, View<const Gray> left, View<const Rgb> left_rgb,
              View<const float> disparity_px, View<const ObjectId> objects, const StereoRig& rig) {
  std::string points;
  std::size_t count = 0;
  for (int y = 0; y < disparity_px.height(); ++y) {
    for (int x = 0; x < disparity_px.width(); ++x) {
      if (std::isnan(disparity_px(x, y))) continue;
      const auto point =
          rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), disparity_px(x, y));
      if (!point) continue;
      ++count;
      for (const float coordinate : {point->x, point->y, point->z}) append(points, coordinate);
      const Gray grey = left(x, y);
      append(points, left_rgb.empty() ? Rgb{grey, grey, grey} : left_rgb(x, y));
      if (!objects.empty()) append(points, static_cast<std::uint32_t>(number(objects(x, y))));
    }
  }
  write_file(path, header(count, !objects.empty()) + points);
}

}  // namespace cairn::io
