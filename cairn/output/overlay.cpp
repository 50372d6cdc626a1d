// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/output/drawing.hpp>
#include <cairn/output/overlay.hpp>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

namespace cairn::output {
namespace {

constexpr int kLegibleWidth = 640;    // px; narrower images are enlarged to about this
constexpr float kLabelHeight = 9.5F;  // px, of a capital letter
constexpr float kLegendHeightOfText = 9;

int enlargement(Size size) {
  return std::clamp((kLegibleWidth + size.width / 2) / size.width, 1, 4);
}

std::uint8_t mixed(std::uint8_t a, std::uint8_t b, float share_of_b) {
  const float value = static_cast<float>(a) * (1 - share_of_b) + static_cast<float>(b) * share_of_b;
  return static_cast<std::uint8_t>(std::lround(value));
}
Rgb mixed(Rgb a, Rgb b, float share_of_b) {
  return {mixed(a.r, b.r, share_of_b), mixed(a.g, b.g, share_of_b), mixed(a.b, b.b, share_of_b)};
}

Rgb from_hsv(float hue, float saturation, float value) {  // all 0 … 1
  const auto channel = [&](float shift) {
    const float k = std::fmod(shift + hue * 6, 6.0F);
    const float v = value - value * saturation * std::clamp(std::min(k, 4 - k), 0.0F, 1.0F);
    return static_cast<std::uint8_t>(std::lround(v * 255));
  };
  return {channel(5), channel(3), channel(1)};
}

std::string number_text(const char* format, float value) {
  std::array<char, 48> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, static_cast<double>(value));
  return buffer.data();
}

/// A label at a point.
struct Label {
  std::string text;
  drawing::Point middle;
  drawing::TextExtent extent;
};

Label label_at(drawing::Point middle, std::string text) {
  const drawing::TextExtent extent = drawing::text_extent(text, kLabelHeight);
  return {std::move(text), middle, extent};
}

/// The area that it covers when centred on its point.
Rect covered(const Label& label) {
  return {label.middle.x - label.extent.width / 2, label.middle.y - label.extent.above / 2,
          label.extent.width, label.extent.above + label.extent.below};
}

Rect inside(Rect label, Size picture) {
  label.x = std::clamp(label.x, 0, std::max(0, picture.width - label.width));
  label.y = std::clamp(label.y, 0, std::max(0, picture.height - label.height));
  return label;
}

bool overlap(const Rect& a, const Rect& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

/// Places labels at their points, or next to them with a line if others are there already.
void write_labels(Image<Rgb>& canvas, const std::vector<Label>& labels) {
  std::vector<Rect> wanted;
  wanted.reserve(labels.size());
  for (const Label& label : labels) wanted.push_back(covered(label));
  const std::vector<Rect> places = place_labels(wanted, canvas.size());
  const Rgb white{255, 255, 255};
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const Rect& place = places[i];
    const drawing::Point at = labels[i].middle;
    const bool is_inside =
        at.x >= place.x && at.x < place.x + place.width && at.y >= place.y && at.y < place.y + place.height;
    if (!is_inside) {
      drawing::draw_line(canvas, {place.x + place.width / 2, place.y + place.height / 2}, at, white);
    }
  }
  for (std::size_t i = 0; i < labels.size(); ++i) {
    drawing::draw_text(canvas, labels[i].text, {places[i].x, places[i].y + labels[i].extent.above},
                       kLabelHeight, white);
  }
}

/// The enlarged image, with its background faded to grey.
Image<Rgb> enlarged(View<const Gray> left, View<const Rgb> left_rgb, int factor) {
  Image<Rgb> colour(left.size());
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < left.width(); ++x) {
      const Gray grey = left(x, y);
      colour(x, y) = left_rgb.empty() ? Rgb{grey, grey, grey} : left_rgb(x, y);
    }
  }
  return drawing::enlarged(colour, factor);
}

