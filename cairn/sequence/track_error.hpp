// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/view.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cstdint>
#include <vector>

#include <cairn/sequence/pose.hpp>
#include <cairn/sequence/tracks.hpp>

namespace cairn {

/// One frame of a sequence for scoring: the true objects, the detected ones, and how well each covers each.
/// Ids are unique within a frame, otherwise arbitrary.
struct ScoredFrame {
  std::vector<std::int64_t> truth;
  std::vector<std::int64_t> ours;
  std::vector<double> similarity;  // truth × ours, row-major: IoU of the masks, 0 … 1

  [[nodiscard]] double at(std::size_t true_object, std::size_t our_object) const {
    return similarity[true_object * ours.size() + our_object];
  }
};

/// Scores of objects over time, as defined by TrackEval. Shares are 0 … 1, except MOTA, which may be
/// negative.
struct TrackErrors {
  // Higher order tracking accuracy (Luiten et al. 2020): means over similarities of at least .05, .1, … .95.
  double hota = 0;
  double det_a = 0;   // detection: correct ÷ (correct + missed + false)
  double det_re = 0;  // its recall
  double det_pr = 0;  // its precision
  double ass_a = 0;   // association: share of its true object covered by the track of each correct detection
  double ass_re = 0;
  double ass_pr = 0;
  double loc_a = 0;  // mean similarity of the correct detections
  // CLEAR MOT (Bernardin and Stiefelhagen 2008): similarity of at least .5.
  double mota = 0;
  double motp = 0;
  int right = 0;
  int missed = 0;
  int wrong = 0;
  int switches = 0;        // IDSW: a true object continues under another id
  int fragments = 0;       // Frag: a true object is lost and found again
  int mostly_tracked = 0;  // MT: true objects matched in more than 80 % of their frames
  int partly_tracked = 0;  // PT: the rest
  int mostly_lost = 0;     // ML: in less than 20 %
  // Identity (Ristani et al. 2016): one found track per true object, similarity of at least .5.
  double id_f1 = 0;
  double id_precision = 0;
  double id_recall = 0;
  int id_right = 0;
  int id_missed = 0;
  int id_wrong = 0;
};

/// Equal to TrackEval 1.0 on the same table (metrics HOTA, CLEAR, Identity), except for ties between
/// assignments: TrackEval resolves them by the order of the ids, this function differently.
TrackErrors track_errors(const std::vector<ScoredFrame>& frames);

/// The same detections with the ids of a perfect tracker: each has the id of the true object that it covers
/// best. Of several on one true object, the best has it; the others, and those on none, have unique negative
/// ids. Their track_errors() are due to the segmentation alone.
std::vector<ScoredFrame> oracle_ids(std::vector<ScoredFrame> frames);

/// The found object of each true object in each frame, as matched by CLEAR MOT: similarity of at least .5,
/// matches of the frame before are kept. By true object: the index in `ours`, or −1.
std::vector<std::vector<int>> clear_matches(const std::vector<ScoredFrame>& frames);

/// The detections that count if the truth is incomplete.
struct ScoredFrameRules {
  int min_area = 200;    // px; smaller true objects are ignored
  bool partial = false;  // not every object is labelled: unlabelled pixels are ignored
};

/// Compares the two label images of a frame. Don't-care pixels count in no area. Found objects are left out
/// if more than half of their pixels are on ignored areas: don't-care, true objects below min_area, and, with
/// `partial`, unlabelled pixels. Ids ascend.
ScoredFrame scored_frame(View<const TrackId> ours, View<const TruthId> truth, const ScoredFrameRules& rules);

/// The stability of the detection of true objects, whatever their id: similarity of at least .5 to any found
/// object.
struct Steadiness {
  int object_frames = 0;
  int found = 0;
  int found_again = 0;  // times an object was missed for a frame or more, though present, and found again
  int pairs = 0;        // pairs of consecutive frames with the same true object
  double iou_difference = 0;  // mean |ΔIoU| of these; NaN without pairs
};
Steadiness steadiness(const std::vector<ScoredFrame>& frames);

/// eᵀ·C⁻¹·e of an error with its covariance; NaN if that is not positive definite.
double squared_mahalanobis(Point3 error_m, const Covariance3& covariance_m2);
/// χ² of 3 degrees of freedom: 95 % quantile.
inline constexpr double kChi2Of3At95 = 7.814728;

}  // namespace cairn
