// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/ids.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/objects/disparity_bias.hpp>
#include <cairn/objects/object_match.hpp>
#include <cmath>
#include <cstdint>

namespace cairn {
namespace {

#include <cairn/objects/fitted_disparity_bias.inc>

constexpr std::array<std::string_view, kBiasFeatures> kNames{
    "share of pixels with a disparity",
    "disparity times mean width, share of the image",
    "disparity at the ends of the rows, minus the median",
    "disparity of the upper part, minus the median",
    "mean disparity minus the median",
    "shift by the images",
    "shift by the images, middle of the rows",
    "its certainty",
    "shift by the images from a plane, middle of the rows",
    "shift by the images from a plane, without the outline",
    "slope of the brightness along the rows",
    "disparity minus that beside the object"};

constexpr int kOutline = 4;      // px at either end of a row
constexpr double kMiddle = 0.5;  // of a row
constexpr double kEnds = 0.75;
constexpr double kUpper = 0.3;  // of half of the height, above the centroid
constexpr std::size_t kFewest = 4;
constexpr double kSigmaPx = 0.2;         // as in refine_objects()
constexpr double kSigmaFromPlane = 0.5;  // px: a plane is a coarse model

/// The pixels of an object in a row, from the first to the last.
struct Row {
  int y;
  int first;
  int last;
  /// −1 … 1 from one end to the other.
  [[nodiscard]] double across(int x) const { return (2.0 * x - first - last) / (last - first + 1); }
};

float median(std::vector<float>& values, float otherwise) {
  if (values.size() < kFewest) return otherwise;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The plane of the disparities near their median, with its offset from the median at the centroid.
struct Plane {
  double offset = 0;
  double per_x = 0;
  double per_y = 0;
};

class PlaneSums {
 public:
  void add(double x, double y, double d) {
    n_ += 1;
    x_ += x;
    y_ += y;
    d_ += d;
    xx_ += x * x;
    xy_ += x * y;
    yy_ += y * y;
    xd_ += x * d;
    yd_ += y * d;
  }
  [[nodiscard]] Plane plane() const {
    constexpr double kFewestPixels = 20;
    if (n_ < kFewestPixels) return {};
    const double xx = xx_ - x_ * x_ / n_;
    const double xy = xy_ - x_ * y_ / n_;
    const double yy = yy_ - y_ * y_ / n_;
    const double xd = xd_ - x_ * d_ / n_;
    const double yd = yd_ - y_ * d_ / n_;
    const double det = xx * yy - xy * xy;
    if (!(det > 1e-6 * n_ * n_)) return {d_ / n_, 0, 0};
    const Plane slopes{0, (xd * yy - yd * xy) / det, (yd * xx - xd * xy) / det};
    return {(d_ - slopes.per_x * x_ - slopes.per_y * y_) / n_, slopes.per_x, slopes.per_y};
  }

 private:
  double n_ = 0, x_ = 0, y_ = 0, d_ = 0, xx_ = 0, xy_ = 0, yy_ = 0, xd_ = 0, yd_ = 0;
};

/// One object and the images that show it.
struct Seen {
  const Object& object;
  View<const ObjectId> labels;
  View<const float> disparity_px;
  View<const Gray> left;
  View<const Gray> right;

  [[nodiscard]] bool has(int x, int y) const { return labels(x, y) == object.id; }

  [[nodiscard]] std::vector<Row> rows() const {
    std::vector<Row> rows;
    const Rect box = object.box_px;
    for (int y = box.y; y < box.y + box.height; ++y) {
      int first = box.x;
      int last = box.x + box.width - 1;
      while (first <= last && !has(first, y)) ++first;
      while (last > first && !has(last, y)) --last;
      if (first <= last) rows.push_back({y, first, last});
    }
    return rows;
  }

  /// The pixels of the object for which belongs(row, x) is true and that have a neighbour on both sides.
  template <class Test>
  [[nodiscard]] std::vector<Stretch> stretches(const std::vector<Row>& rows, const Test& belongs) const {
    std::vector<Stretch> found;
    for (const Row& row : rows) {
      const int end = std::min(row.last + 1, left.width() - 1);
      for (int x = std::max(row.first, 1); x < end;) {
        const int begin = x++;
        if (!has(begin, row.y) || !belongs(row, begin)) continue;
        while (x < end && has(x, row.y) && belongs(row, x)) ++x;
        found.push_back({row.y, begin, x});
      }
    }
    return found;
  }

  /// The median disparity of what is beside it, a few pixels off; its own if that is unknown.
  [[nodiscard]] float beside(const std::vector<Row>& rows) const {
    constexpr std::size_t kMostRows = 40;
    std::vector<float> values;
    const std::size_t step = std::max<std::size_t>(1, rows.size() / kMostRows);
    for (std::size_t i = 0; i < rows.size(); i += step) {
      const Row& row = rows[i];
      for (const int x : {row.first - 5, row.first - 4, row.last + 4, row.last + 5}) {
        if (x < 0 || x >= left.width()) continue;
        const float d = disparity_px(x, row.y);
        if (!std::isnan(d)) values.push_back(d);
      }
    }
    return median(values, object.disparity_px);
  }

  [[nodiscard]] BiasFeatures features(double shift_px) const;
};

BiasFeatures Seen::features(double shift_px) const {
  const std::vector<Row> all = rows();
  const float d0 = object.disparity_px;
  const double n = object.pixel_count;

  // Centroid and brightness.
  double x0 = 0;
  double y0 = 0;
  double brightness = 0;
  double across = 0;
  double across_squared = 0;
  double across_brightness = 0;
  for (const Row& row : all) {
    for (int x = row.first; x <= row.last; ++x) {
      if (!has(x, row.y)) continue;
      const double t = row.across(x);
      const int grey = left(x, row.y);
      x0 += x;
      y0 += row.y;
      brightness += grey;
      across += t;
      across_squared += t * t;
      across_brightness += t * grey;
    }
  }
  x0 /= n;
  y0 /= n;
  constexpr double kDark = 8;
  const double mean = brightness / n;
  const double slope = (across_brightness - across * mean) / (across_squared + 1e-6) / std::max(mean, kDark);

  // Disparities by their place in the mask.
  std::vector<float> ends;
  std::vector<float> upper;
  std::vector<float> values;
  for (const Row& row : all) {
    for (int x = row.first; x <= row.last; ++x) {
      const float d = disparity_px(x, row.y);
      if (!has(x, row.y) || std::isnan(d)) continue;
      values.push_back(d);
      if (std::abs(row.across(x)) > kEnds) ends.push_back(d);
      if (row.y - y0 < -kUpper * object.box_px.height / 2) upper.push_back(d);
    }
  }
  const auto quartile = [&](std::size_t i) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(i * values.size() / 4);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  constexpr double kNear = 0.5;  // px
  const double reach =
      values.empty() ? kNear : std::max(kNear, 2 * (double{quartile(3)} - double{quartile(1)}));
  PlaneSums near;
  for (const Row& row : all) {
    for (int x = row.first; x <= row.last; ++x) {
      const double off = double{disparity_px(x, row.y)} - double{d0};
      if (has(x, row.y) && std::abs(off) <= reach) near.add(x - x0, row.y - y0, off);
    }
  }
  const Plane plane = near.plane();

  // What both images add to them, and to a plane.
  const auto in_middle = [](const Row& row, int x) { return std::abs(row.across(x)) < kMiddle; };
  const auto measured = [&](int x, int y) { return double{disparity_px(x, y)}; };
  const auto on_plane = [&](int x, int y) {
    return double{d0} + plane.per_x * (x - x0) + plane.per_y * (y - y0);
  };
  const auto middle = stretches(all, in_middle);
  const auto middle_measured = stretches(
      all, [&](const Row& row, int x) { return in_middle(row, x) && !std::isnan(disparity_px(x, row.y)); });
  const auto inside = stretches(
      all, [](const Row& row, int x) { return x - row.first >= kOutline && row.last - x >= kOutline; });
  const Match of_middle = match_shift(middle_measured, measured, left, right, kSigmaPx);
  const Match middle_of_plane = match_shift(middle, on_plane, left, right, kSigmaFromPlane);
  const Match inside_of_plane = match_shift(inside, on_plane, left, right, kSigmaFromPlane);

  const double width = n / std::max<double>(1, static_cast<double>(all.size()));
  const std::array<double, kBiasFeatures> found{double{object.valid_share},
                                                double{d0} * width / left.width(),
                                                double{median(ends, d0)} - double{d0},
                                                double{median(upper, d0)} - double{d0},
                                                plane.offset,
                                                shift_px,
                                                of_middle.shift_px,
                                                of_middle.certainty,
                                                middle_of_plane.shift_px,
                                                inside_of_plane.shift_px,
                                                std::abs(slope),
                                                double{d0} - double{beside(all)}};
  BiasFeatures features;
  for (std::size_t i = 0; i < features.size(); ++i) features[i] = static_cast<float>(found[i]);
  return features;
}

}  // namespace

std::array<std::string_view, kBiasFeatures> bias_feature_names() {
  return kNames;
}

std::vector<BiasFeatures> bias_features(const Objects& objects, const std::vector<double>& shift_px,
                                        const DisparityMap& disparity, View<const Gray> left,
                                        View<const Gray> right, const Exec& exec) {
  std::vector<BiasFeatures> features(objects.list.size());
  parallel_for(exec, static_cast<int>(features.size()), 1, [&](int first, int last) {
    for (auto i = slot(first); i < slot(last); ++i) {
      const Seen seen{objects.list[i], objects.labels, disparity.disparity_px, left, right};
      features[i] = seen.features(shift_px[i]);
    }
  });
  return features;
}

const FittedTrees& disparity_bias_trees() {
  static const FittedTrees trees(kDisparityBiasBase, kDisparityBiasRoots, kDisparityBiasNodes);
  return trees;
}

}  // namespace cairn