/// The gain that makes the brightest hundredth of the image bright.
float brightening(View<const Gray> left) {
  constexpr int kBright = 200;
  constexpr float kMax = 8;
  std::array<std::int64_t, 256> counts{};
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < left.width(); ++x) ++counts[left(x, y)];
  }
  int level = kBright;
  std::int64_t above = 0;
  for (int i = 255; i > 0; --i) {
    above += counts[static_cast<std::size_t>(i)];
    if (100 * above < left.size().area()) continue;
    level = i;
    break;
  }
  constexpr int kDim = 128;
  return level < kDim ? std::min(static_cast<float>(kBright) / static_cast<float>(level), kMax) : 1.0F;
}

void brighten(Image<Rgb>& canvas, float factor) {
  const auto times = [&](std::uint8_t level) {
    return static_cast<std::uint8_t>(std::lround(std::min(255.0F, factor * static_cast<float>(level))));
  };
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) {
      Rgb& pixel = canvas(x, y);
      pixel = {times(pixel.r), times(pixel.g), times(pixel.b)};
    }
  }
}

constexpr Rgb kFloorTint{90, 150, 190};
constexpr Rgb kStep{255, 210, 60};
constexpr int kStripHeight = 24;

/// The image with a colour legend below it.
Image<Rgb> with_legend(Image<Rgb> picture, bool in_metres, bool has_floor, bool has_steps, float brightened) {
  constexpr int kGap = 18;
  Image<Rgb> whole({picture.width(), picture.height() + kStripHeight}, Rgb{15, 15, 15}, {});
  for (int y = 0; y < picture.height(); ++y) std::copy_n(picture.row(y), picture.width(), whole.row(y));
  const Rgb white{235, 235, 235};
  const int base = whole.height() - 8;
  int x = 8;
  const auto entry = [&](const std::optional<Rgb>& chip, const std::string& text) {
    if (chip) {
      drawing::fill(whole, {x, base - 10, 14, 12}, *chip);
      x += 20;
    }
    drawing::draw_text(whole, text, {x, base}, kLegendHeightOfText, white);
    x += drawing::text_extent(text, kLegendHeightOfText).width + kGap;
  };
  entry(object_colour(ObjectId{1}), std::string("object, id: ") + (in_metres ? "distance" : "disparity"));
  if (has_floor) entry(kFloorTint, "floor");
  if (has_steps) entry(kStep, "step of the ground: height");
  entry(Rgb{110, 110, 110}, "no object");
  if (brightened > 1) entry(std::nullopt, "brightened " + number_text("%.1f x", brightened));
  return whole;
}

void tint(Image<Rgb>& canvas, const Objects& objects, View<const std::uint8_t> floor, int factor) {
  const View<const ObjectId> labels = objects.labels;
  const auto label_at = [&](int x, int y) {
    return labels.contains(x / factor, y / factor) && x >= 0 && y >= 0 ? labels(x / factor, y / factor)
                                                                       : ObjectId::none;
  };
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) {
      Rgb& pixel = canvas(x, y);
      const ObjectId id = label_at(x, y);
      if (id == ObjectId::none) {
        const auto grey = static_cast<std::uint8_t>((77 * pixel.r + 150 * pixel.g + 29 * pixel.b + 128) >> 8);
        pixel = mixed(mixed(pixel, {grey, grey, grey}, 0.6F), {0, 0, 0}, 0.25F);
        if (!floor.empty() && floor(x / factor, y / factor) != 0) pixel = mixed(pixel, kFloorTint, 0.25F);
        continue;
      }
      const bool outline = label_at(x - 1, y) != id || label_at(x + 1, y) != id || label_at(x, y - 1) != id ||
                           label_at(x, y + 1) != id;
      pixel =
          outline ? mixed(object_colour(id), {255, 255, 255}, 0.35F) : mixed(pixel, object_colour(id), 0.45F);
    }
  }
}

