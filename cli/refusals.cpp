// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "refusals.hpp"

#include <algorithm>
#include <cairn/image/noise.hpp>
#include <cairn/stereo/texture.hpp>
#include <cmath>

#include "terminal.hpp"

namespace cairn::cli {
namespace {

/// Pixels without more texture than noise produces, whose squared differences are 2 σ² on average.
Image<Reject> without_texture(View<const Gray> left, const Exec& exec) {
  const float sigma = noise_sigma(left, exec);
  TextureConfig config;
  config.threshold += 2 * sigma * sigma;
  return reject_textureless(left, config, exec);
}

}  // namespace

Refusals count_refusals(const DisparityMap& map, View<const Gray> left, Reject in_force, const Exec& exec) {
  const Image<Reject> plain = without_texture(left, exec);
  const auto area = static_cast<double>(map.reject.size().area());
  Refusals all;
  std::int64_t plain_pixels = 0;
  for (int y = 0; y < plain.height(); ++y)
    plain_pixels += std::count(plain.row(y), plain.row(y) + plain.width(), Reject::no_texture);
  all.dark_or_plain = static_cast<double>(plain_pixels) / area;
  for (const auto& reason : kRejects) {
    std::int64_t count = 0;
    std::int64_t untextured = 0;
    for (int y = 0; y < map.reject.height(); ++y) {
      for (int x = 0; x < map.reject.width(); ++x) {
        const bool is_refused = has(map.reject(x, y), reason.value);
        count += is_refused ? 1 : 0;
        untextured += is_refused && plain(x, y) != Reject::none ? 1 : 0;
      }
    }
    if (!is_listed(reason.value, in_force, count)) continue;
    all.counts.push_back(
        {std::string(reason.name), static_cast<double>(count) / area,
         count > 0 ? static_cast<double>(untextured) / static_cast<double>(count) : std::nan("")});
  }
  return all;
}

std::string refusals_line(const Refusals& refusals) {
  constexpr double kRare = 0.0005;      // prints as 0.0 %
  constexpr double kWorthAWord = 0.05;  // share of the pixels worth mentioning
  constexpr double kClearlyMore = 0.1;  // above the share in the whole image
  std::string all;
  for (const RefusalCount& refusal : refusals.counts) {
    if (refusal.share < kRare) continue;
    all += (all.empty() ? "refused: " : ", ") + refusal.name + " " + percent(refusal.share);
    if (refusal.share >= kWorthAWord && refusal.dark_or_plain > refusals.dark_or_plain + kClearlyMore)
      all += text_of(" (%.0f %% of it too dark or without texture)", 100 * refusal.dark_or_plain);
  }
  return all;
}

std::string refusals_table(const Refusals& refusals) {
  Table table({"refused (a pixel may have several reasons)", "share", "of it too dark or without texture"});
  table.add({"every pixel", percent(1), percent(refusals.dark_or_plain)});
  for (const RefusalCount& refusal : refusals.counts)
    table.add({refusal.name, percent(refusal.share), percent(refusal.dark_or_plain)});
  return table.text();
}

}  // namespace cairn::cli
