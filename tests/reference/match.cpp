// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "match.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

namespace cairn::reference {
namespace {

constexpr int kPartialSums = 16;  // of mean_cost; see sum_of_partials()

/// 1/√v in float, 0 for v = 0.
float inverse_root(std::int64_t v) {
  return v > 0 ? 1.0F / std::sqrt(static_cast<float>(v)) : 0.0F;
}

/// Adds sixteen partial sums in a fixed order. The k-th holds the costs of candidates k, k + 16, …, so a mean
/// does not depend on the number of lanes.
float sum_of_partials(const float* partial) {
  float quarter[4];
  for (int i = 0; i < 4; ++i) quarter[i] = (partial[i] + partial[i + 8]) + (partial[i + 4] + partial[i + 12]);
  return (quarter[0] + quarter[2]) + (quarter[1] + quarter[3]);
}

/// The input of the windows: grey levels, or zsad's 1/16 levels minus the local mean.
struct ImagePair {
  Image<std::int16_t> left;
  Image<std::int16_t> right;
};

Image<std::int16_t> picture(View<const Gray> image, const MatchConfig& config) {
  Image<Gray> filtered(image.size());
  for (int y = 0; y < image.height(); ++y) std::copy_n(image.row(y), image.width(), filtered.row(y));
  if (config.prefilter == Prefilter::xsobel) filtered = filter_xsobel(image, config.prefilter_cap);
  if (config.cost == Cost::zsad) return remove_mean(filtered, config.window_size);
  Image<std::int16_t> wide(image.size());
  for (int y = 0; y < image.height(); ++y) std::copy_n(filtered.row(y), image.width(), wide.row(y));
  return wide;
}

/// The cost of left pixel (x, y) and right pixel (x − d, y + row); kNoCost if that is outside.
float cost_of(const ImagePair& in, const MatchConfig& config, int x, int y, int d, int row) {
  if (!in.right.view().contains(x - d, y + row)) return kNoCost;
  std::int64_t n = 0, l = 0, r = 0, ll = 0, rr = 0, lr = 0, ad = 0;
  const int half = config.window_size / 2;
  for (int v = y - half; v <= y + half; ++v) {
    for (int u = x - half; u <= x + half; ++u) {
      if (!in.left.view().contains(u, v) || !in.right.view().contains(u - d, v + row)) continue;
      const std::int64_t a = in.left(u, v), b = in.right(u - d, v + row);
      n += 1, l += a, r += b, ll += a * a, rr += b * b, lr += a * b, ad += std::abs(a - b);
    }
  }
  const std::int64_t ssd = ll + rr - 2 * lr;
  // From exact sums to a float cost: one rounding per operation, so every target gets the same bits.
  switch (config.cost) {
    case Cost::sad:
      return static_cast<float>(ad);
    case Cost::ssd:
      return static_cast<float>(ssd);
    case Cost::zsad:
      return static_cast<float>(ad) * (1.0F / 16);
    case Cost::zssd:
      return static_cast<float>(n * ssd - (l - r) * (l - r)) * (1.0F / static_cast<float>(n));
    case Cost::nssd: {
      const float inverse = inverse_root(ll) * inverse_root(rr);
      return inverse > 0 ? static_cast<float>(ssd) * inverse : 65536.0F;
    }
    case Cost::zncc: {
      const float inverse = inverse_root(n * ll - l * l) * inverse_root(n * rr - r * r);
      // Rounding may take a perfect match below 0.
      return std::max(0.0F, 1.0F - static_cast<float>(n * lr - l * r) * inverse);
    }
  }
  return kNoCost;
}

/// The least cost over the rows y, y − 1, y + 1, y − 2 …, and its row.
std::pair<float, int> cost_in_band(const ImagePair& in, const MatchConfig& config, int x, int y, int d) {
  std::pair best{cost_of(in, config, x, y, d, 0), 0};
  for (int k = 1; k <= config.row_band; ++k) {
    for (const int row : {-k, k}) {
      const float cost = cost_of(in, config, x, y, d, row);
      if (cost < best.first) best = {cost, row};
    }
  }
  return best;
}

void match_pixel(const ImagePair& in, const MatchConfig& config, int x, int y, Matches& out) {
  std::vector<float> costs;
  std::array<float, kPartialSums> partial{};
  int count = 0;
  for (int i = 0; i < config.num_disparities; ++i) {
    costs.push_back(cost_in_band(in, config, x, y, config.min_disparity + i).first);
    if (costs.back() == kNoCost) continue;
    partial[static_cast<std::size_t>(i % kPartialSums)] += costs.back();
    ++count;
  }
  const int best = static_cast<int>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  const auto cost_at = [&](int i) {
    return i >= 0 && i < config.num_disparities ? costs[static_cast<std::size_t>(i)] : kNoCost;
  };
  out.cost(x, y) = cost_at(best);
  out.best(x, y) = count > 0 ? static_cast<std::int16_t>(config.min_disparity + best) : kNoMatch;
  if (config.row_band > 0) {
    out.row_offset(x, y) = static_cast<std::int8_t>(
        count > 0 ? cost_in_band(in, config, x, y, config.min_disparity + best).second : 0);
  }
  if (config.maps == MatchMaps::winner) return;
  out.runner_up(x, y) = kNoCost;
  for (int i = 0; i < config.num_disparities; ++i) {
    if (std::abs(i - best) > 1) out.runner_up(x, y) = std::min(out.runner_up(x, y), cost_at(i));
  }
  out.cost_before(x, y) = count > 0 ? cost_at(best - 1) : kNoCost;
  out.cost_after(x, y) = count > 0 ? cost_at(best + 1) : kNoCost;
  if (config.maps == MatchMaps::minimum) return;
  out.mean_cost(x, y) = count > 0 ? sum_of_partials(partial.data()) / static_cast<float>(count) : kNoCost;
}

/// Over the right image: every left pixel and row that may match (x_right, y_right).
std::int16_t best_of_right(const ImagePair& in, const MatchConfig& config, int x_right, int y_right) {
  std::int16_t best = kNoMatch;
  float least = kNoCost;
  for (int d = config.min_disparity; d < config.min_disparity + config.num_disparities; ++d) {
    for (int row = -config.row_band; row <= config.row_band; ++row) {
      if (!in.left.view().contains(x_right + d, y_right - row)) continue;
      const float cost = cost_of(in, config, x_right + d, y_right - row, d, row);
      if (cost < least) least = cost, best = static_cast<std::int16_t>(d);
    }
  }
  return best;
}

}  // namespace

Image<Gray> filter_xsobel(View<const Gray> image, int cap) {
  Image<Gray> out(image.size());
  const int width = image.width(), height = image.height();
  for (int y = 0; y < height; ++y) {
    const int above = y > 0 ? y - 1 : std::min(1, height - 1);
    const int below = y < height - 1 ? y + 1 : std::max(0, height - 2);
    for (int x = 0; x < width; ++x) {
      int slope = 0;
      for (const auto& [row, weight] : {std::pair{above, 1}, std::pair{y, 2}, std::pair{below, 1}}) {
        if (x > 0 && x < width - 1) slope += weight * (image(x + 1, row) - image(x - 1, row));
      }
      out(x, y) = static_cast<Gray>(std::clamp(slope, -cap, cap) + cap);
    }
  }
  return out;
}

Image<std::int16_t> remove_mean(View<const Gray> image, int window_size) {
  Image<std::int16_t> out(image.size());
  const int half = window_size / 2;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      int sum = 0, count = 0;  // the pixel itself always counts
      for (int v = y - half; v <= y + half; ++v) {
        for (int u = x - half; u <= x + half; ++u) {
          if (image.contains(u, v)) sum += image(u, v), ++count;
        }
      }
      count = std::max(count, 1);
      out(x, y) = static_cast<std::int16_t>(16 * image(x, y) - (16 * sum + count / 2) / count);
    }
  }
  return out;
}

