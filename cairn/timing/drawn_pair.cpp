// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/timing/drawn_pair.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace cairn::timing {
namespace {

/// A surface of disparity d = rise·y + level within a rectangle, in px of the left image.
struct Surface {
  float rise = 0;
  float level = 0;
  float x_first = -1e6F, x_last = 1e6F;
  float y_first = -1e6F, y_last = 1e6F;
  std::array<float, 3> colour{};  // r, g, b of 0 … 255, before the texture
  float contrast = 0;             // of the texture, grey levels
  float tile_px = 0;              // side of its tiles; 0 = untiled
  std::uint32_t seed = 0;

  [[nodiscard]] float disparity_at(float y) const { return rise * y + level; }
  [[nodiscard]] bool holds(float x, float y) const {
    return x >= x_first && x < x_last && y >= y_first && y < y_last;
  }
};

struct Room {
  std::vector<Surface> surfaces;  // the wall comes first
  float detail_px = 1;            // width of the finest texture
};

std::uint32_t mixed(std::uint32_t v) {
  v ^= v >> 16;
  v *= 0x7feb352dU;
  v ^= v >> 15;
  v *= 0x846ca68bU;
  return v ^ (v >> 16);
}

/// Noise in −1 … 1 at grid points.
float random_at(int x, int y, std::uint32_t seed) {
  const std::uint32_t bits =
      mixed(static_cast<std::uint32_t>(x) + mixed(static_cast<std::uint32_t>(y) + mixed(seed)));
  return static_cast<float>(bits >> 8) / 8388608.0F - 1.0F;
}

/// Noise at any point, by bilinear interpolation.
float smooth_noise(float x, float y, std::uint32_t seed) {
  const float x_floor = std::floor(x);
  const float y_floor = std::floor(y);
  const auto ix = static_cast<int>(x_floor);
  const auto iy = static_cast<int>(y_floor);
  const auto row = [&](int at) {
    return std::lerp(random_at(ix, at, seed), random_at(ix + 1, at, seed), x - x_floor);
  };
  return std::lerp(row(iy), row(iy + 1), y - y_floor);
}

/// The grey level of a surface's texture at a point of the left image, summed over scales as in natural
/// images.
float texture(const Surface& surface, float x, float y, float detail_px) {
  float sum = 0;
  float cell_px = detail_px;
  constexpr std::array kShares{0.3F, 0.3F, 0.4F, 0.5F};
  for (std::uint32_t octave = 0; octave < kShares.size(); ++octave) {
    sum += kShares[octave] * smooth_noise(x / cell_px, y / cell_px, surface.seed + octave);
    cell_px *= 3;
  }
  if (surface.tile_px > 0) {
    const auto tile = [&](float v) { return static_cast<int>(std::floor(v / surface.tile_px)); };
    sum += 0.7F * random_at(tile(x), tile(y), surface.seed + 9);
  }
  return surface.contrast * sum;
}

/// The nearest surface hit by a ray of the right (or left) camera, and where the left image shows that point.
/// Disparity does not change along x, so a row of one image is a row of the other.
struct Hit {
  const Surface* surface;
  float x_left;
  float disparity_px;
};

Hit nearest_hit(const Room& room, float x, float y, bool right) {
  const auto hit_of = [&](const Surface& surface) {
    const float disparity = surface.disparity_at(y);
    return Hit{&surface, right ? x + disparity : x, disparity};
  };
  Hit nearest = hit_of(room.surfaces.front());  // the wall, which is unbounded
  for (const Surface& surface : room.surfaces) {
    const Hit hit = hit_of(surface);
    if (hit.disparity_px > nearest.disparity_px && surface.holds(hit.x_left, y)) nearest = hit;
  }
  return nearest;
}

Rgb colour_of(const Hit& hit, float y, float detail_px, float noise) {
  const float grey = texture(*hit.surface, hit.x_left, y, detail_px) + noise;
  const auto channel = [&](float base) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(base + grey, 0.0F, 255.0F)));
  };
  const auto& [r, g, b] = hit.surface->colour;
  return {channel(r), channel(g), channel(b)};
}

Image<Rgb> seen(const Room& room, Size size, bool right) {
  constexpr float kSensorNoise = 2;  // grey levels at most
  Image<Rgb> image(size);
  for (int y = 0; y < size.height; ++y) {
    const auto row = static_cast<float>(y);
    for (int x = 0; x < size.width; ++x) {
      const float noise = kSensorNoise * random_at(x, y, right ? 2 : 1);
      image(x, y) =
          colour_of(nearest_hit(room, static_cast<float>(x), row, right), row, room.detail_px, noise);
    }
  }
  return image;
}

