// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/core/robust_fit.hpp>
#include <cairn/diagnosis/correspondences.hpp>
#include <cairn/diagnosis/given_disparity.hpp>
#include <cairn/diagnosis/row_alignment.hpp>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace cairn {
namespace {

constexpr int kMinPoints = 30;        // compared, for any judgement
constexpr double kMinAgreeing = 0.6;  // share of the points found that have consistent rows
constexpr double kFits = 0.5;         // share of points below which a map is suspect
constexpr double kFails = 0.3;        // the same, certainly wrong if that is chance …
constexpr double kChance = 0.15;      // … and at most this more
constexpr double kOtherFits = 0.7;    // the least share of another reading that makes the map suspect …
constexpr double kBetter = 0.08;      // … if it fits by this more than the map as it is, …
constexpr int kOnlyThere = 4;         // … or at these points, and nowhere worse, …
constexpr double kFarBetter = 0.25;   // … and certainly wrong if it fits by this more

/// A disparity of the map and that of the images, at one point; NaN: the map has a hole.
struct ComparedPoint {
  double given = 0;
  double found = 0;
  [[nodiscard]] bool is_known() const { return !std::isnan(given); }
  [[nodiscard]] bool fits() const {
    constexpr double kNear = 1.5;  // px
    constexpr double kShare = 0.1;
    return std::abs(given - found) <= std::max(kNear, kShare * std::abs(found));
  }
};
using Comparison = std::vector<ComparedPoint>;  // of the same points in each reading

int count_known(const Comparison& points) {
  return static_cast<int>(
      std::count_if(points.begin(), points.end(), [](const ComparedPoint& p) { return p.is_known(); }));
}

double share_that_fits(const Comparison& points) {
  const auto count =
      std::count_if(points.begin(), points.end(), [](const ComparedPoint& p) { return p.fits(); });
  return static_cast<double>(count) / std::max(1, count_known(points));
}

/// The share that would fit if the values of the map were shuffled.
double chance(const Comparison& points) {
  std::int64_t pairs = 0;
  std::int64_t fitting = 0;
  for (const ComparedPoint& a : points) {
    for (const ComparedPoint& b : points) {
      if (!a.is_known() || !b.is_known()) continue;
      ++pairs;
      fitting += ComparedPoint{a.given, b.found}.fits() ? 1 : 0;
    }
  }
  return static_cast<double>(fitting) / static_cast<double>(std::max<std::int64_t>(1, pairs));
}

/// The values of the map at the points, at the place that `place` makes of one: of the pixels around it, the one
/// that fits best, since maps are often sparse and the edges of objects a pixel off.
template <class Place>
Comparison compared(View<const float> map, const std::vector<Correspondence>& points, Place place) {
  Comparison all;
  for (const Correspondence& c : points) {
    const auto found = static_cast<double>(c.disparity());
    const Point at = place(c);
    double best = std::nan("");
    for (int j = std::max(0, at.y - 1); j <= std::min(map.height() - 1, at.y + 1); ++j) {
      for (int i = std::max(0, at.x - 1); i <= std::min(map.width() - 1, at.x + 1); ++i) {
        const auto given = static_cast<double>(map(i, j));
        if (!(std::abs(given - found) >= std::abs(best - found)) && std::isfinite(given)) best = given;
      }
    }
    all.push_back({best, found});
  }
  return all;
}

/// The points with their given value changed.
template <class Change>
Comparison changed(Comparison points, Change change) {
  for (ComparedPoint& p : points) p.given = change(p.given);
  return points;
}

std::string text_of(const char* format, double value) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

/// Another reading of a map.
struct Reading {
  std::string name;
  Comparison points;
  double share = 0;  // of the points that fit it
};

/// Whether this reading fits at points where the map as given does not, and at all others as well.
bool is_better_everywhere(const Reading& reading, const Comparison& as_given) {
  int better = 0;
  for (std::size_t i = 0; i < as_given.size(); ++i) {
    if (!as_given[i].is_known() || !reading.points[i].is_known()) continue;
    if (as_given[i].fits() && !reading.points[i].fits()) return false;
    better += reading.points[i].fits() && !as_given[i].fits() ? 1 : 0;
  }
  return better >= kOnlyThere;
}

/// given · found is constant for depth, given / found for a scaled map.
std::vector<Reading> readings_by_value(const Comparison& points, const std::optional<StereoRig>& rig) {
  std::vector<double> products;
  std::vector<double> ratios;
  const double doffs = rig ? static_cast<double>(rig->doffs_px) : 0.0;
  for (const ComparedPoint& p : points) {
    if (!p.is_known() || std::abs(p.found) < 1) continue;
    products.push_back(p.given * (p.found + doffs));
    ratios.push_back(p.given / p.found);
  }
  std::vector<Reading> all;
  if (products.empty()) return all;
  const auto add = [&](std::string name, const auto& change) {
    Comparison read = changed(points, change);
    const double share = share_that_fits(read);
    all.push_back({std::move(name), std::move(read), share});
  };
  add("it has the opposite sign", [](double d) { return -d; });
  const double product = quantile(products, 0.5);
  if (product > 0) {
    std::string name = "it looks like depth";
    if (rig) {
      // A PNG holds px * 256, so depth in mm is read as its 256th.
      const double unit =
          product / (static_cast<double>(rig->focal_px) * static_cast<double>(rig->baseline_m));
      for (const double mm : {1000.0, 1000.0 / 256}) {
        if (std::abs(unit / mm - 1) < 0.2) name += " in mm";
      }
      if (std::abs(unit - 1) < 0.2) name += " in m";
    }
    add(std::move(name), [&](double d) { return d > 0 ? product / d - doffs : std::nan(""); });
  }
  const double ratio = quantile(ratios, 0.5);
  if (ratio > 0 && (ratio < 0.8 || ratio > 1.25)) {
    std::string name = "it is " + text_of("%.3g times the disparity", ratio);
    for (const double fixed : {16.0, 256.0}) {
      if (std::abs(ratio * fixed - 1) < 0.1)
        name += text_of(": a PNG of px * %.0f, not px * 256?", 256 / fixed);
      if (std::abs(ratio / fixed - 1) < 0.1) name += text_of(": px * %.0f?", fixed);
    }
    add(std::move(name), [&](double d) { return d / ratio; });
  }
  return all;
}

}  // namespace

