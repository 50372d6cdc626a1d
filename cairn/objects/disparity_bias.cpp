// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/ids.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/fitted/fitted.hpp>
#include <cairn/objects/disparity_bias.hpp>
#include <cairn/objects/object_match.hpp>
#include <cairn/objects/ranks.hpp>
#include <cairn/scene/plane_fit.hpp>
#include <cmath>
#include <cstdint>

namespace cairn {
namespace {

constexpr std::array<std::string_view, kBiasFeatures> kNames{
    "share of pixels with a disparity",
    "disparity times mean width, share of the image",
    "disparity at the ends of the rows, minus the median",
    "disparity of the upper part, minus the median",
    "plane of the disparities at the centroid, minus the median",
    "shift by the images",
    "shift by the images, middle of the rows",
    "certainty of that shift",
    "shift by the images from a plane, middle of the rows",
    "shift by the images from a plane, without the outline",
    "slope of the brightness along the rows",
    "disparity minus that beside the object"};

constexpr double kMiddle = 0.5;  // of a row
constexpr double kEnds = 0.75;
constexpr double kUpper = 0.3;  // of half of the height, above the centroid
constexpr std::size_t kMin = 4;
constexpr double kSigmaFromPlane = 0.5;  // px: a plane is a coarse model

/// The pixels of an object in a row, from the first to the last.
struct Row {
  int y;
  int first;
  int last;
  /// −1 … 1 from one end to the other.
  [[nodiscard]] double across(int x) const { return (2.0 * x - first - last) / (last - first + 1); }
};

float median(std::vector<float>& values, float otherwise, const Exec& exec) {
  if (values.size() < kMin) return otherwise;
  return values_at_ranks(values, values.size() / 2, values.size() / 2, exec).first;
}

/// The plane of the disparities near their median, with its offset from the median at the centroid.
struct Plane {
  double offset = 0;
  double per_x = 0;
  double per_y = 0;
};

/// `points` relative to the centroid. Unlike PlaneFit::solve(), this also fits masks of two columns.
Plane plane_of(const PlaneFit& points) {
  constexpr double kMinPixels = 20;
  constexpr double kMinDeterminant = 1e-6;
  if (points.count() < kMinPixels) return {};
  const PlaneFit::Moments m = points.moments();
  if (!(m.determinant() > kMinDeterminant)) return {m.mean_d, 0, 0};
  const double per_x = m.slope_x();
  const double per_y = m.slope_y();
  return {m.mean_d - per_x * m.mean_x - per_y * m.mean_y, per_x, per_y};
}

/// Of a mask: its size and centroid, and its brightness along the rows.
struct Brightness {
  double pixels = 0;
  double x = 0;
  double y = 0;
  double slope = 0;  // from the middle of a row to its end, share of the mean
};

/// One object and the images that show it.
struct ObjectView {
  const Object& object;
  View<const ObjectId> labels;
  View<const float> disparity_px;
  View<const Gray> left;
  View<const Gray> right;
  const Exec& exec;

  [[nodiscard]] bool has(int x, int y) const { return labels(x, y) == object.id; }

  template <class Visit>
  void for_each_pixel(const std::vector<Row>& rows, const Visit& visit) const {
    for (const Row& row : rows) {
      for (int x = row.first; x <= row.last; ++x) {
        if (has(x, row.y)) visit(row, x);
      }
    }
  }

