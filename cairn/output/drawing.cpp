// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/output/drawing.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace cairn::output::drawing {
namespace {

// ---- lines ----

struct Position {
  float x = 0;
  float y = 0;
};
struct Segment {
  Position from;
  Position to;
};

float distance_to(const Segment& s, Position p) {
  const Position along{s.to.x - s.from.x, s.to.y - s.from.y};
  const float length2 = along.x * along.x + along.y * along.y;
  const float share =
      length2 > 0
          ? std::clamp(((p.x - s.from.x) * along.x + (p.y - s.from.y) * along.y) / length2, 0.0F, 1.0F)
          : 0.0F;
  return std::hypot(p.x - s.from.x - share * along.x, p.y - s.from.y - share * along.y);
}

std::uint8_t mixed(std::uint8_t a, std::uint8_t b, float share_of_b) {
  return static_cast<std::uint8_t>(
      std::lround(static_cast<float>(a) * (1 - share_of_b) + static_cast<float>(b) * share_of_b));
}

/// Draws all segments as one shape, so that joints are not darker than lines.
void draw(Image<Rgb>& canvas, const std::vector<Segment>& segments, float width, Rgb colour) {
  if (segments.empty()) return;
  const float reach = width / 2 + 1;
  float left = segments[0].from.x, right = left, top = segments[0].from.y, bottom = top;
  for (const Segment& s : segments) {
    for (const Position p : {s.from, s.to}) {
      left = std::min(left, p.x);
      right = std::max(right, p.x);
      top = std::min(top, p.y);
      bottom = std::max(bottom, p.y);
    }
  }
  const auto first = [](float at, float margin) {
    return std::max(0, static_cast<int>(std::floor(at - margin)));
  };
  const auto end = [](float at, float margin, int size) {
    return std::min(size, static_cast<int>(std::ceil(at + margin)) + 1);
  };
  const int x0 = first(left, reach), x1 = end(right, reach, canvas.width());
  const int y0 = first(top, reach), y1 = end(bottom, reach, canvas.height());
  if (x0 >= x1 || y0 >= y1) return;
  Image<float> cover({x1 - x0, y1 - y0}, 0.0F, {});
  for (const Segment& s : segments) {
    const int sx1 = end(std::max(s.from.x, s.to.x), reach, x1);
    const int sy1 = end(std::max(s.from.y, s.to.y), reach, y1);
    for (int y = std::max(y0, first(std::min(s.from.y, s.to.y), reach)); y < sy1; ++y) {
      for (int x = std::max(x0, first(std::min(s.from.x, s.to.x), reach)); x < sx1; ++x) {
        const float at = width / 2 + 0.5F - distance_to(s, {static_cast<float>(x), static_cast<float>(y)});
        float& most = cover(x - x0, y - y0);
        most = std::max(most, std::clamp(at, 0.0F, 1.0F));
      }
    }
  }
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const float share = cover(x - x0, y - y0);
      if (share == 0) continue;
      Rgb& pixel = canvas(x, y);
      pixel = {mixed(pixel.r, colour.r, share), mixed(pixel.g, colour.g, share),
               mixed(pixel.b, colour.b, share)};
    }
  }
}

// ---- text ----

