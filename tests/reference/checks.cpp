// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cairn::reference {
namespace {

DisparityMap clone(const DisparityMap& map) {
  return {map.disparity_px.clone(), map.reject.clone()};
}

void reject(DisparityMap& map, int x, int y, Reject why) {
  map.disparity_px(x, y) = std::numeric_limits<float>::quiet_NaN();
  map.reject(x, y) |= why;
}

int right_row(const Matches& matches, int x, int y) {
  return matches.row_offset.empty() ? y : y + matches.row_offset(x, y);
}

/// The disparity of the cheapest left pixel that matches (right_x, right_y); ties: the smallest.
int vote(const Matches& matches, int right_x, int right_y) {
  float least = std::numeric_limits<float>::infinity();
  int winner = kNoMatch;
  for (int y = 0; y < matches.best.height(); ++y) {
    for (int x = 0; x < matches.best.width(); ++x) {
      const int d = matches.best(x, y);
      if (d == kNoMatch || x - d != right_x || right_row(matches, x, y) != right_y) continue;
      const float cost = matches.cost(x, y);
      if (winner != kNoMatch && (cost > least || (cost == least && d > winner))) continue;
      least = cost;
      winner = d;
    }
  }
  return winner;
}

}  // namespace

Image<Reject> reject_inconsistent(const Matches& matches, const LeftRightConfig& config) {
  return verdicts(matches.best.size(), [&](int x, int y) {
    const int d = matches.best(x, y);
    if (config.max_diff < 0 || d == kNoMatch) return Reject::none;
    const int right_x = x - d;
    const int right_y = right_row(matches, x, y);
    const int back = config.method == LeftRightMethod::vote ? vote(matches, right_x, right_y)
                                                            : int{matches.best_right(right_x, right_y)};
    return static_cast<float>(std::abs(d - back)) <= config.max_diff ? Reject::none : Reject::left_right;
  });
}

Image<Reject> reject_textureless(View<const Gray> left, const TextureConfig& config) {
  const int radius = config.window_size / 2;
  return verdicts(left.size(), [&](int x, int y) {
    if (config.threshold < 0) return Reject::none;
    bool any = false;
    bool enough = true;
    for (const auto [dx, dy] : {Point{1, 0}, Point{0, 1}, Point{1, 1}, Point{1, -1}}) {
      std::int64_t sum = 0;
      std::int64_t count = 0;
      for (int v = y - radius; v <= y + radius; ++v) {
        for (int u = x - radius; u <= x + radius; ++u) {
          if (!left.contains(u, v) || !left.contains(u + dx, v + dy)) continue;
          const int difference = left(u, v) - left(u + dx, v + dy);
          sum += difference * difference;
          ++count;
        }
      }
      if (count == 0) continue;
      any = true;
      // In double the product and the comparison are exact; the mean itself would be rounded.
      if (static_cast<double>(sum) < double{config.threshold} * static_cast<double>(count)) enough = false;
    }
    return any && enough ? Reject::none : Reject::no_texture;
  });
}

DisparityMap combine(const Image<float>& refined_px, const std::vector<View<const Reject>>& verdicts_given) {
  DisparityMap map{refined_px.clone(), Image<Reject>(refined_px.size(), Reject::none, {})};
  for (int y = 0; y < refined_px.height(); ++y) {
    for (int x = 0; x < refined_px.width(); ++x) {
      if (std::isnan(refined_px(x, y))) reject(map, x, y, Reject::border);
      for (const auto& verdict : verdicts_given) {
        if (verdict(x, y) != Reject::none) reject(map, x, y, verdict(x, y));
      }
    }
  }
  return map;
}

DisparityMap reject_below_ground(const DisparityMap& disparity, const GroundPlane& plane, float doffs_px,
                                 float margin) {
  DisparityMap upright = clone(disparity);
  DisparityMap level = clone(disparity);
  for (int y = 0; y < upright.reject.height(); ++y) {
    for (int x = 0; x < upright.reject.width(); ++x) {
      const float d = disparity.disparity_px(x, y);
      const float floor = plane.disparity_px(static_cast<float>(x), static_cast<float>(y));
      const bool is_below = floor + doffs_px > 0 && d < floor - margin;
      if (!is_below) reject(upright, x, y, Reject::no_data);
      level.disparity_px(x, y) = d - floor;
      // A point at the same pixel is 1 / (d + doffs) away.
      if (!is_below || 2 * (d + doffs_px) <= floor + doffs_px) reject(level, x, y, Reject::no_data);
    }
  }
  // A surface has at least 2 % of the pixels and 64, and small steps.
  const int least = std::max(64, static_cast<int>(0.02 * static_cast<double>(upright.reject.size().area())));
  const DisparityMap no_wall = reject_speckles(upright, {least - 1, 0.2F});
  const DisparityMap no_ground = reject_speckles(level, {least - 1, 0.5F});
  const auto is_surface = [](const DisparityMap& map, int x, int y) {
    return !std::isnan(map.disparity_px(x, y));
  };
  DisparityMap map = clone(disparity);
  for (int y = 0; y < map.reject.height(); ++y) {
    for (int x = 0; x < map.reject.width(); ++x) {
      if (is_surface(upright, x, y) && !is_surface(no_wall, x, y) && !is_surface(no_ground, x, y))
        reject(map, x, y, Reject::below_ground);
    }
  }
  return map;
}

Image<std::uint8_t> label_floor(const DisparityMap& disparity, const GroundPlane& plane, float doffs_px,
                                float margin) {
  Image<std::uint8_t> label(disparity.reject.size(), 0, {});
  for (int y = 0; y < label.height(); ++y) {
    for (int x = 0; x < label.width(); ++x) {
      const float floor = plane.disparity_px(static_cast<float>(x), static_cast<float>(y));
      if (floor + doffs_px > 0 && std::abs(disparity.disparity_px(x, y) - floor) <= margin) label(x, y) = 255;
    }
  }
  return label;
}

DisparityMap reject_speckles(const DisparityMap& disparity, const SpeckleConfig& config) {
  DisparityMap map = clone(disparity);
  const View<const float> d = disparity.disparity_px;
  Image<std::uint8_t> seen(d.size(), 0, {});
  for (int y = 0; y < d.height(); ++y) {
    for (int x = 0; x < d.width(); ++x) {
      if (std::isnan(d(x, y)) || seen(x, y) != 0) continue;
      std::vector<Point> island{{x, y}};
      seen(x, y) = 1;
      for (std::size_t i = 0; i < island.size(); ++i) {
        const Point p = island[i];
        for (const Point q :
             {Point{p.x - 1, p.y}, Point{p.x + 1, p.y}, Point{p.x, p.y - 1}, Point{p.x, p.y + 1}}) {
          if (!d.contains(q.x, q.y) || seen(q.x, q.y) != 0) continue;
          if (!(std::abs(d(p.x, p.y) - d(q.x, q.y)) <= config.range)) continue;
          seen(q.x, q.y) = 1;
          island.push_back(q);
        }
      }
      if (static_cast<std::int64_t>(island.size()) > config.size) continue;
      for (const Point p : island) reject(map, p.x, p.y, Reject::speckle);
    }
  }
  return map;
}

}  // namespace cairn::reference
