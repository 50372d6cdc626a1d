// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/regions/choose_objects.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

/// Corrects gross errors of disparity, and fills holes, by choosing the plane that each group of pixels lies on.
/// (docs/stages/refinement.md, beyond the paper)
namespace cairn {

/// A disparity for each pixel, with its reliability.
struct RefinedDisparity {
  Image<float> disparity_px;  // NaN: neither a disparity nor a plane is known
  Image<float> confidence;    // 0 … 1: probability that it is within 1 px of the truth; 0 where NaN
};

/// A plane of disparity, px: d = a·x + b·y + c at the pixel (x, y).
struct DisparityPlane {
  double a = 0, b = 0, c = 0;
  [[nodiscard]] double at(double x, double y) const { return a * x + b * y + c; }
};

/// The inputs of refine_disparity(). Borrows everything.
struct RefinementCues {
  const Superpixels& superpixels;
  const MergeTree& tree;         // grown from them: its contacts and statistics are read
  const ChosenObjects& chosen;   // from it
  const Cues& cues;              // as for the tree
  View<const float> confidence;  // estimate_confidence(); may be empty
};

inline constexpr std::size_t kPlaneFeatures = 25;
using PlaneFeatures = std::array<float, kPlaneFeatures>;
std::array<std::string_view, kPlaneFeatures> plane_feature_names();

/// A pixel of a superpixel.
struct SuperpixelPixel {
  std::int32_t x = 0, y = 0;
  float disparity_px = 0;  // NaN in holes
  float confidence = 0;
  bool is_textured = false;
};
/// A choice that was judged: for a group of pixels one plane, or none: each keeps its disparity.
struct JudgedPlane {
  std::int32_t superpixel = 0;
  int group = 0;                            // 0 … 4, see refine_disparity()
  std::span<const SuperpixelPixel> pixels;  // samples, see refine_disparity()
  double pixels_per_sample = 2;
  std::optional<DisparityPlane> plane;
  const PlaneFeatures& features;
};
/// The disparity of a pixel on a plane: its own one if that is within 1 px of the plane.
float disparity_on(const std::optional<DisparityPlane>& plane, const SuperpixelPixel& pixel);

/// The most likely disparity of each pixel. The pixels of each superpixel are divided into five groups: those
/// within 1.5 px of its main plane, those within 1.5 px of a second one, those nearer than the main one (without one:
/// all), those farther, and holes. Each group keeps its disparities or takes a plane: the main, the second, the one
/// through the textured disparities, those of ground and background, or the main planes of up to eight neighbours.
/// `right_plane` gives the log-odds that a choice is right; the likeliest is made (keeping is preferred by 0.05; ties:
/// the first), and stated as the confidence. Samples are every second pixel, as on a
/// chequerboard; of a superpixel of n²·512 px or more, of every n-th row and column. Groups of one sample are kept, with
/// log-odds of 0 on the main plane and −2 elsewhere. Pixels within 1 px of the chosen plane keep their own disparity, too; for all that
/// keep it, the confidence of the match counts. Values are limited to the range of all disparities.
///
/// `right_plane`: plane_classifier(), or fitted. `on_judged`: called for each choice that was judged, in order, for
/// fitting. Precondition: the tree was grown from these superpixels.
RefinedDisparity refine_disparity(const RefinementCues& cues, const FittedTrees& right_plane,
                                  const Exec& exec,
                                  const std::function<void(const JudgedPlane&)>& on_judged = {});

/// The log-odds that a group of pixels lies on a plane, from PlaneFeatures. Fitted by ./dev fit.
const FittedTrees& plane_classifier();

/// The same, without those of the sky: NaN there.
RefinedDisparity without_sky(RefinedDisparity refined, View<const Reject> reject);

/// A usual least confidence: a refined disparity is then more often right than wrong by far, and few pixels are holes.
inline constexpr float kMinRefined = 0.3F;
/// The refined disparities with at least this confidence. Others are holes, with the reasons that they had, and
/// Reject::unlikely.
DisparityMap likely_disparities(const RefinedDisparity& refined, View<const Reject> reject,
                                float min_confidence, const Exec& exec);

}  // namespace cairn
