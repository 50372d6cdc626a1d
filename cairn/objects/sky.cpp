// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/statistics.hpp>
#include <cairn/objects/sky.hpp>
#include <cairn/regions/runs.hpp>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

namespace cairn {
namespace {

constexpr float kSky = 0.6F;      // probability
constexpr float kTrusted = 0.7F;  // confidence
constexpr float kNear_px = 2.0F;  // above the disparity of infinity
constexpr float kMostNear = 0.9F;
constexpr int kContrast = 24;  // grey levels

struct Sums {
  std::int64_t pixels = 0, brightness = 0, above = 0, near = 0;
  bool touches_the_top = false;
};

}  // namespace

float sky_probability(const SkyFeatures& of) {
  // However bright it is in a dark image: a white lorry at dusk.
  if (of.near > kMostNear) return 0;
  // Fitted by lab/outdoors.py.
  return likelihood(-8.72F + 12.17F * of.brightness - 14.06F * of.image_brightness +
                    5.97F * of.above_horizon - 7.19F * of.near + (of.touches_the_top ? 2.92F : 0.0F));
}

DisparityMap reject_sky(DisparityMap disparity, const SkyCues& cues, const std::optional<StereoRig>& rig,
                        const Exec& exec) {
  if (!cues.ground.plane) return disparity;
  const GroundPlane floor = *cues.ground.plane;
  const float infinity_px = rig ? -rig->doffs_px : 0;
  const Size size = cues.left.size();
  const std::vector<float> all_trusted(cues.confidence.empty() ? slot(size.width) : 0, 1.0F);

  // Sums of a run are numbers without branches, which compilers vectorise.
  std::vector<Sums> sums;
  std::int64_t brightness = 0;
  for_each_run(cues.superpixels, exec, [&](const Run& run) {
    const Gray* const left = cues.left.row(run.y);
    const float* const d = disparity.disparity_px.row(run.y);
    const float* const sure = cues.confidence.empty() ? all_trusted.data() : cues.confidence.row(run.y);
    const float row_px = floor.b * static_cast<float>(run.y) + floor.c;
    int grey = 0, above = 0, near = 0;
    for (int x = run.first; x < run.last; ++x) {
      grey += left[x];
      above += floor.a * static_cast<float>(x) + row_px <= infinity_px ? 1 : 0;
      near += (d[x] > infinity_px + kNear_px) & (sure[x] >= kTrusted) ? 1 : 0;  // not in holes, which are NaN
    }
    if (index(run.label) >= sums.size()) sums.resize(index(run.label) + 1);
    Sums& sum = sums[index(run.label)];
    sum.pixels += run.length();
    sum.brightness += grey;
    sum.above += above;
    sum.near += near;
    sum.touches_the_top |= run.y == 0;
    brightness += grey;
  });

  const auto share = [](std::int64_t part, std::int64_t whole) {
    return static_cast<float>(part) / static_cast<float>(whole);
  };
  constexpr int kNoSky = -1;
  std::vector<int> sky_grey(sums.size(), kNoSky);  // mean grey level of a superpixel that is sky
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const Sums& of = sums[i];
    if (of.pixels == 0) continue;
    const float probability =
        sky_probability({share(of.brightness, 255 * of.pixels), share(brightness, 255 * size.area()),
                         share(of.above, of.pixels), share(of.near, of.pixels), of.touches_the_top});
    if (probability > kSky) sky_grey[i] = static_cast<int>(of.brightness / of.pixels);
  }
  // Indoors, nothing is left to do.
  if (std::all_of(sky_grey.begin(), sky_grey.end(), [](int grey) { return grey == kNoSky; }))
    return disparity;
  for_each_run(cues.superpixels, exec, [&](const Run& run) {
    const int grey = sky_grey[index(run.label)];
    for (int x = run.first; x < run.last && grey != kNoSky; ++x) {
      if (cues.objects(x, run.y) != ObjectId::none || std::abs(cues.left(x, run.y) - grey) > kContrast)
        continue;
      disparity.reject(x, run.y) |= Reject::sky;
      disparity.disparity_px(x, run.y) = std::numeric_limits<float>::quiet_NaN();
    }
  });
  return disparity;
}

}  // namespace cairn
