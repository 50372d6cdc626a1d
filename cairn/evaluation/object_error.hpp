// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/geometry.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/view.hpp>
#include <cstdint>
#include <limits>
#include <vector>

namespace cairn {

/// An object of a truth file: any number above 0, as in the file; ids need not be contiguous. dont_care =
/// pixels without truth: they count in no area.
enum class TruthId : std::int32_t { none = 0, dont_care = -1 };
constexpr std::int32_t number(TruthId id) {
  return static_cast<std::int32_t>(id);
}

struct ObjectErrorConfig {
  int min_area = 200;  // px; smaller true objects are not scored, smaller found ones are not phantoms
  float boundary_tolerance = 0.75F;  // % of the image's diagonal; rounded to px, at least 1
};

/// The cap of E in means and medians (200 %).
inline constexpr double kErrorCap = 2.0;

/// The score of one true object. Areas exclude don't-care pixels.
struct TrueObjectScore {
  TruthId id = TruthId::none;
  int pixel_count = 0;
  ObjectId found = ObjectId::none;  // found object of greatest IoU (ties: the lower id); none without overlap
  double iou = 0;
  double boundary_f = 0;         // 0 … 1: harmonic mean of boundary precision and recall; 0 without overlap
  bool over_segmented = false;   // two or more found objects, each mostly on it, cover more than half of it
  bool under_segmented = false;  // more than half of it is in a found object with most of another true one

  /// Equation (5): (A(M) + A(R) − 2·A(M∩R)) / A(M∩R) = 1/IoU − 1; infinite without overlap.
  [[nodiscard]] double error() const {
    return iou > 0 ? 1 / iou - 1 : std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] double capped_error() const { return error() < kErrorCap ? error() : kErrorCap; }
};

/// The score of one found object.
struct FoundObjectScore {
  ObjectId id = ObjectId::none;
  int pixel_count = 0;           // outside don't-care
  TruthId best = TruthId::none;  // the true object of greatest IoU, scored or not (ties: the lower id)
  double iou = 0;
  double share_on_objects = 0;    // 0 … 1: share of its pixels on any true object
  bool mostly_dont_care = false;  // more than half of it on don't-care: neither right nor wrong
  bool phantom = false;           // at least min_area px, less than a quarter of them on true objects
};

struct ObjectErrors {
  std::vector<TrueObjectScore> truth;  // true objects of at least min_area px, ascending by id
  std::vector<FoundObjectScore> ours;  // ascending by id
  int boundary_tolerance_px = 0;
};

/// Compares a label image with the truth of the same size. (docs/evaluation.md; paper, Eq. (5))
ObjectErrors object_errors(View<const ObjectId> ours, View<const TruthId> truth,
                           const ObjectErrorConfig& config);

/// Boundary F of two masks (non-zero = inside; `ignored`, may be empty, non-zero = neither): the harmonic
/// mean of the shares of each boundary within `tolerance_px` (Euclidean) of the other. The image border is
/// not a boundary. 1 for two masks without boundary; 0 if only one has a boundary.
double boundary_f(View<const std::uint8_t> a, View<const std::uint8_t> b, View<const std::uint8_t> ignored,
                  int tolerance_px);

/// The scores of many frames: counts, and means over all their objects. Shares of nothing are NaN.
struct ObjectSummary {
  int frames = 0;
  int true_objects = 0;  // scored ones
  int found_50 = 0;      // of these, with IoU ≥ 0.5
  int found_75 = 0;
  int missed = 0;  // of these, with E at or above its cap
  int over_segmented = 0;
  int under_segmented = 0;
  double mean_error = 0;  // of the capped E
  double median_error = 0;
  double mean_iou = 0;
  double mean_boundary_f = 0;        // over all scored objects
  double mean_boundary_f_found = 0;  // over those with IoU ≥ 0.5
  // Only from frames whose truth is complete:
  int complete_frames = 0;
  int our_objects = 0;  // found objects not mostly on don't-care
  int right_50 = 0;     // of these, with IoU ≥ 0.5 to a true object
  int right_75 = 0;
  int phantoms = 0;

  [[nodiscard]] double recall_50() const;
  [[nodiscard]] double recall_75() const;
  [[nodiscard]] double precision_50() const;
  [[nodiscard]] double precision_75() const;
  [[nodiscard]] double phantoms_per_frame() const;
};

/// The input of summarise() for one frame. partial: the truth does not contain every object, so found objects
/// cannot be wrong.
struct FrameObjects {
  ObjectErrors errors;
  bool partial = false;
};
ObjectSummary summarise(const std::vector<FrameObjects>& frames);

/// The middle value, or the mean of the two middle ones; NaN without values.
double median(std::vector<double> values);

}  // namespace cairn