std::optional<Finding> check_given_disparity(View<const float> disparity_px, const StereoPair& pair,
                                             const std::optional<StereoRig>& rig, const Exec& exec) {
  if (disparity_px.size() != pair.size()) {
    throw Error("the disparity map is " + text(disparity_px.size()) + ", the images are " +
                text(pair.size()));
  }
  const Correspondences found = find_correspondences(pair, exec);
  const std::vector<Correspondence> points = agreeing_ones(found).list;
  if (static_cast<double>(points.size()) < kMinAgreeing * static_cast<double>(found.list.size()))
    return std::nullopt;  // the points are as doubtful as the map
  const auto at = [](float x, float y) {
    return Point{static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y))};
  };
  const Comparison as_given =
      compared(disparity_px, points, [&](const Correspondence& c) { return at(c.x_left, c.y_left); });
  if (count_known(as_given) < kMinPoints) return std::nullopt;
  const double share = share_that_fits(as_given);
  std::vector<Reading> readings = readings_by_value(as_given, rig);
  const auto add = [&](const char* name, const auto& place) {
    Comparison there = compared(disparity_px, points, place);
    if (count_known(there) < kMinPoints) return;
    const double fits = share_that_fits(there);
    readings.push_back({name, std::move(there), fits});
  };
  const auto last_x = static_cast<float>(disparity_px.width() - 1);
  const auto last_y = static_cast<float>(disparity_px.height() - 1);
  add("it looks upside down", [&](const Correspondence& c) { return at(c.x_left, last_y - c.y_left); });
  add("it looks mirrored", [&](const Correspondence& c) { return at(last_x - c.x_left, c.y_left); });
  add("it looks turned by 180 degrees",
      [&](const Correspondence& c) { return at(last_x - c.x_left, last_y - c.y_left); });
  add("it looks like that of the right image",
      [&](const Correspondence& c) { return at(c.x_right, c.y_left); });
  const auto best = std::max_element(readings.begin(), readings.end(),
                                     [](const Reading& a, const Reading& b) { return a.share < b.share; });
  const bool is_explained = best != readings.end() && best->share >= kOtherFits &&
                            (best->share >= share + kBetter || is_better_everywhere(*best, as_given));
  if (share >= kFits && !is_explained) return std::nullopt;
  const bool is_certain = (is_explained && best->share >= share + kFarBetter) ||
                          (share < kFails && share <= chance(as_given) + kChance);
  std::string says = "it fits both images at " + text_of("%.0f %%", 100 * share) + " of " +
                     std::to_string(count_known(as_given)) + " points";
  if (is_explained) says += "; " + best->name + text_of(" (which fits %.0f %%)", 100 * best->share);
  return Finding{FindingKind::given_disparity, is_certain ? Severity::broken : Severity::warning, 100 * share,
                 std::move(says)};
}

}  // namespace cairn
