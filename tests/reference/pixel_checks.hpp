// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/stereo/flatness.hpp>
#include <cairn/stereo/uniqueness.hpp>
#include <vector>

/// The slow twins of the checks that judge a pixel by its own costs, and the list of them for the equivalence
/// test.
namespace cairn::reference {

/// An image of judge(x, y).
template <class Judge>
Image<Reject> verdicts(Size size, Judge judge) {
  Image<Reject> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image(x, y) = judge(x, y);
  }
  return image;
}

inline Image<Reject> reject_ambiguous(const Matches& matches, const UniquenessConfig& config) {
  return verdicts(matches.best.size(), [&](int x, int y) {
    if (config.ratio < 0 || matches.best(x, y) == kNoMatch || matches.runner_up(x, y) == kNoCost)
      return Reject::none;
    const bool ambiguous = matches.runner_up(x, y) * (100.0F - config.ratio) < matches.cost(x, y) * 100.0F;
    return ambiguous ? Reject::not_unique : Reject::none;
  });
}

inline Image<Reject> reject_flat(const Matches& matches, const FlatnessConfig& config) {
  return verdicts(matches.best.size(), [&](int x, int y) {
    if (config.threshold < 0 || matches.best(x, y) == kNoMatch) return Reject::none;
    const float mean = matches.mean_cost(x, y);
    if (mean == 0) return Reject::flat;
    return (mean - matches.cost(x, y)) / mean < config.threshold ? Reject::flat : Reject::none;
  });
}

/// A check, its twin, and the options to compare them with.
template <class Config>
struct PixelCheck {
  const char* name;
  Image<Reject> (*fast)(const Matches&, const Config&, const Exec&);
  Image<Reject> (*slow)(const Matches&, const Config&);
  std::vector<Config> configs;
};

/// Calls visit() with each PixelCheck.
template <class Visit>
void for_each_pixel_check(Visit&& visit) {
  visit(PixelCheck<UniquenessConfig>{
      "uniqueness", cairn::reject_ambiguous, reject_ambiguous, {{-1}, {0}, {10}, {33.3F}, {100}}});
  visit(PixelCheck<FlatnessConfig>{
      "flatness", cairn::reject_flat, reject_flat, {{-1}, {0}, {0.1F}, {0.5F}, {1}}});
}

}  // namespace cairn::reference
