// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "evaluate_sequence.hpp"

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/core/statistics.hpp>
#include <cairn/input/sequence_scores_json.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/output/trajectory_files.hpp>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <numbers>
#include <set>

#include "evaluation_text.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

using input::PlaceErrors, input::MovingErrors, input::SequenceScores;
using output::Json;

constexpr double kDegrees = 180 / std::numbers::pi;

std::string points(double value) {
  return text_of("%.1f", 100 * value);
}

std::string metres(double value) {
  return text_of("%.3f m", value);
}

// ---- JSON ----

std::string whole_json(const SequenceScores& s, const EvaluateSequenceOptions& options) {
  return output::json_text(
             {{"cairn", CAIRN_VERSION},
              {"options", {{"min_area_px", options.min_area}, {"tentative", options.tentative}}},
              {"summary", json_of(s)},
              {"cut_off", s.is_cut_off},
              {"without_result", s.without_result},
              {"without_truth", s.without_truth}},
             1) +
         "\n";
}

/// The frames to detection are left out, since their names, those of the objects, differ between truths.
std::string csv_of(std::vector<std::pair<std::string, Json>> runs) {
  for (auto& [name, summary] : runs) {
    if (summary.contains("moving") && summary["moving"].is_object())
      summary["moving"].erase("frames_to_detect");
  }
  return csv(runs);
}

// ---- text ----

std::string track_table(const SequenceScores& s) {
  std::vector<std::string> header{"objects over time", "tracks"};
  if (s.by_landmark) header.emplace_back("by landmark");
  header.emplace_back("oracle ids");
  Table table(header);
  const auto row = [&](const char* name, auto&& figure) {
    std::vector<std::string> cells{name, figure(s.tracks)};
    if (s.by_landmark) cells.push_back(figure(*s.by_landmark));
    cells.push_back(figure(s.oracle));
    table.add(cells);
  };
  row("HOTA", [](const TrackErrors& e) { return points(e.hota); });
  row("DetA", [](const TrackErrors& e) { return points(e.det_a); });
  row("AssA", [](const TrackErrors& e) { return points(e.ass_a); });
  row("LocA", [](const TrackErrors& e) { return points(e.loc_a); });
  row("MOTA", [](const TrackErrors& e) { return points(e.mota); });
  row("MOTP", [](const TrackErrors& e) { return points(e.motp); });
  row("IDF1", [](const TrackErrors& e) { return points(e.id_f1); });
  row("IDP", [](const TrackErrors& e) { return points(e.id_precision); });
  row("IDR", [](const TrackErrors& e) { return points(e.id_recall); });
  row("switches", [](const TrackErrors& e) { return std::to_string(e.switches); });
  row("fragments", [](const TrackErrors& e) { return std::to_string(e.fragments); });
  row("mostly tracked", [](const TrackErrors& e) { return std::to_string(e.mostly_tracked); });
  row("partly tracked", [](const TrackErrors& e) { return std::to_string(e.partly_tracked); });
  row("mostly lost", [](const TrackErrors& e) { return std::to_string(e.mostly_lost); });
  return table.text();
}

std::string place_lines(const PlaceErrors& places) {
  if (places.in_camera_m.empty())
    return "positions           not compared: no place in the truth, or no match\n";
  std::string all;
  if (!places.in_map_m.empty()) {
    all += "positions           in the map: median " + metres(percentile(places.in_map_m, 0.5)) +
           "   95 % below " + metres(percentile(places.in_map_m, 0.95)) + "   of " +
           std::to_string(places.in_map_m.size()) + "\n";
  }
  all += std::string(all.empty() ? "positions           " : "                    ") +
         "from the camera: median " + metres(percentile(places.in_camera_m, 0.5)) + "   95 % below " +
         metres(percentile(places.in_camera_m, 0.95)) + "\n";
  if (places.stated > 0) {
    all += "                    within the stated 95 % ellipsoid: " +
           percent(share(places.inside, places.stated)) + "   NEES: median " +
           text_of("%.2f", percentile(places.normalised, 0.5)) + " (2.37 if correct)\n";
  }
  return all;
}