// A glyph is a list of strokes, separated by blanks; a stroke is a list of points, two digits each: column and row,
// counted from the lower left. Letters stand on row 2; small ones reach row 6, capitals row 8.
constexpr int kBaseline = 2;
constexpr int kCapitalRows = 6;
constexpr float kGap = 1.6F;    // columns between glyphs
constexpr float kBlank = 2.2F;  // columns
constexpr int kFirst = '!';
constexpr std::array<std::string_view, 94> kGlyphs{"0804 0202",
                                                   "0806 2826",
                                                   "1416 3638 0444 0646",
                                                   "4718071535443212 2921",
                                                   "0248 07081817 33324243",
                                                   "42072838272503123243",
                                                   "0806",
                                                   "18070312",
                                                   "08171302",
                                                   "2428 0646 0842",
                                                   "2327 0545",
                                                   "130201",
                                                   "0545",
                                                   "0202",
                                                   "0248",
                                                   "120307183847433212",
                                                   "162822 1232",
                                                   "07183847460242",
                                                   "07183847463525 354443321203",
                                                   "323804 0444",
                                                   "480805354443321203",
                                                   "473818070312324344351504",
                                                   "084812",
                                                   "150607183847463515 1504031232434435",
                                                   "031232434738180706153546",
                                                   "0303 0606",
                                                   "0606 130201",
                                                   "360436",
                                                   "0444 0646",
                                                   "063406",
                                                   "071838474625 2422 2020",
                                                   "42120307183847 4744 34242636",
                                                   "022842 1434",
                                                   "02083847463505 3544433202",
                                                   "4738180703123243",
                                                   "02082846442202",
                                                   "48080242 0535",
                                                   "480802 0535",
                                                   "473818070312324345 2545",
                                                   "0802 4842 0545",
                                                   "0802",
                                                   "3833221203",
                                                   "0802 4804 1542",
                                                   "080242",
                                                   "0208254842",
                                                   "02084248",
                                                   "120307183847433212",
                                                   "02083847463505",
                                                   "120307183847433212 2442",
                                                   "02083847463505 2542",
                                                   "473818070615354443321203",
                                                   "0848 2822",
                                                   "080312324348",
                                                   "082248",
                                                   "0812263248",
                                                   "0842 0248",
                                                   "082548 2522",
                                                   "08480242",
                                                   "18080212",
                                                   "0842",
                                                   "08181202",
                                                   "062846",
                                                   "0242",
                                                   "0817",
                                                   "16364542 441403123243",
                                                   "0802 0516364543321203",
                                                   "4536160503123243",
                                                   "4842 4536160503123243",
                                                   "04444536160503123243",
                                                   "38281712 0636",
                                                   "46413010 4536160503123243",
                                                   "0802 0516364542",
                                                   "0206 0808",
                                                   "161100 1818",
                                                   "0802 4603 1442",
                                                   "080312",
                                                   "0206 05162522 25364542",
                                                   "0206 0516364542",
                                                   "160503123243453616",
                                                   "0600 0516364543321203",
                                                   "4640 4536160503123243",
                                                   "0206 051636",
                                                   "45361605143443321203",
                                                   "18132232 0636",
                                                   "0603123243 4642",
                                                   "062246",
                                                   "0612253246",
                                                   "0642 0246",
                                                   "0622 462210",
                                                   "06460242",
                                                   "28171605141322",
                                                   "0800",
                                                   "08171625141302",
                                                   "05163445"};

struct Glyph {
  std::vector<Segment> segments;  // columns and rows above the baseline
  float width = 0;
};

Glyph glyph_of(char c) {
  const auto index = static_cast<std::size_t>(static_cast<unsigned char>(c) - kFirst);
  if (c == ' ') return {{}, kBlank};
  const std::string_view strokes = index < kGlyphs.size() ? kGlyphs[index] : std::string_view("0208484202");
  Glyph glyph;
  std::vector<Position> stroke;
  const auto end_stroke = [&] {
    for (std::size_t i = 0; i + 1 < stroke.size(); ++i) glyph.segments.push_back({stroke[i], stroke[i + 1]});
    stroke.clear();
  };
  for (std::size_t i = 0; i < strokes.size();) {
    if (strokes[i] == ' ') {
      end_stroke();
      ++i;
      continue;
    }
    const auto column = static_cast<float>(strokes[i] - '0');
    stroke.push_back({column, static_cast<float>(strokes[i + 1] - '0' - kBaseline)});
    glyph.width = std::max(glyph.width, column);
    i += 2;
  }
  end_stroke();
  return glyph;
}

}  // namespace

void fill(Image<Rgb>& canvas, Rect area, Rgb colour) {
  const int x0 = std::clamp(area.x, 0, canvas.width());
  const int x1 = std::clamp(area.x + area.width, x0, canvas.width());
  for (int y = std::max(0, area.y); y < std::min(canvas.height(), area.y + area.height); ++y)
    std::fill(canvas.row(y) + x0, canvas.row(y) + x1, colour);
}