/// Draws the lines, and returns their labels.
std::vector<Label> mark_steps(Image<Rgb>& canvas, const std::vector<DrawnStep>& steps, int factor) {
  const auto on_canvas = [&](float px) {
    constexpr float kFar = 1e6F;  // px
    return static_cast<int>(std::floor(std::clamp((px + 0.5F) * static_cast<float>(factor), -kFar, kFar)));
  };
  std::vector<Label> names;
  for (const DrawnStep& step : steps) {
    const drawing::Point from{on_canvas(step.from_x), on_canvas(step.from_y)};
    const drawing::Point to{on_canvas(step.to_x), on_canvas(step.to_y)};
    for (int below = 0; below < 2; ++below)
      drawing::draw_line(canvas, {from.x, from.y + below}, {to.x, to.y + below}, kStep);
    names.push_back(
        label_at({(from.x + to.x) / 2, (from.y + to.y) / 2}, number_text("%+.0f cm", 100 * step.height_m)));
  }
  return names;
}

// ---- disparity ----

const Reason& shown_reason(Reject reject) {
  const auto found =
      std::find_if(kReasons.begin(), kReasons.end(), [&](const Reason& r) { return has(reject, r.bit); });
  return found == kReasons.end() ? kReasons.front() : *found;
}

Rgb colour_of(float disparity, DisparitySpan span, const std::array<Rgb, 256>& colours) {
  const float share = std::clamp((disparity - span.low) / (span.high - span.low), 0.0F, 1.0F);
  return colours[static_cast<std::size_t>(std::lround(share * 255))];
}

std::string scale_text(float disparity, const std::optional<StereoRig>& rig) {
  std::string px = number_text("%.1f px", disparity);
  if (!rig) return px;
  const auto point = rig->point_in_camera_m(0, 0, disparity);
  return px + (point ? number_text("  %.2f m", point->z) : "");
}

constexpr int kLegendWidth = 190;
constexpr int kLegendRow = 20;
constexpr int kLegendHeight = kLegendRow * (int(kReasons.size()) + 6) + 10;

void draw_legend(Image<Rgb>& canvas, int left, const DisparityMap& map, DisparitySpan span,
                 const std::array<Rgb, 256>& colours, const std::optional<StereoRig>& rig, Reject in_force) {
  constexpr int kBarRows = 4;
  const auto write = [&](const std::string& text, drawing::Point at) {
    drawing::draw_text(canvas, text, at, kLegendHeightOfText, {235, 235, 235});
  };
  const int bar_top = 10;
  const int bar_height = kBarRows * kLegendRow;
  for (int y = 0; y < bar_height; ++y) {
    const auto c = colours[static_cast<std::size_t>(255 - y * 255 / (bar_height - 1))];
    drawing::fill(canvas, {left + 10, bar_top + y, 15, 1}, c);
  }
  for (int i = 0; i <= 2; ++i) {
    const float d = span.high + (span.low - span.high) * static_cast<float>(i) / 2;
    write(scale_text(d, rig), {left + 32, bar_top + 10 + i * (bar_height - 14) / 2});
  }
  std::array<std::int64_t, kReasons.size()> counts{};
  std::int64_t valid = 0;
  for (int y = 0; y < map.reject.height(); ++y) {
    for (int x = 0; x < map.reject.width(); ++x) {
      const Reject reject = map.reject(x, y);
      if (reject == Reject::none) {
        ++valid;
      } else {
        ++counts[static_cast<std::size_t>(&shown_reason(reject) - kReasons.data())];
      }
    }
  }
  const auto percent = [&](std::int64_t count) {
    return number_text("  %.1f %%",
                       100 * static_cast<float>(count) / static_cast<float>(map.reject.size().area()));
  };
  int y = bar_top + bar_height + kLegendRow;
  write("valid" + percent(valid), {left + 10, y});
  for (std::size_t i = 0; i < kReasons.size(); ++i) {
    if (!is_listed(kReasons[i].bit, in_force, counts[i])) continue;
    y += kLegendRow;
    drawing::fill(canvas, {left + 10, y - 10, 14, 12}, kReasons[i].colour);
    write(std::string(kReasons[i].label) + percent(counts[i]), {left + 32, y});
  }
}

}  // namespace