std::string moving_lines(const MovingErrors& e) {
  if (!e.is_known) return {};
  std::string all = "moving              ";
  for (const auto& [id, frames] : e.frames_to_detect) {
    all +=
        "object " + std::to_string(id) + ": " +
        (frames ? "after " + std::to_string(*frames) + " frames" : std::string("never labelled as moving")) +
        "   ";
  }
  if (e.moving > 0) all += percent(share(e.labelled, e.moving)) + " of the frames in which it moves   ";
  return all + "false: " + percent(share(e.labelled_wrong, e.at_rest)) + " of " + std::to_string(e.at_rest) +
         " at rest\n";
}

std::string trajectory_lines(const TrajectoryError& e) {
  std::string all = "trajectory          " + std::to_string(e.compared) + " poses, " +
                    text_of("%.2f m", e.path_m) + " of path, " + std::to_string(e.missing) + " missing\n";
  all += "  ATE               RMS " + text_of("%.4f m", e.ate_rmse_m) + "   at most " +
         text_of("%.4f m", e.ate_max_m) + "\n";
  all += "  RPE               per frame " + text_of("%.4f m", e.rpe_frame_m) + ", " +
         text_of("%.3f°", kDegrees * e.rpe_frame_rad) + "   per metre " + text_of("%.4f m", e.rpe_metre_m) +
         ", " + text_of("%.3f°", kDegrees * e.rpe_metre_rad) + "\n";
  all += "  sub-paths         " + std::to_string(e.sub_paths) + ", t_rel " +
         text_of("%.2f %%", 100 * e.t_rel) + ", r_rel " +
         text_of("%.3f° per 100 m", 100 * kDegrees * e.r_rel_rad_per_m) + "\n";
  all += "  end               " + text_of("%.4f m", e.end_error_m) + ", " +
         text_of("%.3f°", kDegrees * e.end_error_rad) + ", " +
         text_of("%.2f %% of the path", 100 * e.end_drift) + "\n";
  return all;
}

std::string lines_of(const SequenceScores& s) {
  const ObjectSummary& o = s.objects;
  std::string all = track_table(s) + "\n";
  all += "objects             " + std::to_string(o.true_objects) + " true objects in " +
         std::to_string(s.frames) + " frames, " + std::to_string(o.our_objects) + " reported\n";
  all += "found               IoU >= 0.5: " + percent(o.recall_50()) +
         "   IoU >= 0.75: " + percent(o.recall_75()) + "\n";
  all += "precision           " +
         (o.complete_frames > 0
              ? "IoU >= 0.5: " + percent(o.precision_50()) + "   IoU >= 0.75: " + percent(o.precision_75())
              : std::string("undefined: the truth is partial")) +
         "\n";
  all += "E                   mean " + percent(o.mean_error) + "   median " + percent(o.median_error) + "\n";
  all += "lost and found      " + std::to_string(s.steadiness.found_again) + " times, " +
         text_of("%.2f", 100 * share(s.steadiness.found_again, s.steadiness.object_frames)) +
         " in 100 frames of an object   IoU changes by " + text_of("%.3f", s.steadiness.iou_difference) +
         " a frame\n";
  all += place_lines(s.places) + moving_lines(s.moving);
  if (s.landmarks.is_known) {
    all += "landmarks           in view again: " + std::to_string(s.landmarks.again) +
           "   recognised: " + std::to_string(s.landmarks.re_identified) +
           "   mistaken for another: " + std::to_string(s.landmarks.wrong) + "\n";
  }
  if (s.changes.is_known) {
    all += "changes             found " + std::to_string(s.changes.found) + " of " +
           std::to_string(s.changes.expected) + "   wrong: " + std::to_string(s.changes.wrong) + " of " +
           std::to_string(s.changes.reported) + " reported";
    if (!s.changes.errors_m.empty())
      all += "   displacement error " + metres(percentile(s.changes.errors_m, 0.5));
    all += "\n";
  }
  if (s.trajectory) all += trajectory_lines(*s.trajectory);
  if (s.is_cut_off) all += "cut off             the last line of tracks.jsonl, which is left out\n";
  if (!s.without_result.empty()) {
    all += "no result           " + count_of(s.without_result.size(), "frame") + " of the truth, first " +
           s.without_result.front() + "\n";
  }
  if (!s.without_truth.empty()) {
    all += "no truth            " + count_of(s.without_truth.size(), "frame") + " of the result, first " +
           s.without_truth.front() + "\n";
  }
  return all;
}

