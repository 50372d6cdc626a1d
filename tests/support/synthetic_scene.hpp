// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cstdint>
#include <random>
#include <vector>

/// Random-dot stereograms: pairs rendered from known disparities and occlusions.
namespace cairn::synthetic {

/// An upright board parallel to the image plane: its place in the left image, and its disparity.
struct Box {
  Rect rect;
  int disparity_px = 0;
};

struct Layout {
  Size size{96, 64};
  int background_px = 4;     // disparity of the background
  std::vector<Box> boxes{};  // ordered by disparity, not by index: nearer ones occlude
  std::uint32_t seed = 1;
};

struct Scene {
  Image<Gray> left;
  Image<Gray> right;
  Image<float> disparity_px;     // of every left pixel, including those hidden from the right camera
  Image<std::uint8_t> hidden;    // 1 = not visible in the right image
  Image<std::uint16_t> objects;  // 1 + index of the visible box; 0 = background
  [[nodiscard]] StereoPair pair() const { return StereoPair::from(left, right); }
};

inline Image<Gray> random_dots(Size size, std::uint32_t seed) {
  std::mt19937 random(seed);
  Image<Gray> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image(x, y) = static_cast<Gray>(random() >> 24);
  }
  return image;
}

inline Scene make_scene(const Layout& layout) {
  const Size size = layout.size;
  Scene scene{random_dots(size, layout.seed), random_dots(size, layout.seed + 1), Image<float>(size),
              Image<std::uint8_t>(size), Image<std::uint16_t>(size)};
  for (int y = 0; y < size.height; ++y) {
    std::fill_n(scene.disparity_px.row(y), size.width, static_cast<float>(layout.background_px));
    std::fill_n(scene.objects.row(y), size.width, std::uint16_t{0});
  }
  for (std::size_t i = 0; i < layout.boxes.size(); ++i) {
    const auto [rect, disparity] = layout.boxes[i];
    for (int y = std::max(0, rect.y); y < std::min(size.height, rect.y + rect.height); ++y) {
      for (int x = std::max(0, rect.x); x < std::min(size.width, rect.x + rect.width); ++x) {
        if (static_cast<float>(disparity) <= scene.disparity_px(x, y)) continue;
        scene.disparity_px(x, y) = static_cast<float>(disparity);
        scene.objects(x, y) = static_cast<std::uint16_t>(i + 1);
      }
    }
  }
  // Each right pixel shows the nearest left pixel that projects onto it; the other left pixels are hidden.
  // Right pixels without any get dots of their own.
  std::vector<int> shown(static_cast<std::size_t>(size.width));
  for (int y = 0; y < size.height; ++y) {
    std::fill(shown.begin(), shown.end(), -1);
    for (int x = 0; x < size.width; ++x) {
      const int x_right = x - static_cast<int>(scene.disparity_px(x, y));
      if (x_right < 0 || x_right >= size.width) continue;
      int& owner = shown[static_cast<std::size_t>(x_right)];
      if (owner < 0 || scene.disparity_px(owner, y) < scene.disparity_px(x, y)) owner = x;
    }
    std::fill_n(scene.hidden.row(y), size.width, std::uint8_t{1});
    for (int x_right = 0; x_right < size.width; ++x_right) {
      const int owner = shown[static_cast<std::size_t>(x_right)];
      if (owner < 0) continue;
      scene.right(x_right, y) = scene.left(owner, y);
      scene.hidden(owner, y) = 0;
    }
  }
  return scene;
}

/// One box in front of a wall: the smallest scene with an occlusion.
inline Scene box_before_wall(Size size = {96, 64}, int wall_px = 4, int box_px = 12, std::uint32_t seed = 1) {
  const Rect middle{size.width / 3, size.height / 4, size.width / 3, size.height / 2};
  return make_scene({.size = size, .background_px = wall_px, .boxes = {{middle, box_px}}, .seed = seed});
}

}  // namespace cairn::synthetic