Rgb object_colour(ObjectId id) {
  // Steps of the golden ratio keep consecutive hues far apart.
  const float hue = std::fmod(0.61803399F * static_cast<float>(number(id) % 1000), 1.0F);
  return from_hsv(hue, 0.78F, 0.98F);
}

LabelPlace label_place(View<const std::uint8_t> mask) {
  // Distances from the outline by steps of 5 and 7 (Borgefors 1986). Padded, so that the image border counts as one.
  constexpr int kStraight = 5;
  constexpr int kDiagonal = 7;
  const int width = mask.width();
  const int height = mask.height();
  Image<int> distance({width + 2, height + 2}, 0, {});
  LabelPlace best{};
  int most = 0;
  for (int y = 1; y <= height; ++y) {
    for (int x = 1; x <= width; ++x) {
      if (mask(x - 1, y - 1) == 0) continue;
      distance(x, y) = std::min(std::min(distance(x - 1, y), distance(x, y - 1)) + kStraight,
                                std::min(distance(x - 1, y - 1), distance(x + 1, y - 1)) + kDiagonal);
    }
  }
  for (int y = height; y >= 1; --y) {
    for (int x = width; x >= 1; --x) {
      int& here = distance(x, y);
      if (here == 0) continue;
      here = std::min({here, distance(x + 1, y) + kStraight, distance(x, y + 1) + kStraight,
                       distance(x + 1, y + 1) + kDiagonal, distance(x - 1, y + 1) + kDiagonal});
      if (here >= most) {  // of several places the first in raster order
        most = here;
        best = {x - 1, y - 1};
      }
    }
  }
  return best;
}

std::vector<Rect> place_labels(const std::vector<Rect>& wanted, Size picture) {
  constexpr int kGap = 1;       // px between two labels
  constexpr int kFurthest = 6;  // heights up and down, and half as many half-widths to either side
  std::vector<Rect> placed;
  for (const Rect& label : wanted) {
    const auto is_free = [&](const Rect& place) {
      const Rect wide{place.x - kGap, place.y - kGap, place.width + 2 * kGap, place.height + 2 * kGap};
      return std::none_of(placed.begin(), placed.end(),
                          [&](const Rect& other) { return overlap(wide, other); });
    };
    const Rect own = inside(label, picture);
    Rect best = own;
    std::int64_t nearest = std::numeric_limits<std::int64_t>::max();
    for (int rows = -kFurthest; rows <= kFurthest; ++rows) {
      for (int columns = -kFurthest / 2; columns <= kFurthest / 2; ++columns) {
        Rect place = own;
        place.x += columns * (label.width / 2 + kGap);
        place.y += rows * (label.height + kGap) / 2;
        place = inside(place, picture);
        const std::int64_t x = place.x - own.x;
        const std::int64_t y = place.y - own.y;
        const std::int64_t distance = x * x + y * y;
        if (distance >= nearest || !is_free(place)) continue;
        nearest = distance;
        best = place;
      }
    }
    placed.push_back(best);
  }
  return placed;
}

DisparitySpan disparity_span(View<const float> disparity_px) {
  std::vector<float> values;
  for (int y = 0; y < disparity_px.height(); ++y) {
    std::copy_if(disparity_px.row(y), disparity_px.row(y) + disparity_px.width(), std::back_inserter(values),
                 [](float d) { return !std::isnan(d); });
  }
  if (values.empty()) return {};
  const auto at = [&](std::size_t percent) {
    const auto place = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * percent / 100);
    std::nth_element(values.begin(), place, values.end());
    return *place;
  };
  const DisparitySpan span{at(1), at(99)};
  return span.high > span.low ? span : DisparitySpan{span.low - 0.5F, span.low + 0.5F};
}