std::string run_table(const std::vector<SequenceScores>& runs) {
  Table table({"run", "frames", "HOTA", "oracle", "AssA", "IDF1", "IDSW", "found %", "0.75 %", "precision %",
               "mean E %", "lost+found", "place m", "p95 m", "drift %"});
  for (const SequenceScores& s : runs) {
    table.add({s.name, std::to_string(s.frames), points(s.tracks.hota), points(s.oracle.hota),
               points(s.tracks.ass_a), points(s.tracks.id_f1), std::to_string(s.tracks.switches),
               points(s.objects.recall_50()), points(s.objects.recall_75()), points(s.objects.precision_50()),
               points(s.objects.mean_error), std::to_string(s.steadiness.found_again),
               text_of("%.3f", percentile(s.places.in_map_m, 0.5)),
               text_of("%.3f", percentile(s.places.in_map_m, 0.95)),
               s.trajectory ? text_of("%.2f", 100 * s.trajectory->end_drift) : ""});
  }
  return table.text();
}

}  // namespace

int evaluate_sequence(const EvaluateSequenceOptions& options) {
  require_one_run("--json", options.json, options.results);
  const input::TrueSequence truth = input::load_truth(options.truth);
  std::vector<SequenceScores> runs;
  for (const std::string& result : options.results)
    runs.push_back(input::score_sequence(result, truth, {options.min_area, options.tentative}));
  if (options.json) io::write_file(*options.json, whole_json(runs.front(), options));
  if (options.csv) {
    std::vector<std::pair<std::string, Json>> summaries;
    summaries.reserve(runs.size());
    for (const SequenceScores& run : runs) summaries.emplace_back(run.name, input::json_of(run));
    io::write_file(*options.csv, csv_of(summaries));
  }
  if (runs.size() == 1) {
    std::cout << lines_of(runs.front());
    return 0;
  }
  std::cout << run_table(runs);
  for (const SequenceScores& run : runs) {
    if (run.without_result != runs.front().without_result)
      std::cout << "not the same frames in " << runs.front().name << " and " << run.name << "\n";
  }
  return 0;
}

int evaluate_trajectory(const EvaluateSequenceOptions& options) {
  require_one_run("--json", options.json, options.results);
  const output::Trajectory truth = output::load_trajectory(options.truth);
  std::vector<std::pair<std::string, Json>> summaries;
  std::string text;
  for (const std::string& result : options.results) {
    output::Trajectory ours = output::load_trajectory(result);
    if (ours.has_stamps != truth.has_stamps) {
      // KITTI poses have no stamps, so they are matched by index; both sides need the same number.
      if (ours.poses.size() != truth.poses.size()) {
        throw Error((ours.has_stamps ? options.truth : result) + ": has no stamps, and " +
                    std::to_string((ours.has_stamps ? truth : ours).poses.size()) + " poses, expected " +
                    std::to_string((ours.has_stamps ? ours : truth).poses.size()));
      }
      for (std::size_t k = 0; k < ours.poses.size(); ++k) ours.poses[k].stamp = truth.poses[k].stamp;
    }
    const TrajectoryError error = trajectory_error(ours.poses, truth.poses);
    if (error.compared < 2) {
      const auto seconds = [](const output::Trajectory& file) {
        return text_of("%.2f", seconds_between({}, file.poses.front().stamp)) + " to " +
               text_of("%.2f s", seconds_between({}, file.poses.back().stamp));
      };
      throw Error(result + ": its stamps are " + seconds(ours) + ", those of " + options.truth + " " +
                  seconds(truth) + ", expected at least two within 0.01 s of each other");
    }
    if (options.results.size() > 1) text += result + "\n";
    text += trajectory_lines(error);
    summaries.emplace_back(result, Json{{"trajectory", input::json_of(error)}});
  }
  if (options.json)
    io::write_file(
        *options.json,
        output::json_text({{"cairn", CAIRN_VERSION}, {"summary", summaries.front().second}}, 1) + "\n");
  if (options.csv) io::write_file(*options.csv, csv_of(summaries));
  std::cout << text;
  return 0;
}

}  // namespace cairn::cli