Image<float> refine_subpixel(const Matches& matches, const SubpixelConfig& config) {
  Image<float> out(matches.best.size());
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      const std::int16_t best = matches.best(x, y);
      out(x, y) = best == kNoMatch ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(best);
      if (best == kNoMatch || config.method == SubpixelMethod::none || matches.cost_before.empty()) continue;
      const float a = matches.cost_before(x, y), m = matches.cost(x, y), c = matches.cost_after(x, y);
      const float rise = config.method == SubpixelMethod::parabola ? (a - m) + (c - m) : std::max(a, c) - m;
      if (rise > 0 && rise < kNoCost) out(x, y) += 0.5F * (a - c) / rise;
    }
  }
  return out;
}

Matches match(const StereoPair& pair, const MatchConfig& config) {
  const ImagePair in{picture(pair.left(), config), picture(pair.right(), config)};
  const Size size = pair.size();
  const Size band = config.row_band > 0 ? size : Size{};
  const Size minimum = config.maps != MatchMaps::winner ? size : Size{};
  const Size full = config.maps == MatchMaps::full ? size : Size{};
  Matches out{Image<std::int16_t>(size), Image<std::int16_t>(full), Image<std::int8_t>(band),
              Image<float>(size),        Image<float>(minimum),     Image<float>(full),
              Image<float>(minimum),     Image<float>(minimum)};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      match_pixel(in, config, x, y, out);
      if (!full.width) continue;
      out.best_right(x, y) = best_of_right(in, config, x, y);
    }
  }
  return out;
}

}  // namespace cairn::reference
