// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <array>
#include <cairn/core/robust_fit.hpp>
#include <cairn/objects/ground_curvature.hpp>
#include <cmath>
#include <vector>

namespace cairn {
namespace {

constexpr double kMargin = 1;         // px
constexpr double kOutlier = 0.5;      // px: of half the weight
constexpr double kFarthestOff = 5;    // px; what is farther from the plane has not the disparity of the floor
constexpr double kGain = 0.03;        // of the floor
constexpr double kSamples = 5000;     // pixels looked at, whatever the size of the image
constexpr std::size_t kFewest = 100;  // of them on the floor
constexpr double kFarthest = 1;       // px of the plane's disparity from infinity
// px: so large that fit_robustly() hardly damps what bends the ground by a few pixels.
constexpr double kNear = 40;

using Terms = std::array<double, 4>;

/// What is at a height h above the plane, a camera at H above it sees with (1 + h/H) times the plane's disparity d, to
/// first order. The distance is proportional to 1/d, and the place aside to u/d, where u is the column from the middle.
/// So a height that is quadratic in both adds (c₁ + c₂ u + c₃ u²)/d, and an error of the plane c₀.
Terms terms(double u, double plane_from_infinity_px) {
  const double away = kNear / plane_from_infinity_px;
  return {1, away, u * away, u * u * away};
}

}  // namespace

Image<float> without_curvature(Image<float> disparity_px, View<const ObstacleLabel> space,
                               const Ground& ground, const StereoRig& rig) {
  if (!ground.plane || space.empty()) return disparity_px;
  const double half_width = space.width() / 2.0;
  // visit(disparity, how far it is in front of the plane, its terms) for every `step`th pixel of the floor.
  const auto each = [&](int step, const auto& visit) {
    for (int y = 0; y < space.height(); y += step) {
      for (int x = 0; x < space.width(); x += step) {
        const auto plane_px =
            double{ground.plane->disparity_px(static_cast<float>(x), static_cast<float>(y))};
        const double from_infinity_px = plane_px + double{rig.doffs_px};
        if (space(x, y) != ObstacleLabel::floor || from_infinity_px < kFarthest) continue;
        float& d = disparity_px(x, y);
        visit(d, double{d} - plane_px, terms((x - double{rig.cx_px}) / half_width, from_infinity_px));
      }
    }
  };
  std::vector<Equation<4>> floor;
  each(static_cast<int>(std::ceil(std::sqrt(static_cast<double>(space.size().area()) / kSamples))),
       [&](float, double off_px, const Terms& at) {
         if (std::abs(off_px) <= kFarthestOff) floor.push_back({at, off_px});
       });
  if (floor.size() < kFewest) return disparity_px;
  const Terms curvature = fit_robustly<4>(floor, kOutlier);
  double gained = 0;
  for (const Equation<4>& at : floor) {
    gained += std::abs(at.value - predicted(curvature, at.terms)) <= kMargin ? 1 : 0;
    gained -= std::abs(at.value) <= kMargin ? 1 : 0;
  }
  if (gained < kGain * static_cast<double>(floor.size())) return disparity_px;
  each(1, [&](float& d, double, const Terms& at) { d -= static_cast<float>(predicted(curvature, at)); });
  return disparity_px;
}

}  // namespace cairn
