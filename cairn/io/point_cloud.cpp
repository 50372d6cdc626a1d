// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <bit>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/point_cloud.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>

namespace cairn::io {
namespace {

/// Little-endian on every machine.
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

struct Vertices {
  std::string bytes;
  std::size_t count = 0;

  void add(Vec3 at, Rgb colour) {
    for (const float coordinate : {at.x, at.y, at.z}) append(bytes, coordinate);
    append(bytes, colour);
    ++count;
  }
};

/// Calls visit(x, y, point, colour) for each pixel with a point, in raster order.
template <class Visit>
void for_each_point(View<const Gray> left, View<const Rgb> left_rgb, View<const float> disparity_px,
                    const StereoRig& rig, const Visit& visit) {
  for (int y = 0; y < disparity_px.height(); ++y) {
    for (int x = 0; x < disparity_px.width(); ++x) {
      if (std::isnan(disparity_px(x, y))) continue;
      const auto point =
          rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), disparity_px(x, y));
      if (!point) continue;
      const Gray grey = left(x, y);
      visit(x, y, *point, left_rgb.empty() ? Rgb{grey, grey, grey} : left_rgb(x, y));
    }
  }
}

}  // namespace

void save_ply(const std::filesystem::path& path, View<const Gray> left, View<const Rgb> left_rgb,
              View<const float> disparity_px, View<const ObjectId> objects, const StereoRig& rig) {
  Vertices all;
  for_each_point(left, left_rgb, disparity_px, rig, [&](int x, int y, Vec3 at, Rgb colour) {
    all.add(at, colour);
    if (!objects.empty()) append(all.bytes, static_cast<std::uint32_t>(number(objects(x, y))));
  });
  write_file(path, header(all.count, !objects.empty()) + all.bytes);
}

void save_object_plys(const std::filesystem::path& folder, View<const Gray> left, View<const Rgb> left_rgb,
                      View<const float> disparity_px, const Objects& objects, const StereoRig& rig) {
  std::map<ObjectId, Vertices> clouds;
  for (const Object& object : objects.list) clouds[object.id];
  for_each_point(left, left_rgb, disparity_px, rig, [&](int x, int y, Vec3 at, Rgb colour) {
    const auto own = clouds.find(objects.labels(x, y));
    if (own != clouds.end()) own->second.add(at, colour);
  });
  make_folder(folder);
  for (const auto& [id, cloud] : clouds)
    write_file(folder / (std::to_string(number(id)) + ".ply"), header(cloud.count, false) + cloud.bytes);
}

}  // namespace cairn::io
