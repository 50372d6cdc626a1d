// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "lab/worlds/looks.hpp"

#include <algorithm>
#include <cmath>

#include "lab/worlds/shapes.hpp"

namespace cairn::worlds {
namespace {

std::uint32_t hash(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8DA6B343U ^
                    static_cast<std::uint32_t>(y) * 0xD8163841U ^
                    static_cast<std::uint32_t>(z) * 0xCB1AB31FU ^ seed;
  h = (h ^ (h >> 16U)) * 0x85EBCA6BU;
  h = (h ^ (h >> 13U)) * 0xC2B2AE35U;
  return h ^ (h >> 16U);
}
/// `shift` picks the bits: one hash gives several numbers 0 … 1.
float share_of(std::uint32_t h, unsigned shift = 0) {
  return static_cast<float>((h >> shift) & 0xFFU) / 255;
}
std::int32_t cell(float x) {
  return static_cast<std::int32_t>(std::floor(std::clamp(x, -1e6F, 1e6F)));
}
float part_of(float x) {
  return x - std::floor(x);
}

/// Value noise, −1 … 1.
float noise(Vec3 p, std::uint32_t seed) {
  const std::int32_t x = cell(p.x), y = cell(p.y), z = cell(p.z);
  const auto eased = [](float t) { return t * t * (3 - 2 * t); };
  const float u = eased(part_of(p.x)), v = eased(part_of(p.y)), w = eased(part_of(p.z));
  float sum = 0;
  for (int k = 0; k < 8; ++k) {
    const int a = k & 1, b = (k >> 1) & 1, c = k >> 2;
    const float weight = (a ? u : 1 - u) * (b ? v : 1 - v) * (c ? w : 1 - w);
    sum += weight * share_of(hash(x + a, y + b, z + c, seed));
  }
  return 2 * sum - 1;
}

float fractal(Vec3 p, std::uint32_t seed, int octaves) {
  float sum = 0, scale = 0.5F;
  for (int k = 0; k < octaves; ++k, scale *= 0.5F) {
    sum += scale * noise(p, seed + static_cast<std::uint32_t>(k));
    p = 2.03F * p;
  }
  return sum;
}

Vec3 hsv(float hue, float saturation, float value) {
  const auto channel = [&](float n) {
    const float k = std::fmod(n + hue * 6, 6.0F);
    return std::pow(value * (1 - saturation * std::clamp(std::min(k, 4 - k), 0.0F, 1.0F)), 2.2F);
  };
  return {channel(5), channel(3), channel(1)};
}

Vec3 random_colour(Dice& dice) {
  const float hue = draw(dice, 0, 1), s = draw(dice, 0, 1), v = draw(dice, 0, 1);
  const double kind = dice.unit();
  if (kind < 0.3) return hsv(hue, 0.55F + 0.45F * s, 0.3F + 0.65F * v);
  if (kind < 0.45) return hsv(hue, 0.1F + 0.25F * s, 0.7F + 0.25F * v);
  if (kind < 0.6) return hsv(hue, 0.08F * s, 0.2F + 0.6F * v);
  if (kind < 0.7) return hsv(hue, 0.3F * s, 0.06F + 0.16F * v);
  if (kind < 0.85) return hsv(hue, 0.05F * s, 0.85F + 0.1F * v);
  return hsv(0.05F + 0.07F * hue, 0.25F + 0.45F * s, 0.25F + 0.6F * v);  // wood tones
}

/// Greys, beiges and browns, now and then a pale blue or green; no red, which is a validation set's.
Vec3 floor_colour(Dice& dice) {
  const float s = draw(dice, 0, 1), v = draw(dice, 0.15, 0.92);
  const double kind = dice.unit();
  if (kind < 0.5) return hsv(0.1F, 0.06F * s, v);
  if (kind < 0.85) return hsv(draw(dice, 0.075, 0.13), 0.15F + 0.35F * s, 0.3F + 0.6F * v);
  return hsv(draw(dice, 0.3, 0.65), 0.05F + 0.25F * s, v);
}

Vec3 clamped(Vec3 c) {
  return {std::clamp(c.x, 0.0F, 1.0F), std::clamp(c.y, 0.0F, 1.0F), std::clamp(c.z, 0.0F, 1.0F)};
}
/// Nearly the same colour: white on white, dark on dark.
Vec3 similar(Dice& dice, Vec3 colour) {
  const float factor = dice.chance(0.5) ? draw(dice, 0.6, 0.9) : draw(dice, 1.12, 1.5);
  return clamped(factor * colour + Vec3{0.004F, 0.004F, 0.004F});
}

/// Discs and polygons that cover each other, their sizes by a power law (Lee, Mumford and Huang 2001).
TextureImage leaves_image(Dice& dice, const std::array<Vec3, 4>& palette) {
  std::vector<std::array<std::uint8_t, 3>> image(kImageSide * kImageSide);
  const auto encoded = [](float x) {
    return static_cast<std::uint8_t>(255 * std::sqrt(std::clamp(x, 0.0F, 1.0F)) + 0.5F);
  };
  const float least = draw(dice, 1.5, 4), contrast = draw(dice, 0.1, 0.6);
  for (int leaf = 0; leaf < 900; ++leaf) {
    // Large ones first, or they would hide the small ones.
    const float most = leaf < 60 ? 110.0F : 40.0F;
    const float u = draw(dice, 0, 1), low = 1 / (least * least), high = 1 / (most * most);
    const float radius = leaf < 60 ? draw(dice, 30, 110) : 1 / std::sqrt(low + u * (high - low));
    const float x0 = draw(dice, 0, kImageSide), y0 = draw(dice, 0, kImageSide), phase = draw(dice, 0, 6);
    const int sides = dice.chance(0.5) ? 0 : dice.between(3, 6);
    const float tone = draw(dice, 1 - contrast, 1 + contrast);
    const Vec3 colour = tone * dice.pick(palette);
    const std::array<std::uint8_t, 3> value{encoded(colour.x), encoded(colour.y), encoded(colour.z)};
    const float inner = sides == 0 ? radius : radius * std::cos(kPi / static_cast<float>(sides));
    for (int y = static_cast<int>(y0 - radius); y <= static_cast<int>(y0 + radius); ++y) {
      for (int x = static_cast<int>(x0 - radius); x <= static_cast<int>(x0 + radius); ++x) {
        const float dx = static_cast<float>(x) - x0, dy = static_cast<float>(y) - y0;
        const float square = dx * dx + dy * dy;
        bool inside = square < inner * inner;
        if (!inside && sides > 0 && square < radius * radius) {  // the side that this direction looks at
          const float sector = 2 * kPi / static_cast<float>(sides);
          const float angle = std::atan2(dy, dx) + phase + 8 * kPi;
          inside = std::sqrt(square) * std::cos(std::fmod(angle, sector) - sector / 2) < inner;
        }
        if (inside) {
          image[static_cast<std::size_t>((y & (kImageSide - 1)) * kImageSide + (x & (kImageSide - 1)))] =
              value;
        }
      }
    }
  }
  return std::make_shared<const std::vector<std::array<std::uint8_t, 3>>>(std::move(image));
}

Vec3 image_at(const Look& look, Vec2 at) {
  const float x = part_of(at.x) * kImageSide, y = part_of(at.y) * kImageSide;
  const auto texel = [&](int column, int row) {
    const auto& c = (*look.image)[static_cast<std::size_t>((row & (kImageSide - 1)) * kImageSide +
                                                           (column & (kImageSide - 1)))];
    const Vec3 root =
        1 / 255.0F * Vec3{static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
    return Vec3{root.x * root.x, root.y * root.y, root.z * root.z};
  };
  const int i = cell(x), j = cell(y);
  const Vec3 above = mix(texel(i, j), texel(i + 1, j), part_of(x));
  return mix(above, mix(texel(i, j + 1), texel(i + 1, j + 1), part_of(x)), part_of(y));
}

/// Rows of words of letters of three by five dots.
Vec3 label_at(const Look& look, Vec2 at) {
  const float x = part_of(at.x), y = part_of(at.y), margin = 0.08F;
  if (x > look.share || y > look.share) return look.colours[0];
  if (x < margin || y < margin || x > look.share - margin || y > look.share - margin) return look.colours[1];
  const float height = 0.05F + 0.12F * share_of(look.seed), row = y / height, letter = x / (0.6F * height);
  const std::uint32_t h = hash(cell(letter), cell(row), 0, look.seed);
  const int column = cell(part_of(letter) * 4), line = cell(part_of(row) * 7) - 1;
  const bool blank = share_of(h, 24) < 0.2F || column > 2 || line < 0 || line > 4;
  return blank || ((h >> static_cast<unsigned>(line * 3 + column)) & 1U) == 0 ? look.colours[1]
                                                                              : look.colours[2];
}

float rings(const Look& look, Vec3 p) {
  const Vec3 across = p - dot(p, look.axis) * look.axis;
  const Vec3 fine = 1 / look.period.x * (across + 0.08F * dot(p, look.axis) * look.axis);
  const float r = length(fine) + 1.5F * noise(0.4F * fine, look.seed);
  return part_of(r) * part_of(r) * 0.7F + 0.3F * share_of(hash(cell(r), 0, 0, look.seed));
}

Vec3 weave_at(const Look& look, Vec2 at) {
  const int i = cell(at.x), j = cell(at.y);
  const bool over = ((i + j) & 1) != 0;
  const std::uint32_t h = hash(over ? i / 6 : 0, over ? 0 : j / 6, over, look.seed);
  const float round = std::sin(kPi * part_of(over ? at.x : at.y));
  const Vec3 colour = look.colours[share_of(h) < look.share ? 1 : 0];
  return (0.55F + 0.45F * round) * colour;
}

Vec3 tile_at(const Look& look, Vec2 at, Vec2 uv) {
  const int row = cell(at.y);
  const float random = share_of(hash(row, 7, 0, look.seed));
  const float x = at.x + (look.shift > 1 ? random : look.shift * static_cast<float>(row & 1));
  const int column = cell(x);
  const float in_x = part_of(x) * look.period.x, in_y = part_of(at.y) * look.period.y;
  if (std::min(in_x, in_y) < look.share) return look.colours[2];
  const std::uint32_t h = hash(column, row, 3, look.seed);
  float tone = 1 + look.variation * (2 * share_of(h) - 1);
  if (look.grain > 0) {
    const Vec3 grain{uv.x * 3 * look.turn.x + uv.y * 3 * look.turn.y, in_y * 60, 9 * share_of(h, 8)};
    tone += look.grain * fractal(grain, look.seed, 3);
  }
  return tone * look.colours[look.checker && ((column + row) & 1) != 0 ? 1 : 0];
}

/// The nearest of points scattered one a cell; small ones leave the ground visible.
Vec3 pebble_at(const Look& look, Vec2 at) {
  const int x = cell(at.x), y = cell(at.y);
  float best = 9;
  std::uint32_t which = 0;
  for (int j = y - 1; j <= y + 1; ++j) {
    for (int i = x - 1; i <= x + 1; ++i) {
      const std::uint32_t h = hash(i, j, 5, look.seed);
      const float dx = static_cast<float>(i) + share_of(h) - at.x,
                  dy = static_cast<float>(j) + share_of(h, 8) - at.y;
      const float distance = (dx * dx + dy * dy) / (0.3F + share_of(h, 16));
      if (distance < best) best = distance, which = h;
    }
  }
  if (best > look.share) return look.colours[0];
  const float tone =
      (1 + look.variation * (2 * share_of(which, 24) - 1)) * (1 - 0.4F * look.variation * best / look.share);
  return tone * look.colours[1 + (which >> 20U) % 3];
}

Vec3 albedo_at(const Look& look, Vec2 uv, Vec3 point) {
  const Vec2 turned_uv{look.turn.x * uv.x + look.turn.y * uv.y, look.turn.x * uv.y - look.turn.y * uv.x};
  const Vec2 at{turned_uv.x / look.period.x, turned_uv.y / look.period.y};
  const auto& [first, second, third, fourth] = look.colours;
  switch (look.pattern) {
    case Pattern::plain:
      return first;
    case Pattern::two_tone:
      return part_of(dot(point, look.axis) / look.period.x) < look.share ? second : first;
    case Pattern::stripes:
      return part_of(at.x) < look.share ? second : (cell(at.x) % 3 == 0 ? third : first);
    case Pattern::checks:
      return ((cell(at.x) + cell(at.y)) & 1) != 0 ? second : first;
    case Pattern::dots: {
      const float x = part_of(at.x + 0.5F * static_cast<float>(cell(at.y) & 1)) - 0.5F,
                  y = part_of(at.y) - 0.5F;
      return x * x + y * y < 0.2F * look.share ? second : first;
    }
    case Pattern::label:
      return label_at(look, at);
    case Pattern::wood:
      return mix(first, second, rings(look, point));
    case Pattern::weave:
      return weave_at(look, at);
    case Pattern::dead_leaves:
      return look.image ? image_at(look, at) : first;
    case Pattern::noise: {
      const Vec3 q = 1 / look.period.x * point;
      return mix(first, second, 0.5F + look.share * fractal(q, look.seed, 4));
    }
    case Pattern::tiles:
      return tile_at(look, at, uv);
    case Pattern::pebbles:
      return pebble_at(look, at);
    case Pattern::carpet: {
      const float x = std::abs(turned_uv.x), y = std::abs(turned_uv.y);
      const float inside = std::min(look.period.x - x, look.period.y - y);
      if (inside < 0) return fourth;
      if (inside < look.share) return third;
      return mix(first, second, 0.5F + 0.8F * fractal({120 * uv.x, 120 * uv.y, 0}, look.seed, 2));
    }
  }
  return first;
}

/// Ellipses, rectangles and irregular spots, at most one in each square of a grid.
Vec3 with_marks(const Look& look, Vec2 uv, Vec3 albedo) {
  const Vec2 at{uv.x / look.marks_period, uv.y / look.marks_period};
  const int x = cell(at.x), y = cell(at.y);
  for (int j = y - 1; j <= y + 1; ++j) {
    for (int i = x - 1; i <= x + 1; ++i) {
      const std::uint32_t h = hash(i, j, 11, look.seed), more = hash(i, j, 12, look.seed);
      if (share_of(h) >= look.marks) continue;
      const float angle = 2 * kPi * share_of(more), radius = 0.08F + 0.4F * share_of(more, 8);
      const float dx = at.x - static_cast<float>(i) - share_of(h, 8),
                  dy = at.y - static_cast<float>(j) - share_of(h, 16);
      const float u = (std::cos(angle) * dx + std::sin(angle) * dy) / radius,
                  v = (std::cos(angle) * dy - std::sin(angle) * dx) / radius /
                      (0.3F + 0.7F * share_of(more, 16));
      const int shape = static_cast<int>(more >> 24U) % 3;
      float r = shape == 0 ? std::max(std::abs(u), std::abs(v)) : std::sqrt(u * u + v * v);
      if (shape == 1) r += 0.35F * noise({2 * u, 2 * v, 0}, more);
      const float inside = r >= 1 ? 0 : look.marks_edge == 0 ? 1 : std::min(1.0F, (1 - r) / look.marks_edge);
      Vec3 colour = look.mark_colours[h >> 31U];
      if (r < 1 && r > 1 - look.rim) {
        // Turned by `angle`, the light comes from the same side for all marks of a look.
        const float towards = (std::cos(angle) * u - std::sin(angle) * v) / std::max(r, 0.1F);
        colour = (1 + look.rim_relief * towards) * look.rim_colour;
      }
      albedo = mix(albedo, colour, inside);
    }
  }
  return albedo;
}

void turn_pattern(Look& look, float angle) {
  look.turn = {std::cos(angle), std::sin(angle)};
}

Look base(Dice& dice, Pattern pattern, double glossy, double mirroring) {
  Look look;
  look.pattern = pattern;
  look.seed = static_cast<std::uint32_t>(dice.bits());
  const double kind = dice.unit();
  look.gloss = draw(dice, 0, 0.015);
  if (kind < glossy) look.gloss = draw(dice, 0.03, 0.08), look.roughness = draw(dice, 0.08, 0.5);
  if (kind < mirroring) look.gloss = draw(dice, 0.06, 0.4), look.roughness = draw(dice, 0, 0.1);
  look.wear = dice.chance(0.25) ? 0 : draw(dice, 0, 0.15);
  look.wear_period = static_cast<float>(dice.log_uniform(0.02, 0.2));
  return look;
}

/// Large surfaces are hardly ever of one colour everywhere.
void worn(Look& look, Dice& dice) {
  look.wear = dice.chance(0.08) ? 0 : draw(dice, 0.08, 0.5);
  look.wear_period = static_cast<float>(dice.log_uniform(0.06, 0.5));
}

Look tiled(Dice& dice, Vec2 size, float joint, float variation) {
  Look look = base(dice, Pattern::tiles, 0.5, 0.2);
  look.colours = {floor_colour(dice), floor_colour(dice), floor_colour(dice), {}};
  look.period = size;
  look.share = joint;
  look.variation = variation;
  return look;
}

}  // namespace

Look random_look(Dice& dice) {
  using enum Pattern;
  static constexpr std::array kKinds{stripes, checks,      dots,        label,       label, wood,
                                     weave,   dead_leaves, dead_leaves, dead_leaves, noise, noise};
  const double simple = dice.unit();
  const Pattern pattern = simple < 0.38 ? plain : simple < 0.5 ? two_tone : dice.pick(kKinds);
  Look look = base(dice, pattern, 0.4, 0.1);
  const bool close = dice.chance(0.25);  // colours that hardly differ
  for (Vec3& colour : look.colours)
    colour = close && &colour != look.colours.data() ? similar(dice, look.colours[0]) : random_colour(dice);
  turn_pattern(look, dice.chance(0.6) ? 0 : draw(dice, 0, kPi));
  const auto size = static_cast<float>(dice.log_uniform(0.01, 0.12));
  look.period = {size, dice.chance(0.7) ? size : size * draw(dice, 0.5, 2)};
  look.share = draw(dice, 0.2, 0.8);
  look.axis = unit({draw(dice, -0.3, 0.3), draw(dice, -0.3, 0.3), 1});
  if (pattern == stripes && dice.chance(0.6)) look.colours[2] = look.colours[0];
  if (pattern == two_tone) look.period.x = draw(dice, 0.15, 1);
  if (pattern == label)
    look.period = {5 * look.period.x, 4 * look.period.y}, look.share = draw(dice, 0.5, 0.95);
  if (pattern == weave) look.period = {0.2F * size, 0.2F * size};
  if (pattern == dead_leaves) {
    look.period.x = look.period.y = static_cast<float>(dice.log_uniform(0.15, 1.5));
    look.image = leaves_image(dice, look.colours);
  }
  if (pattern == noise) look.share = draw(dice, 0.5, 1.2);
  if (pattern == wood) {
    const float hue = draw(dice, 0.05, 0.12), value = draw(dice, 0.3, 0.85);
    look.colours = {hsv(hue, 0.5F, value), hsv(hue, 0.6F, value * draw(dice, 0.55, 0.9)), {}, {}};
    look.axis = unit({draw(dice, -1, 1), draw(dice, -1, 1), draw(dice, -1, 1)});
    look.period.x = draw(dice, 0.004, 0.02);
  }
  return look;
}

Look floor_look(Dice& dice) {
  const int kind = dice.below(8);
  Look look;
  if (kind == 0) look = base(dice, Pattern::plain, 0.5, 0.25);
  if (kind == 1 || kind == 2) {  // tiles, square or in running bond; checker
    const float w = draw(dice, 0.1, 0.6), h = dice.chance(0.6) ? w : w * draw(dice, 0.4, 0.8),
                joint = draw(dice, 0.002, 0.012);
    look = tiled(dice, {w, h}, joint, draw(dice, 0, 0.15));
    look.shift = dice.chance(0.4) ? 0.5F : 0;
    look.checker = kind == 2 && h == w;
  }
  if (kind == 3) {  // planks
    const Vec2 size{draw(dice, 0.6, 2), draw(dice, 0.06, 0.22)};
    look = tiled(dice, size, draw(dice, 0.001, 0.004), 0.2F);
    const float hue = draw(dice, 0.065, 0.12), value = draw(dice, 0.25, 0.85);
    look.colours[0] = hsv(hue, draw(dice, 0.15, 0.6), value);
    look.colours[2] = 0.3F * look.colours[0];
    look.grain = draw(dice, 0.1, 0.7), look.shift = 2;
  }
  if (kind == 4 || kind == 5) {  // terrazzo or cork
    look = base(dice, Pattern::pebbles, 0.5, 0.25);
    const auto grit =
        static_cast<float>(kind == 4 ? dice.log_uniform(0.008, 0.05) : dice.log_uniform(0.004, 0.01));
    look.period = {grit, grit};
    look.share = kind == 4 ? draw(dice, 0.02, 0.2) : draw(dice, 0.2, 0.6);
    look.variation = draw(dice, 0.1, 0.5);
  }
  if (kind == 6) {
    look = base(dice, Pattern::noise, 0.4, 0.15);
    look.period.x = draw(dice, 0.05, 0.8);
    look.share = draw(dice, 0.4, 1);
  }
  if (kind == 7) {
    look = base(dice, Pattern::carpet, 0, 0);
    look.period = {draw(dice, 0.6, 1.6), draw(dice, 0.5, 1.2)};
    look.share = draw(dice, 0.05, 0.2);
  }
  if (look.pattern != Pattern::tiles) {
    const Vec3 ground = floor_colour(dice);
    look.colours = {ground, similar(dice, ground), similar(dice, ground), floor_colour(dice)};
    if (kind == 4) look.colours = {ground, floor_colour(dice), floor_colour(dice), floor_colour(dice)};
    if (kind == 7) look.colours[2] = random_colour(dice);
  }
  turn_pattern(look, dice.chance(0.5) ? 0 : draw(dice, 0, kPi));
  worn(look, dice);
  return look;
}

Look wall_look(Dice& dice) {
  const int kind = dice.below(10);
  const Pattern pattern = kind < 5    ? Pattern::plain
                          : kind < 7  ? Pattern::noise
                          : kind == 7 ? Pattern::stripes
                          : kind == 8 ? Pattern::dots
                                      : Pattern::tiles;
  Look look = base(dice, pattern, 0.1, 0);
  const float hue = draw(dice, 0, 1), pale = draw(dice, 0, 0.2), value = draw(dice, 0.7, 0.95);
  look.colours[0] = dice.chance(0.75) ? hsv(hue, pale, value) : random_colour(dice);
  for (std::size_t i = 1; i < 4; ++i) look.colours[i] = similar(dice, look.colours[0]);
  const float size = kind == 9 ? draw(dice, 0.1, 0.3) : draw(dice, 0.03, 0.2);
  look.period = {size, size};
  look.share = kind == 9 ? 0.003F : draw(dice, 0.2, 0.6);
  worn(look, dice);
  return look;
}

Look masonry_look(Dice& dice) {
  const float w = draw(dice, 0.2, 0.6), h = w * draw(dice, 0.3, 0.7);
  const float value = draw(dice, 0.2, 0.75), rich = draw(dice, 0, 0.6), hue = draw(dice, 0.02, 0.13);
  const Vec3 stone = hsv(hue, rich, value);
  const float variation = draw(dice, 0.1, 0.4), joint = draw(dice, 0.008, 0.02);
  Look look = tiled(dice, {w, h}, joint, variation);
  look.colours = {stone, similar(dice, stone), draw(dice, 0.5, 1.4) * stone, {}};
  look.shift = dice.chance(0.7) ? 0.5F : 2, look.gloss = 0, look.roughness = 1;
  look.checker = dice.chance(0.3);
  worn(look, dice);
  return look;
}

Look ground_look(Dice& dice) {
  const int kind = dice.below(4);
  const float v = draw(dice, 0.2, 0.6), hue = draw(dice, 0.07, 0.13), s = draw(dice, 0, 0.25);
  Look look = base(dice, Pattern::pebbles, 0.05, 0);
  const Vec3 stone = hsv(hue, s, v);
  look.colours = {0.6F * stone, stone, similar(dice, stone), similar(dice, stone)};
  look.variation = draw(dice, 0.2, 0.6);
  const auto grit =
      static_cast<float>(kind == 0 ? dice.log_uniform(0.006, 0.015) : dice.log_uniform(0.015, 0.06));
  look.period = {grit, grit};
  look.share = kind == 0 ? draw(dice, 0.1, 0.4) : draw(dice, 0.35, 0.7);
  if (kind == 2) {  // paving
    const float w = draw(dice, 0.15, 0.8), ratio = dice.chance(0.5) ? 1 : draw(dice, 0.45, 0.9),
                joint = draw(dice, 0.003, 0.015);
    look = tiled(dice, {w, w * ratio}, joint, draw(dice, 0.05, 0.25));
    look.colours = {stone, similar(dice, stone), 0.4F * stone, {}};
    look.shift = dice.chance(0.6) ? 0.5F : 0, look.gloss = 0, look.roughness = 1;
    look.checker = dice.chance(0.2);
  }
  if (kind == 3) {  // lawn
    const float tint = draw(dice, 0.2, 0.32), rich = draw(dice, 0.35, 0.7);
    const Vec3 green = hsv(tint, rich, draw(dice, 0.3, 0.6));
    look.colours = {0.45F * green, green, similar(dice, green), hsv(0.16F, 0.5F, draw(dice, 0.4, 0.7))};
    look.period = {0.006F, draw(dice, 0.01, 0.03)};
    look.variation = 0.6F;
  }
  turn_pattern(look, draw(dice, 0, kPi));
  worn(look, dice);
  return look;
}

void scatter_marks(Look& look, Dice& dice) {
  look.marks = draw(dice, 0.1, 0.6);
  look.marks_period = static_cast<float>(dice.log_uniform(0.08, 1));
  look.marks_edge = dice.chance(0.5) ? 0 : draw(dice, 0.1, 1);
  const float strength = dice.chance(0.5) ? 1 : draw(dice, 0.15, 0.6);
  for (Vec3& colour : look.mark_colours) {
    const Vec3 other = dice.chance(0.4) ? similar(dice, look.colours[0]) : random_colour(dice);
    colour = mix(look.colours[0], other, strength);
  }
  if (!dice.chance(0.4)) return;
  look.rim = draw(dice, 0.03, 0.25);
  look.rim_relief = dice.chance(0.5) ? 0 : draw(dice, 0.1, 0.5);
  look.rim_colour = draw(dice, 0.3, 0.95) * (dice.chance(0.6) ? look.colours[0] : look.mark_colours[0]);
  look.marks_edge = 0;
}

float spots_at(Vec2 direction) {
  constexpr float kSquares = 60, kPresent = 0.7F, kRadius = 0.24F;
  const Vec2 at{kSquares * direction.x, kSquares * direction.y};
  const int i = cell(at.x), j = cell(at.y);
  const std::uint32_t h = hash(i, j, 21, 0);
  if (share_of(h) >= kPresent) return 0;
  const float dx = at.x - static_cast<float>(i) - 0.25F - 0.5F * share_of(h, 8),
              dy = at.y - static_cast<float>(j) - 0.25F - 0.5F * share_of(h, 16);
  return std::clamp(2 * (1 - std::sqrt(dx * dx + dy * dy) / kRadius), 0.0F, 1.0F);
}

Surface surface_at(const Look& look, Vec2 uv, Vec3 point) {
  Vec3 albedo = albedo_at(look, uv, point);
  if (look.wear > 0)
    albedo = (1 + look.wear * fractal(1 / look.wear_period * point, look.seed + 99, 5)) * albedo;
  if (look.marks > 0) albedo = with_marks(look, uv, albedo);
  return {clamped(albedo), look.gloss, look.roughness};
}

}  // namespace cairn::worlds
