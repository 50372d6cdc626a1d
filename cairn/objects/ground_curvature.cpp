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

using Terms = std::array<double, 4>;

/// What is at a height h above the plane, a camera at H above it sees with (1 + h/H) times the plane's disparity d, to
/// first order. The distance is proportional to 1/d, and the place aside to u/d, where u is the column from the middle.
/// So a height that is quadratic in both adds (c₁ + c₂ u + c₃ u²)/d, and an error of the plane c₀.
class QuadraticGround {
 public:
  QuadraticGround(const GroundPlane& plane, const StereoRig& rig, int width)
      : plane_(plane),
        infinity_px_(-double{rig.doffs_px}),
        middle_(double{rig.cx_px}),
        half_width_(width / 2.0) {}

  /// From infinity.
  [[nodiscard]] double plane_px(int x, int y) const {
    return double{plane_.disparity_px(static_cast<float>(x), static_cast<float>(y))} - infinity_px_;
  }
  [[nodiscard]] double off_px(float disparity_px, double plane_px) const {
    return double{disparity_px} - infinity_px_ - plane_px;
  }
  [[nodiscard]] Terms terms(int x, double plane_px) const {
    const double u = (x - middle_) / half_width_;
    const double away = kNear / plane_px;
    return {1, away, u * away, u * u * away};
  }
  [[nodiscard]] static bool is_seen(double plane_px) { return plane_px >= kFarthest; }

 private:
  // px: so large that fit_robustly() hardly damps what bends the ground by a few pixels.
  static constexpr double kNear = 40;
  static constexpr double kFarthest = 1;  // px
  GroundPlane plane_;
  double infinity_px_;
  double middle_;
  double half_width_;
};

}  // namespace

Image<float> without_curvature(Image<float> disparity_px, View<const ObstacleLabel> space,
                               const GroundPlane& plane, const StereoRig& rig) {
  const QuadraticGround ground(plane, rig, space.width());
  const auto step =
      static_cast<int>(std::ceil(std::sqrt(static_cast<double>(space.size().area()) / kSamples)));
  std::vector<Equation<4>> floor;
  for (int y = 0; y < space.height(); y += step) {
    for (int x = 0; x < space.width(); x += step) {
      const double plane_px = ground.plane_px(x, y);
      const double off_px = ground.off_px(disparity_px(x, y), plane_px);
      if (space(x, y) == ObstacleLabel::floor && QuadraticGround::is_seen(plane_px) &&
          std::abs(off_px) <= kFarthestOff)
        floor.push_back({ground.terms(x, plane_px), off_px});
    }
  }
  if (floor.size() < kFewest) return disparity_px;
  const Terms curvature = fit_robustly<4>(floor, kOutlier);
  double gained = 0;
  for (const Equation<4>& at : floor) {
    gained += std::abs(at.value - predicted(curvature, at.terms)) <= kMargin ? 1 : 0;
    gained -= std::abs(at.value) <= kMargin ? 1 : 0;
  }
  if (gained < kGain * static_cast<double>(floor.size())) return disparity_px;
  for (int y = 0; y < space.height(); ++y) {
    for (int x = 0; x < space.width(); ++x) {
      const double plane_px = ground.plane_px(x, y);
      if (space(x, y) == ObstacleLabel::floor && QuadraticGround::is_seen(plane_px))
        disparity_px(x, y) -= static_cast<float>(predicted(curvature, ground.terms(x, plane_px)));
    }
  }
  return disparity_px;
}

}  // namespace cairn
