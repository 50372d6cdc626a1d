// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/statistics.hpp>
#include <cairn/input/sequence_scores_json.hpp>
#include <numbers>

namespace cairn::input {
namespace {

using output::finite;
using output::Json;

constexpr double kDegrees = 180 / std::numbers::pi;

Json json_of(const TrackErrors& e) {
  return {{"HOTA", e.hota},         {"DetA", e.det_a},     {"DetRe", e.det_re},   {"DetPr", e.det_pr},
          {"AssA", e.ass_a},        {"AssRe", e.ass_re},   {"AssPr", e.ass_pr},   {"LocA", e.loc_a},
          {"MOTA", e.mota},         {"MOTP", e.motp},      {"CLR_TP", e.right},   {"CLR_FN", e.missed},
          {"CLR_FP", e.wrong},      {"IDSW", e.switches},  {"Frag", e.fragments}, {"MT", e.mostly_tracked},
          {"PT", e.partly_tracked}, {"ML", e.mostly_lost}, {"IDF1", e.id_f1},     {"IDP", e.id_precision},
          {"IDR", e.id_recall},     {"IDTP", e.id_right},  {"IDFN", e.id_missed}, {"IDFP", e.id_wrong}};
}

Json places_json(const std::vector<double>& errors_m) {
  return {{"compared", errors_m.size()},
          {"median_m", finite(percentile(errors_m, 0.5))},
          {"p95_m", finite(percentile(errors_m, 0.95))}};
}

Json moving_json(const MovingErrors& e) {
  if (!e.is_known) return nullptr;
  Json detected = Json::object();
  for (const auto& [id, frames] : e.frames_to_detect)
    detected[std::to_string(id)] = frames ? Json(*frames) : Json(nullptr);
  return {
      {"frames_to_detect", detected},         {"moving", e.moving},
      {"moving_labelled", e.labelled},        {"at_rest", e.at_rest},
      {"at_rest_labelled", e.labelled_wrong}, {"false_share", finite(share(e.labelled_wrong, e.at_rest))}};
}

Json landmarks_json(const LandmarkErrors& e) {
  if (!e.is_known) return nullptr;
  return {{"in_view_again", e.again},
          {"re_identified", e.re_identified},
          {"wrong", e.wrong},
          {"repeatability", finite(share(e.re_identified, e.again))},
          {"false_share", finite(share(e.wrong, e.re_identified + e.wrong))}};
}

Json changes_json(const ChangeErrors& e) {
  if (!e.is_known) return nullptr;
  return {{"expected", e.expected},
          {"found", e.found},
          {"reported", e.reported},
          {"wrong", e.wrong},
          {"precision", finite(share(e.reported - e.wrong, e.reported))},
          {"recall", finite(share(e.found, e.expected))},
          {"median_error_m", finite(percentile(e.errors_m, 0.5))}};
}

}  // namespace

Json json_of(const TrajectoryError& e) {
  return {{"compared", e.compared},
          {"missing", e.missing},
          {"path_m", e.path_m},
          {"ate_rmse_m", finite(e.ate_rmse_m)},
          {"ate_max_m", finite(e.ate_max_m)},
          {"rpe_frame_m", finite(e.rpe_frame_m)},
          {"rpe_frame_deg", finite(kDegrees * e.rpe_frame_rad)},
          {"rpe_metre_m", finite(e.rpe_metre_m)},
          {"rpe_metre_deg", finite(kDegrees * e.rpe_metre_rad)},
          {"sub_paths", e.sub_paths},
          {"t_rel", finite(e.t_rel)},
          {"r_rel_deg_per_m", finite(kDegrees * e.r_rel_rad_per_m)},
          {"end_error_m", finite(e.end_error_m)},
          {"end_error_deg", finite(kDegrees * e.end_error_rad)},
          {"end_drift", finite(e.end_drift)}};
}

Json json_of(const SequenceScores& s) {
  const ObjectSummary& o = s.objects;
  return {
      {"frames", s.frames},
      {"tracks", json_of(s.tracks)},
      {"by_landmark", s.by_landmark ? json_of(*s.by_landmark) : Json(nullptr)},
      {"oracle_ids", json_of(s.oracle)},
      {"objects",
       {{"scored", o.true_objects},
        {"found_50", o.found_50},
        {"found_75", o.found_75},
        {"recall_50", finite(o.recall_50())},
        {"recall_75", finite(o.recall_75())},
        {"ours", o.our_objects},
        {"precision_50", finite(o.precision_50())},
        {"precision_75", finite(o.precision_75())},
        {"phantoms_per_frame", finite(o.phantoms_per_frame())},
        {"mean_error", finite(o.mean_error)},
        {"median_error", finite(o.median_error)},
        {"mean_boundary_f", finite(o.mean_boundary_f)}}},
      {"steadiness",
       {{"object_frames", s.steadiness.object_frames},
        {"found_again", s.steadiness.found_again},
        {"found_again_per_100", finite(100 * share(s.steadiness.found_again, s.steadiness.object_frames))},
        {"mean_iou_difference", finite(s.steadiness.iou_difference)}}},
      {"positions",
       {{"in_map", places_json(s.places.in_map_m)},
        {"in_camera", places_json(s.places.in_camera_m)},
        {"with_covariance", s.places.stated},
        {"inside_95", finite(share(s.places.inside, s.places.stated))},
        {"median_nees", finite(percentile(s.places.normalised, 0.5))}}},
      {"moving", moving_json(s.moving)},
      {"landmarks", landmarks_json(s.landmarks)},
      {"changes", changes_json(s.changes)},
      {"trajectory", s.trajectory ? json_of(*s.trajectory) : Json(nullptr)}};
}

}  // namespace cairn::input