  [[nodiscard]] int step() const { return row_step(object.pixel_count); }
  /// Every step()-th one.
  [[nodiscard]] std::vector<Row> rows() const {
    std::vector<Row> rows;
    const Rect box = object.box_px;
    for (int y = box.y; y < box.y + box.height; y += step()) {
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
    constexpr std::size_t kAboutRows = 40;
    std::vector<float> values;
    const std::size_t step = std::max<std::size_t>(1, rows.size() / kAboutRows);
    for (std::size_t i = 0; i < rows.size(); i += step) {
      const Row& row = rows[i];
      for (const int x : {row.first - 5, row.first - 4, row.last + 4, row.last + 5}) {
        if (x < 0 || x >= left.width()) continue;
        const float d = disparity_px(x, row.y);
        if (!std::isnan(d)) values.push_back(d);
      }
    }
    return median(values, object.disparity_px, exec);
  }

  [[nodiscard]] Brightness brightness(const std::vector<Row>& rows) const;
  [[nodiscard]] BiasFeatures features(double shift_px) const;
};

Brightness ObjectView::brightness(const std::vector<Row>& rows) const {
  constexpr double kDark = 8;  // grey levels
  double n = 0;
  double x_sum = 0;
  double y_sum = 0;
  double grey_sum = 0;
  double across = 0;
  double across_squared = 0;
  double across_grey = 0;
  for_each_pixel(rows, [&](const Row& row, int x) {
    const double t = row.across(x);
    const int grey = left(x, row.y);
    n += 1;
    x_sum += x;
    y_sum += row.y;
    grey_sum += grey;
    across += t;
    across_squared += t * t;
    across_grey += t * grey;
  });
  n = std::max(n, 1.0);
  const double mean = grey_sum / n;
  const double slope = (across_grey - across * mean) / (across_squared + 1e-6) / std::max(mean, kDark);
  return {n, x_sum / n, y_sum / n, slope};
}

BiasFeatures ObjectView::features(double shift_px) const {
  const std::vector<Row> all = rows();
  const float d0 = object.disparity_px;
  const Brightness grey = brightness(all);
  const double x0 = grey.x;
  const double y0 = grey.y;

  std::vector<float> ends;
  std::vector<float> upper;
  std::vector<float> values;
  for_each_pixel(all, [&](const Row& row, int x) {
    const float d = disparity_px(x, row.y);
    if (std::isnan(d)) return;
    values.push_back(d);
    if (std::abs(row.across(x)) > kEnds) ends.push_back(d);
    if (row.y - y0 < -kUpper * object.box_px.height / 2) upper.push_back(d);
  });
  constexpr double kNear = 0.5;  // px
  double reach = kNear;
  if (!values.empty()) {
    const auto [low, high] = values_at_ranks(values, values.size() / 4, 3 * values.size() / 4, exec);
    reach = std::max(kNear, 2 * (double{high} - double{low}));
  }
  PlaneFit near(x0, y0);
  for_each_pixel(all, [&](const Row& row, int x) {
    const double off = double{disparity_px(x, row.y)} - double{d0};
    if (std::abs(off) <= reach) near.add(x, row.y, off);
  });
  const Plane plane = plane_of(near);

  const auto in_middle = [](const Row& row, int x) { return std::abs(row.across(x)) < kMiddle; };
  const auto measured = [&](int x, int y) { return double{disparity_px(x, y)}; };
  // Through the median: its offset is a feature of its own.
  const auto on_plane = [&](int x, int y) {
    return double{d0} + plane.per_x * (x - x0) + plane.per_y * (y - y0);
  };
  const auto middle = stretches(all, in_middle);
  const auto middle_measured = stretches(
      all, [&](const Row& row, int x) { return in_middle(row, x) && !std::isnan(disparity_px(x, row.y)); });
  const auto inside = stretches(
      all, [](const Row& row, int x) { return x - row.first >= kOutline && row.last - x >= kOutline; });
  const ShiftEstimate of_middle = match_shift(middle_measured, measured, left, right, kShiftSigma, step());
  const ShiftEstimate middle_of_plane = match_shift(middle, on_plane, left, right, kSigmaFromPlane, step());
  const ShiftEstimate inside_of_plane = match_shift(inside, on_plane, left, right, kSigmaFromPlane, step());

  const double width = grey.pixels / std::max<double>(1, static_cast<double>(all.size()));
  const std::array<double, kBiasFeatures> found{double{object.valid_share},
                                                double{d0} * width / left.width(),
                                                double{median(ends, d0, exec)} - double{d0},
                                                double{median(upper, d0, exec)} - double{d0},
                                                plane.offset,
                                                shift_px,
                                                of_middle.shift_px,
                                                of_middle.certainty,
                                                middle_of_plane.shift_px,
                                                inside_of_plane.shift_px,
                                                std::abs(grey.slope),
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
      const ObjectView seen{objects.list[i], objects.labels, disparity.disparity_px, left, right, exec};
      features[i] = seen.features(shift_px[i]);
    }
  });
  return features;
}

const FittedTrees& disparity_bias_trees() {
  static const FittedTrees trees = load_trees(fitted::disparity_bias());
  return trees;
}

}  // namespace cairn