Image<Gray> grey_of(const Image<Rgb>& image) {
  Image<Gray> grey(image.size());
  for (int y = 0; y < grey.height(); ++y) {
    std::transform(image.row(y), image.row(y) + image.width(), grey.row(y),
                   [](Rgb p) { return static_cast<Gray>((77 * p.r + 150 * p.g + 29 * p.b + 128) >> 8); });
  }
  return grey;
}

struct BoxPlan {
  float x;         // of its centre, share of the width
  float width;     // share of the width, scaled to the bottom row
  float height;    // share of the height, scaled likewise
  float nearness;  // its disparity, as a share of the largest
  std::array<float, 3> colour;
  float contrast;
};
constexpr std::array kBoxes{BoxPlan{0.16F, 0.30F, 0.62F, 0.42F, {150, 70, 60}, 34},
                            BoxPlan{0.36F, 0.14F, 0.30F, 0.82F, {70, 110, 160}, 26},
                            BoxPlan{0.52F, 0.36F, 0.50F, 0.33F, {170, 150, 80}, 38},
                            BoxPlan{0.66F, 0.17F, 0.48F, 0.61F, {80, 140, 90}, 22},
                            BoxPlan{0.85F, 0.26F, 0.80F, 0.53F, {120, 90, 140}, 40},
                            BoxPlan{0.93F, 0.12F, 0.26F, 0.88F, {190, 120, 70}, 28}};

constexpr float kHorizon = 0.30F;  // share of the height

Room room_of(Size size, float largest_disparity_px) {
  constexpr float kWallNearness = 0.2F;
  const auto width = static_cast<float>(size.width);
  const auto height = static_cast<float>(size.height);
  const float horizon = kHorizon * height;
  const float rise = largest_disparity_px / (height - horizon);
  Room room;
  room.detail_px = std::max(1.5F, height / 240);
  room.surfaces.push_back({.level = kWallNearness * largest_disparity_px,
                           .colour = {165, 168, 160},
                           .contrast = 14,
                           .tile_px = height / 5,
                           .seed = 200});
  room.surfaces.push_back({.rise = rise,
                           .level = -rise * horizon,
                           .y_first = horizon,
                           .colour = {125, 118, 110},
                           .contrast = 18,
                           .tile_px = height / 9,
                           .seed = 100});
  std::uint32_t seed = 300;
  for (const BoxPlan& box : kBoxes) {
    const float foot = horizon + box.nearness * (height - horizon);
    const float half = 0.5F * box.width * box.nearness * width;
    room.surfaces.push_back({.level = box.nearness * largest_disparity_px,
                             .x_first = box.x * width - half,
                             .x_last = box.x * width + half,
                             .y_first = foot - box.height * box.nearness * height,
                             .y_last = foot,
                             .colour = box.colour,
                             .contrast = box.contrast,
                             .seed = seed += 100});
  }
  return room;
}

/// Baseline and focal length that place the floor 0.6 m below the camera.
StereoRig rig_of(Size size, float largest_disparity_px) {
  constexpr float kCameraHeight = 0.6F;  // m
  const float below_horizon = (1 - kHorizon) * static_cast<float>(size.height);
  return {.focal_px = 0.85F * static_cast<float>(size.width),
          .cx_px = 0.5F * static_cast<float>(size.width - 1),
          .cy_px = kHorizon * static_cast<float>(size.height),
          .baseline_m = kCameraHeight * largest_disparity_px / below_horizon};
}

}  // namespace

DrawnPair draw_pair(Size size, float largest_disparity_px) {
  const Room room = room_of(size, largest_disparity_px);
  DrawnPair drawn;
  drawn.left_rgb = seen(room, size, false);
  drawn.right_rgb = seen(room, size, true);
  drawn.left = grey_of(drawn.left_rgb);
  drawn.right = grey_of(drawn.right_rgb);
  drawn.rig = rig_of(size, largest_disparity_px);
  drawn.disparity_px = Image<float>(size);
  drawn.hidden = Image<std::uint8_t>(size);
  for (int y = 0; y < size.height; ++y) {
    const auto row = static_cast<float>(y);
    for (int x = 0; x < size.width; ++x) {
      const Hit hit = nearest_hit(room, static_cast<float>(x), row, false);
      const float x_right = hit.x_left - hit.disparity_px;
      drawn.disparity_px(x, y) = hit.disparity_px;
      drawn.hidden(x, y) =
          x_right < 0 || nearest_hit(room, x_right, row, true).disparity_px > hit.disparity_px + 0.01F ? 1
                                                                                                       : 0;
    }
  }
  return drawn;
}

DrawnPair draw_pair(Size size, const MatchConfig& match) {
  constexpr float kShareOfRange = 0.75F;
  const int farthest_seen =
      match.min_disparity + static_cast<int>(kShareOfRange * static_cast<float>(match.num_disparities));
  return draw_pair(size, static_cast<float>(std::max(1, farthest_seen)));
}

}  // namespace cairn::timing