void draw_line(Image<Rgb>& canvas, Point from, Point to, Rgb colour) {
  const auto position = [](Point p) { return Position{static_cast<float>(p.x), static_cast<float>(p.y)}; };
  draw(canvas, {{position(from), position(to)}}, 1, colour);
}

TextExtent text_extent(std::string_view text, float height) {
  float columns = 0;
  for (const char c : text) columns += glyph_of(c).width + kGap;
  const float unit = height / kCapitalRows;
  return {static_cast<int>(std::ceil(columns * unit)), static_cast<int>(std::ceil(height)),
          static_cast<int>(std::ceil(kBaseline * unit))};
}

void draw_text(Image<Rgb>& canvas, std::string_view text, Point at, float height, Rgb colour) {
  const float unit = height / kCapitalRows;
  std::vector<Segment> segments;
  float column = 0;
  for (const char c : text) {
    const Glyph glyph = glyph_of(c);
    const auto placed = [&](Position p) {
      return Position{static_cast<float>(at.x) + (column + p.x) * unit,
                      static_cast<float>(at.y) - p.y * unit};
    };
    for (const Segment& s : glyph.segments) segments.push_back({placed(s.from), placed(s.to)});
    column += glyph.width + kGap;
  }
  constexpr float kStroke = 1.1F;   // px
  constexpr float kOutline = 3.4F;  // px
  draw(canvas, segments, kOutline, {0, 0, 0});
  draw(canvas, segments, kStroke, colour);
}

Image<Rgb> enlarged(const Image<Rgb>& image, int factor) {
  if (factor == 1) return image.clone();
  // The weights of four neighbours for each phase between two pixels; −0.75 is the slope of OpenCV's kernel.
  constexpr float kSlope = -0.75F;
  struct Taps {
    int first = 0;
    std::array<float, 4> weights{};
  };
  const auto taps_at = [&](int i) {
    const float at = (static_cast<float>(i) + 0.5F) / static_cast<float>(factor) - 0.5F;
    const float base = std::floor(at);
    const float t = at - base;
    const auto inner = [](float d) { return ((kSlope + 2) * d - (kSlope + 3)) * d * d + 1; };
    const auto outer = [](float d) { return ((kSlope * d - 5 * kSlope) * d + 8 * kSlope) * d - 4 * kSlope; };
    return Taps{static_cast<int>(base) - 1, {outer(1 + t), inner(t), inner(1 - t), outer(2 - t)}};
  };
  const auto sum = [](const Taps& taps, int size, const auto& pixel) {
    std::array<float, 3> channels{};
    for (int i = 0; i < 4; ++i) {
      const std::array<float, 3> value = pixel(std::clamp(taps.first + i, 0, size - 1));
      for (std::size_t c = 0; c < 3; ++c) channels[c] += taps.weights[static_cast<std::size_t>(i)] * value[c];
    }
    return channels;
  };
  Image<Rgb> large({image.width() * factor, image.height() * factor});
  std::vector<Taps> across;
  across.reserve(static_cast<std::size_t>(large.width()));
  for (int x = 0; x < large.width(); ++x) across.push_back(taps_at(x));
  std::vector<std::array<float, 3>> column(
      static_cast<std::size_t>(image.width()));  // interpolated downwards
  for (int y = 0; y < large.height(); ++y) {
    const Taps down = taps_at(y);
    for (int x = 0; x < image.width(); ++x) {
      column[static_cast<std::size_t>(x)] = sum(down, image.height(), [&](int row) {
        const Rgb p = image(x, row);
        return std::array<float, 3>{static_cast<float>(p.r), static_cast<float>(p.g),
                                    static_cast<float>(p.b)};
      });
    }
    for (int x = 0; x < large.width(); ++x) {
      const auto value = sum(across[static_cast<std::size_t>(x)], image.width(),
                             [&](int i) { return column[static_cast<std::size_t>(i)]; });
      const auto rounded = [&](std::size_t c) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(value[c], 0.0F, 255.0F)));
      };
      large(x, y) = {rounded(0), rounded(1), rounded(2)};
    }
  }
  return large;
}

}  // namespace cairn::output::drawing
