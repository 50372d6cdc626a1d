// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/view.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cstdint>
#include <vector>

#include "pose.hpp"
#include "tracks.hpp"

namespace cairn {

/// One frame of a sequence as the scores of tracks take it: the objects that are there, those that were
/// found, and how well each covers each. No id twice in a frame; ids may be any numbers.
struct ScoredFrame {
  std::vector<std::int64_t> truth;
  std::vector<std::int64_t> ours;
  std::vector<double> similarity;  // truth × ours, row by row: IoU of the masks, 0 … 1

  [[nodiscard]] double at(std::size_t true_object, std::size_t our_object) const {
    return similarity[true_object * ours.size() + our_object];
  }
};

/// Scores of objects over time, as TrackEval defines them. Shares are 0 … 1, but MOTA, which may be negative.
struct TrackErrors {
  // Higher order tracking accuracy (Luiten et al. 2020): means over similarities of at least .05, .1, … .95.
  double hota = 0;
  double det_a = 0;   // detection: right ÷ (right + missed + wrong)
  double det_re = 0;  // its recall
  double det_pr = 0;  // its precision
  double ass_a = 0;   // association: how much of its true object each right detection's track covers
  double ass_re = 0;
  double ass_pr = 0;
  double loc_a = 0;  // mean similarity of what is right
  // CLEAR MOT (Bernardin and Stiefelhagen 2008): similarity of at least .5.
  double mota = 0;
  double motp = 0;
  int right = 0;
  int missed = 0;
  int wrong = 0;
  int switches = 0;        // IDSW: a true object goes on under another id
  int fragments = 0;       // Frag: a true object is lost and found again
  int mostly_tracked = 0;  // MT: true objects matched in more than 80 % of their frames
  int partly_tracked = 0;  // PT
  int mostly_lost = 0;     // ML: in less than 20 %
  // Identity (Ristani et al. 2016): one of our tracks for each true object, similarity of at least .5.
  double id_f1 = 0;
  double id_precision = 0;
  double id_recall = 0;
  int id_right = 0;
  int id_missed = 0;
  int id_wrong = 0;
};

/// Exactly what TrackEval 1.0 computes of the same table (metrics HOTA, CLEAR, Identity), but where several
/// assignments are equally good: then TrackEval's choice follows the order of the ids, ours another.
TrackErrors track_errors(const std::vector<ScoredFrame>& frames);

/// The same detections as a tracker without fault would name them: each has the id of the true object that it
/// covers best. Of several on one true object the best has it; the others, and those on none, have ids of
/// their own, which are negative. What track_errors() gives for them is due to the segmentation alone.
std::vector<ScoredFrame> oracle_ids(std::vector<ScoredFrame> frames);

/// Which of ours is which true object in each frame, as CLEAR MOT matches them: similarity of at least .5,
/// matches of the frame before are kept. By true object: the index in `ours`, or −1.
std::vector<std::vector<int>> clear_matches(const std::vector<ScoredFrame>& frames);

/// Which detections count, where the truth does not say everything.
struct ScoredFrameRules {
  int min_area = 200;    // px; smaller true objects are neither right nor wrong
  bool partial = false;  // not every object is labelled: nor is what has no label
};

/// The two label images of a frame compared. Pixels of don't-care count in no area. Ours that lie by more
/// than half of their pixels where they can be neither right nor wrong are left out: on don't-care, on true
/// objects below min_area, with `partial` on what is not labelled. Ids ascend.
ScoredFrame scored_frame(View<const TrackId> ours, View<const TruthId> truth, const ScoredFrameRules& rules);

/// How steadily each true object is found, whatever its id: with a similarity of at least .5 to any of ours.
struct Steadiness {
  int object_frames = 0;
  int found = 0;
  int found_again = 0;        // it was lost for a frame or more, though there, and found again
  int pairs = 0;              // of two frames in a row with the same true object
  double iou_difference = 0;  // mean |ΔIoU| of these; NaN of none
};
Steadiness steadiness(const std::vector<ScoredFrame>& frames);

/// eᵀ·C⁻¹·e of an error against its stated covariance; NaN where that is none.
double squared_mahalanobis(Point3 error_m, const Covariance3& covariance_m2);
/// χ² of 3 degrees of freedom: 95 % of what is stated rightly is below.
inline constexpr double kChi2Of3At95 = 7.814728;

}  // namespace cairn