std::array<Rgb, 256> disparity_colours() {
  // Turbo (Mikhailov 2019), by its polynomials: red, green and blue of 0 … 1, coefficients from low to high.
  constexpr std::array<std::array<double, 6>, 3> kTurbo{
      {{0.13572138, 4.61539260, -42.66032258, 132.13108234, -152.94239396, 59.28637943},
       {0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604},
       {0.10667330, 12.64194608, -60.58204836, 110.36276771, -89.90310912, 27.34824973}}};
  const auto level = [](const std::array<double, 6>& polynomial, double at) {
    double value = 0;
    for (std::size_t i = polynomial.size(); i-- > 0;) value = value * at + polynomial[i];
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
  };
  std::array<Rgb, 256> colours{};
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const double at = static_cast<double>(i) / 255;
    // The darkest ends of the map would be hard to distinguish from holes.
    colours[i] =
        mixed(Rgb{level(kTurbo[0], at), level(kTurbo[1], at), level(kTurbo[2], at)}, {255, 255, 255}, 0.08F);
  }
  return colours;
}

std::vector<DrawnStep> drawn_steps(const std::vector<GroundStep>& steps, const FloorFrame& floor,
                                   const StereoRig& rig) {
  std::vector<DrawnStep> drawn;
  for (const GroundStep& step : steps) {
    const Vec3 from = floor.to_camera(step.from_m);
    const Vec3 to = floor.to_camera(step.to_m);
    // Steps are seen, so they are in front of the camera.
    drawn.push_back({rig.cx_px + rig.focal_px * from.x / from.z, rig.cy_px + rig.focal_px * from.y / from.z,
                     rig.cx_px + rig.focal_px * to.x / to.z, rig.cy_px + rig.focal_px * to.y / to.z,
                     step.height_m});
  }
  return drawn;
}

Image<Rgb> draw_objects(View<const Gray> left, View<const Rgb> left_rgb, const Objects& objects,
                        View<const std::uint8_t> floor, const std::vector<DrawnStep>& steps) {
  const int factor = enlargement(left.size());
  Image<Rgb> canvas = enlarged(left, left_rgb, factor);
  const float brightened = brightening(left);
  brighten(canvas, brightened);
  tint(canvas, objects, floor, factor);
  std::vector<Label> names = mark_steps(canvas, steps, factor);
  for (const Object& object : objects.list) {
    const std::string distance = object.position_in_camera_m
                                     ? number_text("%.2f m", object.position_in_camera_m->z)
                                     : number_text("%.1f px", object.disparity_px);
    const Rect box = object.box_px;
    const Image<std::uint8_t> mask = mask_of(View<const ObjectId>(objects.labels), object.id, box);
    const LabelPlace place = label_place(mask);
    names.push_back(label_at({(box.x + place.x) * factor, (box.y + place.y) * factor},
                             std::to_string(number(object.id)) + ": " + distance));
  }
  write_labels(canvas, names);
  const bool in_metres = std::any_of(objects.list.begin(), objects.list.end(), [](const Object& object) {
    return object.position_in_camera_m.has_value();
  });
  return with_legend(std::move(canvas), in_metres, !floor.empty(), !steps.empty(), brightened);
}

Image<Rgb> draw_disparity(const DisparityMap& map, const std::optional<StereoRig>& rig, Reject in_force) {
  const int factor = enlargement(map.reject.size());
  const DisparitySpan span = disparity_span(map.disparity_px);
  const std::array<Rgb, 256> colours = disparity_colours();
  const int width = map.reject.width() * factor;
  const int height = map.reject.height() * factor;
  Image<Rgb> canvas({width + kLegendWidth, std::max(height, kLegendHeight)}, Rgb{15, 15, 15}, {});
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Reject reject = map.reject(x / factor, y / factor);
      canvas(x, y) = reject == Reject::none
                         ? colour_of(map.disparity_px(x / factor, y / factor), span, colours)
                         : shown_reason(reject).colour;
    }
  }
  draw_legend(canvas, width, map, span, colours, rig, in_force);
  return canvas;
}

}  // namespace cairn::output
