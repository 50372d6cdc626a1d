// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "semi_global.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace cairn::reference {
namespace {

/// The image's pixel, with the border replicated.
int at(View<const Gray> image, int x, int y) {
  return image(std::clamp(x, 0, image.width() - 1), std::clamp(y, 0, image.height() - 1));
}

std::uint32_t census(View<const Gray> image, int x, int y) {
  std::uint32_t bits = 0;
  for (int v = -2; v <= 2; ++v) {
    for (int u = -2; u <= 2; ++u) {
      if (u == 0 && v == 0) continue;
      bits = bits << 1 | (at(image, x + u, y + v) < at(image, x, y) ? 1U : 0U);
    }
  }
  return bits;
}

Image<Gray> smoothed(View<const Gray> image) {
  constexpr int kWeights[] = {6, 58, 128, 58, 6};
  Image<Gray> out(image.size());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      int sum = 0;
      for (int v = -2; v <= 2; ++v) {
        for (int u = -2; u <= 2; ++u) sum += kWeights[v + 2] * kWeights[u + 2] * at(image, x + u, y + v);
      }
      out(x, y) = static_cast<Gray>((sum + 32768) / 65536);
    }
  }
  return out;
}

/// A number for every pixel and disparity.
class Volume {
 public:
  Volume(Size size, int first, int count)
      : first_(first),
        count_(count),
        values_(static_cast<std::size_t>(size.area() * count)),
        width_(size.width) {}
  int& operator()(int x, int y, int d) {
    return values_[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                    static_cast<std::size_t>(x)) *
                       static_cast<std::size_t>(count_) +
                   static_cast<std::size_t>(d - first_)];
  }
  [[nodiscard]] int first() const { return first_; }
  [[nodiscard]] int end() const { return first_ + count_; }

 private:
  int first_;
  int count_;
  std::vector<int> values_;
  int width_;
};

Volume costs_of(const StereoPair& pair, const MatchConfig& config) {
  const auto [width, height] = pair.size();
  Volume different(pair.size(), config.min_disparity, config.num_disparities);
  Volume costs = different;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int d = costs.first(); d < costs.end(); ++d) {
        const std::uint32_t bits = x - d >= 0 && x - d < width
                                       ? census(pair.left(), x, y) ^ census(pair.right(), x - d, y)
                                       : (1U << 12) - 1;
        different(x, y, d) = std::popcount(bits);
      }
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int d = costs.first(); d < costs.end(); ++d) {
        int sum = 0;
        for (int v = y - 1; v <= y + 1; ++v) {
          for (int u = x - 1; u <= x + 1; ++u) {
            sum += different(std::clamp(u, 0, width - 1), std::clamp(v, 0, height - 1), d);
          }
        }
        costs(x, y, d) = (sum + 2) / 4;
      }
    }
  }
  return costs;
}

int large_penalty(const SemiGlobalConfig& penalties, int step) {
  const float falling = penalties.penalty_large / (1.0F + penalties.penalty_edge * static_cast<float>(step));
  return static_cast<int>(std::lround(54.0F * std::max({0.5F, falling, penalties.penalty_small})));
}

/// Adds to `sums` the L of the paths in direction (dx, dy).
void add_paths(Volume& costs, const Image<Gray>& smooth, const SemiGlobalConfig& penalties, int dx, int dy,
               Volume& sums) {
  const auto [width, height] = smooth.size();
  const int p1 = static_cast<int>(std::lround(54.0F * penalties.penalty_small));
  Volume path = costs;
  for (int i = 0; i < height; ++i) {
    for (int j = 0; j < width; ++j) {
      const int x = dx < 0 ? width - 1 - j : j, y = dy < 0 ? height - 1 - i : i;
      const int before_x = x - dx, before_y = y - dy;
      const bool begins = !smooth.view().contains(before_x, before_y);
      const auto before = [&](int d) {
        return d < path.first() || d >= path.end() ? 1 << 20 : path(before_x, before_y, d);
      };
      int least = 1 << 20;
      for (int d = path.first(); d < path.end() && !begins; ++d) least = std::min(least, before(d));
      for (int d = path.first(); d < path.end(); ++d) {
        if (!begins) {
          const int p2 = large_penalty(penalties, std::abs(smooth(x, y) - smooth(before_x, before_y)));
          path(x, y, d) = costs(x, y, d) - least +
                          std::min({before(d), before(d - 1) + p1, before(d + 1) + p1, least + p2});
        }
        sums(x, y, d) += path(x, y, d);
      }
    }
  }
}

Matches make_matches(Size size, MatchMaps maps) {
  const Size minimum = maps != MatchMaps::winner ? size : Size{};
  const Size full = maps == MatchMaps::full ? size : Size{};
  return {Image<std::int16_t>(size), Image<std::int16_t>(full), Image<std::int8_t>(),  Image<float>(size),
          Image<float>(minimum),     Image<float>(full),        Image<float>(minimum), Image<float>(minimum)};
}

void settle_pixel(Volume& sums, int x, int y, Matches& out) {
  const Size size = out.best.size();
  // The cost of a left pixel for d; kNoCost without such a candidate.
  const auto cost_at = [&](int x_left, int d) {
    const bool exists = d >= sums.first() && d < sums.end() && x_left >= 0 && x_left < size.width &&
                        x_left - d >= 0 && x_left - d < size.width;
    return exists ? static_cast<float>(sums(x_left, y, d)) : kNoCost;
  };
  std::int16_t best = kNoMatch, best_right = kNoMatch;
  float least = kNoCost, least_right = kNoCost, runner_up = kNoCost, total = 0, count = 0;
  for (int d = sums.first(); d < sums.end(); ++d) {
    const float cost = cost_at(x, d), cost_right = cost_at(x + d, d);
    if (cost < kNoCost) total += cost, count += 1;
    if (cost < least) least = cost, best = static_cast<std::int16_t>(d);
    if (cost_right < least_right) least_right = cost_right, best_right = static_cast<std::int16_t>(d);
  }
  for (int d = sums.first(); d < sums.end(); ++d) {
    if (std::abs(d - best) > 1) runner_up = std::min(runner_up, cost_at(x, d));
  }
  out.best(x, y) = best;
  out.cost(x, y) = least;
  if (out.runner_up.empty()) return;
  out.runner_up(x, y) = runner_up;
  out.cost_before(x, y) = cost_at(x, best - 1);
  out.cost_after(x, y) = cost_at(x, best + 1);
  if (out.best_right.empty()) return;
  out.best_right(x, y) = best_right;
  out.mean_cost(x, y) = count > 0 ? total / count : kNoCost;
}

}  // namespace

Matches match_semi_global(const StereoPair& pair, const MatchConfig& config,
                          const SemiGlobalConfig& penalties) {
  const Size size = pair.size();
  Volume costs = costs_of(pair, config);
  const Image<Gray> smooth = smoothed(pair.left());
  Volume sums(size, config.min_disparity, config.num_disparities);
  add_paths(costs, smooth, penalties, 1, 0, sums);
  add_paths(costs, smooth, penalties, -1, 0, sums);
  add_paths(costs, smooth, penalties, 0, 1, sums);
  add_paths(costs, smooth, penalties, 0, -1, sums);
  Matches out = make_matches(size, config.maps);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) settle_pixel(sums, x, y, out);
  }
  return out;
}

}  // namespace cairn::reference
