// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/regions/region_cues.hpp>
#include <span>
#include <string_view>

/// The features of the fitted trees. None depends on the image size, the focal length or the baseline except
/// through px of disparity, the unit of matching errors.
namespace cairn {

/// The value of an unknown feature.
inline constexpr float kUnknown = -999.0F;

/// A least-squares plane of disparity, px; fronto-parallel for small regions.
struct FittedPlane {
  bool any = false;
  double a = 0, b = 0;         // px per px
  double d = 0, x = 0, y = 0;  // a point of the plane; x and y from the image centre
  double squares = 0;          // sum of squared residuals, including the cost of levelling
  [[nodiscard]] double at(double px, double py) const { return d + a * (px - x) + b * (py - y); }
};
/// Fits the plane. `width`: of the image.
FittedPlane fit_plane(const PlaneMoments& moments, int width);

/// Votes of a region's hints: their centroid and spread, in cells; log₂ of the voted size.
struct HintVotes {
  bool any = false;  // their weight suffices
  double x = 0, y = 0, spread = 0, size = 0;
};

/// Fits of a region: planes through all its disparities and through its textured ones, the votes of its
/// hints, and the distances of its colours from those of floor and background.
struct RegionFits {
  FittedPlane matched, textured;
  HintVotes votes;
  double to_floor = kUnknown, to_background = kUnknown;  // χ², 0 … 6
};

/// The colours of the superpixels mostly on the ground, or in the background.
struct SceneColours {
  std::int64_t area = 0;  // px
  Histogram histogram{};
  void add(const RegionCues& region);
};

/// Statistics shared by all regions of a frame.
struct FrameCues {
  int width = 0;
  int height = 0;
  bool has_colour = false;
  bool has_ground = false;
  bool has_hints = false;
  double cells_per_px = 0;  // of the hints
  int cells_across = 0;
  int cells_down = 0;
  int walls_and_floor = 0;
  float noise_sigma = 0;
  float matched_share = 0;
  float evidence_share = 0;
  double nearest_px = 1;  // the greatest mean disparity of a superpixel, at least 1
  SceneColours floor, background;
};
FrameCues frame_cues(const RegionGraphCues& graph, const Cues& cues);
RegionFits fit_region(const RegionCues& region, const FrameCues& frame);

inline constexpr std::size_t kMergeFeatures = 57;
inline constexpr std::size_t kObjectFeatures = 87;
using MergeFeatures = std::array<float, kMergeFeatures>;
using ObjectFeatures = std::array<float, kObjectFeatures>;

/// One side of a contact.
struct RegionSide {
  const RegionCues& cues;
  const RegionFits& fits;
};

/// The features for whether two touching regions belong to one object. `a`, `b`: as in the contact.
MergeFeatures merge_features(const RegionSide& a, const RegionSide& b, const ContactCues& contact,
                             const FrameCues& frame);

/// A neighbour of a region.
struct Neighbour {
  RegionSide side;
  const ContactCues& contact;
  bool turned;       // a of the contact is the neighbour
  float same_thing;  // merge_classifier() of the two
};

/// The merge history of a region; of a superpixel: {20, 20, 1}.
struct Origin {
  float same_thing = 0;        // merge_classifier() of its two parts when merged
  float least_same_thing = 0;  // the minimum over all merges in it
  float larger_part = 1;       // share of its area
};

/// The features for whether a region is a whole object. The last two are unknown until the region itself is
/// merged: see report_end().
ObjectFeatures object_features(const RegionSide& region, std::span<const Neighbour> neighbours,
                               const Origin& origin, const FrameCues& frame);
/// Sets these two: the share of the region in its parent, and merge_classifier() of that merge.
void report_end(ObjectFeatures& features, float share, float same_thing);

/// The names of the features, in order.
std::vector<std::string_view> merge_feature_names();
std::vector<std::string_view> object_feature_names();

}  // namespace cairn
