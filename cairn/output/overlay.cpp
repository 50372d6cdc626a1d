// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/output/overlay.hpp>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace cairn::io {
namespace {

constexpr int kLegibleWidth = 640;  // px; narrower images are enlarged to about this
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

int enlargement(Size size) {
  return std::clamp((kLegibleWidth + size.width / 2) / size.width, 1, 4);
}

/// An image as cv::Mat with channels in the order R, G, B.
cv::Mat matrix(Image<Rgb>& image) {
  return {image.height(), image.width(), CV_8UC3, image.row(0),
          static_cast<std::size_t>(image.view().stride()) * sizeof(Rgb)};
}

cv::Scalar scalar(Rgb c) {
  return {double(c.r), double(c.g), double(c.b)};
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

void write(const cv::Mat& canvas, const std::string& text, cv::Point at, double scale, Rgb colour) {
  cv::putText(canvas, text, at, kFont, scale, scalar({0, 0, 0}), 3, cv::LINE_AA);
  cv::putText(canvas, text, at, kFont, scale, scalar(colour), 1, cv::LINE_AA);
}

/// A label at a point.
struct Label {
  std::string text;
  cv::Point middle;
  cv::Size extent;  // above the baseline
  int below = 0;
};

constexpr double kLabelScale = 0.45;

Label label_at(cv::Point middle, std::string text) {
  Label label{std::move(text), middle, {}, 0};
  label.extent = cv::getTextSize(label.text, kFont, kLabelScale, 1, &label.below);
  return label;
}

/// The area that it covers when centred on its point.
Rect covered(const Label& label) {
  return {label.middle.x - label.extent.width / 2, label.middle.y - label.extent.height / 2,
          label.extent.width, label.extent.height + label.below};
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
void write_labels(const cv::Mat& canvas, const std::vector<Label>& labels) {
  std::vector<Rect> wanted;
  wanted.reserve(labels.size());
  for (const Label& label : labels) wanted.push_back(covered(label));
  const std::vector<Rect> places = place_labels(wanted, {canvas.cols, canvas.rows});
  const Rgb white{255, 255, 255};
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const Rect& place = places[i];
    const cv::Point middle(place.x + place.width / 2, place.y + place.height / 2);
    const cv::Rect box(place.x, place.y, place.width, place.height);
    if (!box.contains(labels[i].middle))
      cv::line(canvas, middle, labels[i].middle, scalar(white), 1, cv::LINE_AA);
  }
  for (std::size_t i = 0; i < labels.size(); ++i)
    write(canvas, labels[i].text, {places[i].x, places[i].y + labels[i].extent.height}, kLabelScale, white);
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
  Image<Rgb> large({left.width() * factor, left.height() * factor});
  cv::Mat target = matrix(large);
  cv::resize(matrix(colour), target, target.size(), 0, 0, cv::INTER_CUBIC);
  return large;
}

/// The gain that makes the brightest hundredth of the image bright.
float brightening(View<const Gray> left) {
  constexpr int kBright = 200;
  constexpr float kMost = 8;
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
  return level < kDim ? std::min(static_cast<float>(kBright) / static_cast<float>(level), kMost) : 1.0F;
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
constexpr int kStripHeight = 24;

/// The image with a colour legend below it.
Image<Rgb> with_legend(Image<Rgb> picture, bool in_metres, bool has_floor, float brightened) {
  constexpr double kScale = 0.42;
  constexpr int kGap = 18;
  Image<Rgb> whole({picture.width(), picture.height() + kStripHeight}, Rgb{15, 15, 15}, {});
  for (int y = 0; y < picture.height(); ++y) std::copy_n(picture.row(y), picture.width(), whole.row(y));
  const cv::Mat canvas = matrix(whole);
  const Rgb white{235, 235, 235};
  const int base = whole.height() - 8;
  int x = 8;
  const auto entry = [&](const std::optional<Rgb>& chip, const std::string& text) {
    if (chip) {
      cv::rectangle(canvas, cv::Rect(x, base - 10, 14, 12), scalar(*chip), cv::FILLED);
      x += 20;
    }
    write(canvas, text, {x, base}, kScale, white);
    int below = 0;
    x += cv::getTextSize(text, kFont, kScale, 1, &below).width + kGap;
  };
  entry(object_colour(ObjectId{1}), std::string("object, id: ") + (in_metres ? "distance" : "disparity"));
  if (has_floor) entry(kFloorTint, "floor");
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

void draw_legend(const cv::Mat& canvas, int left, const DisparityMap& map, DisparitySpan span,
                 const std::array<Rgb, 256>& colours, const std::optional<StereoRig>& rig, Reject in_force) {
  constexpr double kScale = 0.42;
  constexpr int kBarRows = 4;
  const Rgb white{235, 235, 235};
  const int bar_top = 10;
  const int bar_height = kBarRows * kLegendRow;
  for (int y = 0; y < bar_height; ++y) {
    const auto c = colours[static_cast<std::size_t>(255 - y * 255 / (bar_height - 1))];
    cv::line(canvas, {left + 10, bar_top + y}, {left + 24, bar_top + y}, scalar(c));
  }
  for (int i = 0; i <= 2; ++i) {
    const float d = span.high + (span.low - span.high) * static_cast<float>(i) / 2;
    write(canvas, scale_text(d, rig), {left + 32, bar_top + 10 + i * (bar_height - 14) / 2}, kScale, white);
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
  write(canvas, "valid" + percent(valid), {left + 10, y}, kScale, white);
  for (std::size_t i = 0; i < kReasons.size(); ++i) {
    if (!has(in_force, kReasons[i].bit) && counts[i] == 0) continue;
    y += kLegendRow;
    cv::rectangle(canvas, cv::Rect(left + 10, y - 10, 14, 12), scalar(kReasons[i].colour), cv::FILLED);
    write(canvas, std::string(kReasons[i].label) + percent(counts[i]), {left + 32, y}, kScale, white);
  }
}

}  // namespace

Rgb object_colour(ObjectId id) {
  // Steps of the golden ratio keep consecutive hues far apart.
  const float hue = std::fmod(0.61803399F * static_cast<float>(number(id) % 1000), 1.0F);
  return from_hsv(hue, 0.78F, 0.98F);
}

LabelPlace label_place(View<const std::uint8_t> mask) {
  // Padded, so that the image border counts as an outline.
  cv::Mat framed(mask.height() + 2, mask.width() + 2, CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < mask.height(); ++y) {
    std::copy_n(mask.row(y), mask.width(), framed.ptr<std::uint8_t>(y + 1) + 1);
  }
  cv::Mat distance;
  cv::distanceTransform(framed, distance, cv::DIST_L2, 3);
  cv::Point best;
  cv::minMaxLoc(distance, nullptr, nullptr, nullptr, &best);
  return {best.x - 1, best.y - 1};
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
  cv::Mat ramp(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i) ramp.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(i);
  cv::Mat bgr;
  cv::applyColorMap(ramp, bgr, cv::COLORMAP_TURBO);
  std::array<Rgb, 256> colours{};
  for (int i = 0; i < 256; ++i) {
    const auto c = bgr.at<cv::Vec3b>(0, i);
    // The darkest ends of the map would be hard to distinguish from holes.
    colours[static_cast<std::size_t>(i)] = mixed(Rgb{c[2], c[1], c[0]}, {255, 255, 255}, 0.08F);
  }
  return colours;
}

Image<Rgb> draw_objects(View<const Gray> left, View<const Rgb> left_rgb, const Objects& objects,
                        View<const std::uint8_t> floor) {
  const int factor = enlargement(left.size());
  Image<Rgb> canvas = enlarged(left, left_rgb, factor);
  const float brightened = brightening(left);
  brighten(canvas, brightened);
  tint(canvas, objects, floor, factor);
  std::vector<Label> names;
  for (const Object& object : objects.list) {
    const std::string distance = object.position_in_camera_m
                                     ? number_text("%.2f m", object.position_in_camera_m->z)
                                     : number_text("%.1f px", object.disparity_px);
    const Rect box = object.box_px;
    const Image<std::uint8_t> mask = mask_of(View<const ObjectId>(objects.labels), object.id, box);
    const LabelPlace place = label_place(mask);
    const cv::Point middle = cv::Point(box.x + place.x, box.y + place.y) * factor;
    names.push_back(label_at(middle, std::to_string(number(object.id)) + ": " + distance));
  }
  write_labels(matrix(canvas), names);
  const bool in_metres = std::any_of(objects.list.begin(), objects.list.end(), [](const Object& object) {
    return object.position_in_camera_m.has_value();
  });
  return with_legend(std::move(canvas), in_metres, !floor.empty(), brightened);
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
  draw_legend(matrix(canvas), width, map, span, colours, rig, in_force);
  return canvas;
}

}  // namespace cairn::io
