// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/ros/from_step.hpp>
#include <cairn/ros/mcap.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

/// Recordings for tests.
namespace cairn::recordings {

inline std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
inline void write(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// Random dots, different in every image.
inline Image<Gray> dots(Size size, unsigned seed) {
  std::mt19937 random(seed);
  Image<Gray> image(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) image(x, y) = static_cast<Gray>(random() % 256);
  return image;
}

/// An MCAP file with camera topics.
class CameraFile {
 public:
  explicit CameraFile(const std::filesystem::path& path, const ros::McapOptions& options = {.sync = false})
      : file_(path, options) {}
  template <class M>
  std::uint16_t topic(const std::string& name) {
    return file_.channel(name, M::kType, ros::schema_of<M>());
  }
  template <class M>
  void add(std::uint16_t channel, Stamp stamp, const M& message) {
    file_.message(channel, stamp, ros::encode(message));
  }
  ros::McapWriter& file() { return file_; }

 private:
  ros::McapWriter file_;
};

}  // namespace cairn::recordings
