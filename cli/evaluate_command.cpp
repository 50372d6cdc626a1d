// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/frame_names.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/io/read_file.hpp>
#include <cairn/output/json.hpp>
#include <cairn/output/results.hpp>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>
#include <numeric>
#include <set>

#include "commands.hpp"
#include "evaluate_files.hpp"
#include "evaluate_sequence.hpp"
#include "evaluation_text.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;
using output::finite, output::Json;

struct EvaluateOptions {
  std::vector<std::string> folders;  // as given: results, then truth
  std::vector<std::string> results;
  std::string truth;
  ObjectErrorConfig objects;
  int skip_left = 0;
  bool sequence = false;
  bool tentative = false;
  std::optional<std::string> json;
  std::optional<std::string> html;
  std::optional<std::string> csv;

  [[nodiscard]] bool wants_times() const { return json || html || csv || results.size() > 1; }
};

// ---- one frame ----

constexpr double kConfident = 0.8;

/// Over the pixels with a known truth.
struct ConfidentPixels {
  std::int64_t matched = 0;
  std::int64_t confident = 0;  // with a confidence of at least kConfident
  std::int64_t right = 0;      // of those, with an error of at most 1 px

  ConfidentPixels& operator+=(const ConfidentPixels& other) {
    matched += other.matched;
    confident += other.confident;
    right += other.right;
    return *this;
  }
};

struct FrameScore {
  std::string name;
  ResultFiles result;
  io::TruthFiles truth;
  std::optional<FrameObjects> objects;
  std::map<ObjectId, double> confidence;   // empty without objects.json
  std::optional<DisparityErrors> visible;  // non-occluded pixels; all if occlusion is unknown
  std::optional<DisparityErrors> all;
  bool knows_occlusion = false;
  std::optional<ConfidentPixels> confident;  // nullopt without confidence.png
  std::vector<output::StageTime> times;      // empty without objects.json, or if it has no times
  output::EncodedFrame page;                 // empty without --html
};

/// The time of each stage according to objects.json.
std::vector<output::StageTime> load_times(const fs::path& objects_json) {
  constexpr std::size_t kMax = std::size_t{256} << 20;
  const std::string text = io::read_file(objects_json, kMax);
  try {
    const Json whole = Json::parse(text);
    const Json by_stage = whole.value("timings_ms", Json::object());
    std::vector<output::StageTime> times;
    for (const auto& [stage, milliseconds] : by_stage.items())
      times.push_back({stage, milliseconds.get<double>()});
    return times;
  } catch (const nlohmann::json::exception&) {
    throw Error(objects_json.string() + ": no objects.json of cairn, expected milliseconds in `timings_ms`");
  }
}

ConfidentPixels judge_pixels(View<const float> disparity_px, View<const float> truth_px,
                             View<const std::uint16_t> confidence, int skip_left) {
  ConfidentPixels sum;
  for (int y = 0; y < truth_px.height(); ++y) {
    for (int x = skip_left; x < truth_px.width(); ++x) {
      const float off = std::abs(disparity_px(x, y) - truth_px(x, y));
      if (std::isnan(off)) continue;
      const bool confident = confidence(x, y) >= kConfident * 255;
      ++sum.matched;
      sum.confident += confident ? 1 : 0;
      sum.right += confident && off <= 1 ? 1 : 0;
    }
  }
  return sum;
}

void score_disparity(const ResultFiles& result, const io::TruthFiles& truth, int skip_left,
                     FrameScore& score) {
  const fs::path& ours = *result.disparity;
  const Image<float> disparity = io::load_disparity(ours);
  const Image<float> true_disparity = io::load_disparity(*truth.disparity);
  require_equal_size(ours, disparity.size(), *truth.disparity, true_disparity.size());
  score.all = disparity_errors(disparity, true_disparity, {}, skip_left);
  score.visible = score.all;
  if (result.confidence) {
    const io::Labels confidence = io::load_labels(*result.confidence);
    require_equal_size(*result.confidence, confidence.ids.size(), *truth.disparity, true_disparity.size());
    score.confident = judge_pixels(disparity, true_disparity, confidence.ids, skip_left);
  }
  if (!truth.occlusion) return;
  const Image<std::uint8_t> hidden = io::load_hidden(*truth.occlusion);
  require_equal_size(*truth.occlusion, hidden.size(), *truth.disparity, true_disparity.size());
  score.visible = disparity_errors(disparity, true_disparity, hidden, skip_left);
  score.knows_occlusion = true;
}

FrameScore score_frame(const ResultFiles& result, const io::TruthFiles& truth,
                       const EvaluateOptions& options) {
  FrameScore score;
  score.name = result.name;
  score.result = result;
  score.truth = truth;
  if (result.objects && truth.objects) {
    const Image<ObjectId> ours = ours_of(io::load_labels(*result.objects));
    const Image<TruthId> theirs = io::truth_ids(io::load_labels(*truth.objects));
    require_equal_size(*result.objects, ours.size(), *truth.objects, theirs.size());
    score.objects = FrameObjects{object_errors(ours, theirs, options.objects), truth.partial};
    if (result.json) {
      for (const auto& object : output::load_confidences(*result.json))
        score.confidence[object.id] = object.confidence;
    }
  }
  if (result.disparity && truth.disparity) score_disparity(result, truth, options.skip_left, score);
  if (!score.objects && !score.all) {
    throw Error(truth.folder.string() + ": has no truth for what the result " + result.name + " contains");
  }
  if (options.wants_times() && result.json) score.times = load_times(*result.json);
  if (options.html) score.page = encode_frame(result, truth);
  return score;
}

// ---- all frames ----

struct Scores {
  std::vector<FrameScore> frames;
  std::vector<std::string> without_result;  // frames in the truth only
  std::vector<std::string> without_truth;   // frames in the results only: KITTI has every other
  SkippedFiles left_out;                    // frames with unusable files
  std::size_t results = 0;
  std::string remark;  // for stderr; usually empty
};

bool has_truth(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return false;
  try {
    (void)io::find_truth(folder);
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// The remark that the truth is a result, as when the folders are swapped; empty if it is none.
std::string remark_on_truth(const io::TruthFiles& truth) {
  std::error_code ignored;
  if (!fs::exists(truth.folder / "objects.json", ignored)) return {};
  return "cairn: " + truth.folder.string() +
         ": has an objects.json, so it is a result of cairn, expected the truth as the last folder\n";
}

Scores score_all(const std::string& run, const EvaluateOptions& options) {
  std::error_code ignored;
  for (const std::string& folder : {run, options.truth}) {
    if (!fs::exists(folder, ignored)) throw Error(folder + ": no such folder");
    if (!fs::is_directory(folder, ignored)) throw Error(folder + ": is a file, expected a folder");
  }
  Scores scores;
  const fs::path whole = fs::absolute(run).lexically_normal();
  if (auto single = result_in(whole.has_filename() ? whole : whole.parent_path())) {
    const io::TruthFiles truth = io::find_truth(options.truth);
    scores.frames.push_back(score_frame(*single, truth, options));
    scores.remark = remark_on_truth(truth);
    scores.results = 1;
    return scores;
  }
  std::set<std::string> seen;
  std::vector<ResultFiles> results;
  for (const auto& entry : fs::directory_iterator(run)) {
    if (!entry.is_directory(ignored)) continue;
    if (auto result = result_in(entry.path())) results.push_back(std::move(*result));
  }
  if (results.empty()) {
    throw Error(run +
                ": no result in this folder or its sub-folders, expected objects.png, disparity.png or "
                "disparity.pfm");
  }
  std::sort(results.begin(), results.end(),
            [](const auto& a, const auto& b) { return io::in_natural_order(a.name, b.name); });
  std::erase_if(results, [&](const ResultFiles& result) {
    seen.insert(result.name);
    if (io::names_truth(options.truth, result.name)) return false;
    scores.without_truth.push_back(result.name);
    return true;
  });
  if (results.empty()) {
    const std::string& name = scores.without_truth.front();
    throw Error((fs::path(options.truth) / name).string() + ": no such folder, but found a result " + name);
  }
  scores.results = results.size();
  for (const ResultFiles& result : results) {
    try {
      const io::TruthFiles truth = io::find_truth(options.truth, result.name);
      scores.frames.push_back(score_frame(result, truth, options));
      if (scores.remark.empty()) scores.remark = remark_on_truth(truth);
    } catch (const Error& error) {
      if (results.size() == 1) throw;
      scores.left_out.add(result.name, error.what());
    }
  }
  if (scores.frames.empty()) throw Error(run + ": none of its results can be scored");
  for (const auto& entry : fs::directory_iterator(options.truth)) {
    const std::string name = entry.path().filename().string();
    if (!seen.contains(name) && name != "gt" && has_truth(entry.path()))
      scores.without_result.push_back(name);
  }
  std::sort(scores.without_result.begin(), scores.without_result.end(), io::in_natural_order);
  return scores;
}

// ---- the table ----

std::string error_text(const TrueObjectScore& score) {
  constexpr double kLargestShown = 10;
  if (score.iou == 0) return "miss";
  return score.error() < kLargestShown ? text_of("%.1f", 100 * score.error()) : ">999";
}

std::string frame_table(const std::vector<FrameScore>& frames) {
  std::set<TruthId> ids;
  for (const FrameScore& frame : frames) {
    if (!frame.objects) continue;
    for (const TrueObjectScore& score : frame.objects->errors.truth) ids.insert(score.id);
  }
  std::vector<std::string> header{"frame"};
  for (const TruthId id : ids) header.push_back("E" + std::to_string(number(id)) + " %");
  header.insert(header.end(), {"found", "ours", "right", "phantoms", "bad-1 %", "density %"});
  Table table(header);
  for (const FrameScore& frame : frames) {
    std::vector<std::string> row{frame.name};
    row.resize(1 + ids.size());
    if (frame.objects) {
      for (const TrueObjectScore& score : frame.objects->errors.truth) {
        row[1 + static_cast<std::size_t>(std::distance(ids.begin(), ids.find(score.id)))] = error_text(score);
      }
      const ObjectSummary sum = summarise({*frame.objects});
      row.push_back(std::to_string(sum.found_50) + "/" + std::to_string(sum.true_objects));
      row.push_back(std::to_string(frame.objects->errors.ours.size()));
      row.push_back(frame.objects->partial ? "" : std::to_string(sum.right_50));
      row.push_back(frame.objects->partial ? "" : std::to_string(sum.phantoms));
    } else {
      row.insert(row.end(), 4, "");
    }
    row.push_back(frame.visible ? text_of("%.1f", 100 * frame.visible->bad_of_matched(1)) : "");
    row.push_back(frame.visible ? text_of("%.1f", 100 * frame.visible->density()) : "");
    table.add(row);
  }
  return table.text();
}

// ---- the summary ----

struct Confidence {
  int objects = 0;
  int right = 0;
  bool known = false;
};

Confidence judge_confidence(const std::vector<FrameScore>& frames) {
  Confidence sum;
  for (const FrameScore& frame : frames) {
    if (!frame.objects || frame.objects->partial || frame.confidence.empty()) continue;
    sum.known = true;
    for (const FoundObjectScore& score : frame.objects->errors.ours) {
      const auto found = frame.confidence.find(score.id);
      if (score.mostly_dont_care || found == frame.confidence.end() || found->second < kConfident) continue;
      ++sum.objects;
      sum.right += score.iou >= 0.5 ? 1 : 0;
    }
  }
  return sum;
}

std::string frames_text(int count) {
  return std::to_string(count) + (count == 1 ? " frame" : " frames");
}

std::vector<FrameObjects> objects_of(const std::vector<FrameScore>& frames) {
  std::vector<FrameObjects> objects;
  for (const FrameScore& frame : frames) {
    if (frame.objects) objects.push_back(*frame.objects);
  }
  return objects;
}

struct DisparityTotals {
  DisparityErrors visible;
  DisparityErrors all;
  int frames = 0;
  int with_occlusion = 0;
  ConfidentPixels confident;  // over the frames with a confidence.png
};

DisparityTotals disparity_totals(const std::vector<FrameScore>& frames) {
  DisparityTotals sum;
  for (const FrameScore& frame : frames) {
    if (!frame.all) continue;
    ++sum.frames;
    sum.with_occlusion += frame.knows_occlusion ? 1 : 0;
    sum.visible += *frame.visible;
    sum.all += *frame.all;
    if (frame.confident) sum.confident += *frame.confident;
  }
  return sum;
}

std::string object_lines(const std::vector<FrameScore>& frames, const EvaluateOptions& options) {
  const std::vector<FrameObjects> objects = objects_of(frames);
  std::set<int> tolerances;
  for (const FrameObjects& frame : objects) tolerances.insert(frame.errors.boundary_tolerance_px);
  if (objects.empty()) return "objects             not compared: no truth, or none in the result\n";
  const ObjectSummary s = summarise(objects);
  std::string tolerance = std::to_string(*tolerances.begin());
  if (tolerances.size() > 1) tolerance += " to " + std::to_string(*tolerances.rbegin());

  std::string all = "objects             " + std::to_string(s.true_objects) + " true ones of at least " +
                    std::to_string(options.objects.min_area) + " px in " + frames_text(s.frames) + "\n";
  all += "found               IoU >= 0.5: " + percent(s.recall_50()) +
         "   IoU >= 0.75: " + percent(s.recall_75()) + "\n";
  if (s.complete_frames > 0) {
    const std::string partial =
        s.complete_frames < s.frames
            ? "; " + frames_text(s.frames - s.complete_frames) + " with partial truth left out"
            : "";
    all += "precision           IoU >= 0.5: " + percent(s.precision_50()) +
           "   IoU >= 0.75: " + percent(s.precision_75()) + "   of " + std::to_string(s.our_objects) +
           " reported objects" + partial + "\n";
    all += "phantoms            " + text_of("%.2f", s.phantoms_per_frame()) + " per frame\n";
  } else {
    all += "precision           undefined: the truth is partial\n";
  }
  all += "E                   mean " + percent(s.mean_error) + "   median " + percent(s.median_error) +
         "   (capped at 200 %; " + std::to_string(s.missed) + " reach that)\n";
  all += "IoU                 mean " + text_of("%.3f", s.mean_iou) + "\n";
  all += "boundary F          mean " + text_of("%.3f", s.mean_boundary_f) + "   of those found " +
         text_of("%.3f", s.mean_boundary_f_found) + "   (within " + tolerance + " px)\n";
  all += "segmented           over: " + std::to_string(s.over_segmented) +
         "   under: " + std::to_string(s.under_segmented) + "\n";
  if (const Confidence c = judge_confidence(frames); c.known) {
    all += "confidence >= 0.8   " + std::to_string(c.objects) + " reported objects";
    if (c.objects > 0)
      all += ", " + percent(c.right / static_cast<double>(c.objects)) + " of them with IoU >= 0.5";
    all += "\n";
  }
  return all;
}

std::string disparity_block(const char* title, const DisparityErrors& e, const std::string& remark) {
  std::string all = title + remark + "\n";
  const auto bad = [&](const char* head, auto share) {
    all += head;
    for (std::size_t t = 0; t < kBadThresholdsPx.size(); ++t) {
      all += (t == 0 ? "" : "   ") + text_of("bad-%g ", double(kBadThresholdsPx[t])) + percent(share(t));
    }
    all += "\n";
  };
  all += "  density           " + percent(e.density()) + " of " + std::to_string(e.known) + " pixels\n";
  bad("  of the matched    ", [&](std::size_t t) { return e.bad_of_matched(t); });
  bad("  with holes        ", [&](std::size_t t) { return e.bad_of_known(t); });
  all += "  error             mean " + text_of("%.3f px", e.mean_absolute_px()) + "   RMS " +
         text_of("%.3f px", e.root_mean_square_px()) + "   within 1 px RMS " +
         text_of("%.3f px", e.sigma_px()) + "\n";
  return all;
}

std::string disparity_lines(const std::vector<FrameScore>& frames, int skip_left) {
  const auto [visible, everything, count, with_occlusion, confident] = disparity_totals(frames);
  if (count == 0) return "disparity           not compared: no truth, or none in the result\n";
  const std::string skipped = skip_left > 0 ? ", columns from " + std::to_string(skip_left) + " on" : "";
  const std::string title = "disparity           " + frames_text(count) + ", ";
  std::string all;
  if (with_occlusion > 0) {
    const std::string others =
        with_occlusion < count
            ? " (no occlusion.png for " + std::to_string(count - with_occlusion) + ": all of theirs)"
            : "";
    all += disparity_block(title.c_str(), visible, "pixels that both cameras see" + others + skipped);
    all += disparity_block(title.c_str(), everything, "all pixels with truth" + skipped);
  } else {
    all += disparity_block(title.c_str(), everything, "all pixels with truth (no occlusion.png)" + skipped);
  }
  if (confident.matched > 0) {
    all += "confidence >= 0.8   " +
           percent(static_cast<double>(confident.confident) / static_cast<double>(confident.matched)) +
           " of the matched pixels with truth, " +
           percent(static_cast<double>(confident.right) / static_cast<double>(confident.confident)) +
           " of them within 1 px\n";
  }
  return all;
}

// ---- JSON ----

Json json_if(bool known, int value) {
  return known ? Json(value) : Json(nullptr);
}

Json json_of(const TrueObjectScore& score) {
  return {{"id", number(score.id)},
          {"area_px", score.pixel_count},
          {"ours", json_if(score.found != ObjectId::none, number(score.found))},
          {"iou", finite(score.iou)},
          {"error", finite(score.error())},
          {"boundary_f", finite(score.boundary_f)},
          {"over_segmented", score.over_segmented},
          {"under_segmented", score.under_segmented}};
}

Json json_of(const FoundObjectScore& score, const std::map<ObjectId, double>& confidence) {
  const auto known = confidence.find(score.id);
  return {{"id", number(score.id)},
          {"area_px", score.pixel_count},
          {"true", json_if(score.best != TruthId::none, number(score.best))},
          {"iou", finite(score.iou)},
          {"share_on_objects", finite(score.share_on_objects)},
          {"mostly_dont_care", score.mostly_dont_care},
          {"phantom", score.phantom},
          {"confidence", known == confidence.end() ? Json(nullptr) : finite(known->second)}};
}

Json frame_objects_json(const FrameScore& frame) {
  if (!frame.objects) return nullptr;
  const auto& [errors, partial] = *frame.objects;
  const ObjectSummary sum = summarise({*frame.objects});
  Json j;
  j["partial"] = partial;
  j["boundary_tolerance_px"] = errors.boundary_tolerance_px;
  j["counts"] = {{"scored", sum.true_objects},
                 {"found_50", sum.found_50},
                 {"found_75", sum.found_75},
                 {"ours", errors.ours.size()},
                 {"right_50", json_if(!partial, sum.right_50)},
                 {"right_75", json_if(!partial, sum.right_75)},
                 {"phantoms", json_if(!partial, sum.phantoms)}};
  j["true"] = Json::array();
  for (const TrueObjectScore& score : errors.truth) j["true"].push_back(json_of(score));
  j["ours"] = Json::array();
  for (const FoundObjectScore& score : errors.ours) j["ours"].push_back(json_of(score, frame.confidence));
  return j;
}

Json json_of(const DisparityErrors& errors) {
  Json j{{"known_px", errors.known}, {"matched_px", errors.matched}, {"density", finite(errors.density())}};
  for (std::size_t t = 0; t < kBadThresholdsPx.size(); ++t) {
    const std::string threshold = text_of("%g", double(kBadThresholdsPx[t]));
    j["bad_of_matched"][threshold] = finite(errors.bad_of_matched(t));
    j["bad_of_known"][threshold] = finite(errors.bad_of_known(t));
  }
  j["mean_absolute_px"] = finite(errors.mean_absolute_px());
  j["root_mean_square_px"] = finite(errors.root_mean_square_px());
  j["sigma_px"] = finite(errors.sigma_px());
  return j;
}

Json json_of(const ConfidentPixels& pixels) {
  const double right = static_cast<double>(pixels.right) / static_cast<double>(pixels.confident);
  return {{"at_least", kConfident},
          {"matched_px", pixels.matched},
          {"confident_px", pixels.confident},
          {"right_1_px", pixels.right},
          {"share_right_1", finite(right)}};
}

Json frame_disparity_json(const FrameScore& frame) {
  if (!frame.all) return nullptr;
  return {{"both_cameras", frame.knows_occlusion ? json_of(*frame.visible) : Json(nullptr)},
          {"all", json_of(*frame.all)}};
}

Json frame_json(const FrameScore& frame) {
  Json times = nullptr;
  for (const output::StageTime& time : frame.times) times[time.stage] = finite(time.milliseconds);
  return {{"name", frame.name},
          {"objects", frame_objects_json(frame)},
          {"disparity", frame_disparity_json(frame)},
          {"timings_ms", times}};
}

Json summary_objects_json(const std::vector<FrameScore>& frames) {
  const std::vector<FrameObjects> objects = objects_of(frames);
  if (objects.empty()) return nullptr;
  const ObjectSummary s = summarise(objects);
  const bool complete = s.complete_frames > 0;
  Json j{{"frames", s.frames},
         {"complete_frames", s.complete_frames},
         {"scored", s.true_objects},
         {"found_50", s.found_50},
         {"found_75", s.found_75},
         {"recall_50", finite(s.recall_50())},
         {"recall_75", finite(s.recall_75())},
         {"ours", json_if(complete, s.our_objects)},
         {"right_50", json_if(complete, s.right_50)},
         {"right_75", json_if(complete, s.right_75)},
         {"precision_50", finite(s.precision_50())},
         {"precision_75", finite(s.precision_75())},
         {"phantoms", json_if(complete, s.phantoms)},
         {"phantoms_per_frame", finite(s.phantoms_per_frame())},
         {"mean_error", finite(s.mean_error)},
         {"median_error", finite(s.median_error)},
         {"error_cap", kErrorCap},
         {"at_error_cap", s.missed},
         {"mean_iou", finite(s.mean_iou)},
         {"mean_boundary_f", finite(s.mean_boundary_f)},
         {"mean_boundary_f_found", finite(s.mean_boundary_f_found)},
         {"over_segmented", s.over_segmented},
         {"under_segmented", s.under_segmented},
         {"confident", nullptr}};
  if (const Confidence c = judge_confidence(frames); c.known) {
    const double right = c.objects > 0 ? c.right / static_cast<double>(c.objects) : std::nan("");
    j["confident"] = {{"at_least", kConfident},
                      {"ours", c.objects},
                      {"right_50", c.right},
                      {"precision_50", finite(right)}};
  }
  return j;
}

Json summary_disparity_json(const std::vector<FrameScore>& frames) {
  const DisparityTotals sum = disparity_totals(frames);
  if (sum.frames == 0) return nullptr;
  return {{"frames", sum.frames},
          {"frames_with_occlusion", sum.with_occlusion},
          {"both_cameras", sum.with_occlusion > 0 ? json_of(sum.visible) : Json(nullptr)},
          {"all", json_of(sum.all)},
          {"confident", sum.confident.matched > 0 ? json_of(sum.confident) : Json(nullptr)}};
}

Json mean_and_median(const std::vector<double>& values) {
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  return {{"mean", finite(mean)}, {"median", finite(median(values))}};
}

Json summary_times_json(const std::vector<FrameScore>& frames) {
  std::vector<double> totals;
  std::vector<std::string> stages;  // in order of execution, which a map would not keep
  std::map<std::string, std::vector<double>> by_stage;
  for (const FrameScore& frame : frames) {
    if (frame.times.empty()) continue;
    double total = 0;
    for (const auto& [stage, milliseconds] : frame.times) {
      total += milliseconds;
      if (!by_stage.contains(stage)) stages.push_back(stage);
      by_stage[stage].push_back(milliseconds);
    }
    totals.push_back(total);
  }
  if (totals.empty()) return nullptr;
  Json j{{"frames", totals.size()}, {"total", mean_and_median(totals)}};
  for (const std::string& stage : stages) j["stages"][stage] = mean_and_median(by_stage[stage]);
  return j;
}

/// The content of the --json file (docs/evaluation.md).
Json evaluation_json(const Scores& scores, const EvaluateOptions& options) {
  Json j;
  j["cairn"] = CAIRN_VERSION;
  j["options"] = {{"min_area_px", options.objects.min_area},
                  {"boundary_tolerance_percent", output::shortest(options.objects.boundary_tolerance)},
                  {"skip_left_px", options.skip_left}};
  j["summary"] = {{"objects", summary_objects_json(scores.frames)},
                  {"disparity", summary_disparity_json(scores.frames)},
                  {"timings_ms", summary_times_json(scores.frames)}};
  j["without_result"] = scores.without_result;
  j["without_truth"] = scores.without_truth;
  j["left_out"] = scores.left_out.frames();
  j["frames"] = Json::array();
  for (const FrameScore& frame : scores.frames) j["frames"].push_back(frame_json(frame));
  return j;
}

constexpr const char* kPageName = "evaluation.html";

void write_page(Scores& scores, const EvaluateOptions& options, std::string as_json) {
  std::vector<output::EncodedFrame> frames;
  frames.reserve(scores.frames.size());
  for (FrameScore& frame : scores.frames) frames.push_back(std::move(frame.page));
  const output::PageHead head{"evaluate",
                              name_of(options.results.front()) + " against " + name_of(options.truth),
                              std::move(as_json)};
  const std::string page = output::html_page(head, frames);
  io::make_folder(*options.html);
  io::write_file(fs::path(*options.html) / kPageName, page);
}

/// Empty if there are none.
std::string names_line(std::string head, const char* whose, const std::vector<std::string>& names) {
  constexpr std::size_t kColumn = 20;
  if (names.empty()) return {};
  head.resize(kColumn, ' ');
  std::string line = head + frames_text(static_cast<int>(names.size())) + whose;
  for (const std::string& name : names) line += " " + name;
  return line + "\n";
}

// ---- comparison of runs ----

struct Run {
  std::string name;
  Scores scores;
};

/// The numbers of the runs: those of `summary` in --json, without the single stages.
std::string csv_of(const std::vector<Run>& runs) {
  std::vector<std::pair<std::string, Json>> summaries;
  for (const Run& run : runs) {
    Json summary{{"objects", summary_objects_json(run.scores.frames)},
                 {"disparity", summary_disparity_json(run.scores.frames)},
                 {"timings_ms", summary_times_json(run.scores.frames)}};
    if (summary["timings_ms"].is_object()) summary["timings_ms"].erase("stages");
    summaries.emplace_back(run.name, std::move(summary));
  }
  return csv(summaries);
}

std::string run_table(const std::vector<Run>& runs) {
  Table table({"run", "frames", "found %", "0.75 %", "precision %", "median E %", "boundary F", "phantoms",
               "bad-1 %", "density %", "ms"});
  const auto share = [](double value) { return text_of("%.1f", 100 * value); };
  for (const Run& run : runs) {
    const std::vector<FrameScore>& frames = run.scores.frames;
    std::vector<std::string> row{run.name, std::to_string(frames.size())};
    const std::vector<FrameObjects> objects = objects_of(frames);
    const ObjectSummary s = summarise(objects);
    if (objects.empty()) {
      row.insert(row.end(), 6, "");
    } else {
      row.insert(row.end(),
                 {share(s.recall_50()), share(s.recall_75()), share(s.precision_50()), share(s.median_error),
                  text_of("%.3f", s.mean_boundary_f), text_of("%.2f", s.phantoms_per_frame())});
    }
    const DisparityTotals disparity = disparity_totals(frames);
    row.push_back(disparity.frames > 0 ? share(disparity.visible.bad_of_matched(1)) : "");
    row.push_back(disparity.frames > 0 ? share(disparity.visible.density()) : "");
    const Json times = summary_times_json(frames);
    row.push_back(times.is_null() ? "" : text_of("%.1f", times["total"]["median"].get<double>()));
    table.add(row);
  }
  return table.text();
}

/// A note if the runs are not of the same frames, so that their rows cannot be compared.
std::string frames_that_differ(const std::vector<Run>& runs) {
  const auto names_of = [](const Run& run) {
    std::set<std::string> names;
    for (const FrameScore& frame : run.scores.frames) names.insert(frame.name);
    return names;
  };
  for (const Run& run : runs) {
    if (run.scores.frames.size() == 1 && runs.front().scores.frames.size() == 1) continue;
    if (names_of(run) != names_of(runs.front()))
      return "not the same frames in " + runs.front().name + " and " + run.name + "\n";
  }
  return {};
}

int compare(const EvaluateOptions& options) {
  require_one_run("--json", options.json, options.results);
  require_one_run("--html", options.html, options.results);
  std::vector<Run> runs;
  int code = 0;
  for (const std::string& folder : options.results) {
    runs.push_back({folder, score_all(folder, options)});
    const Scores& scores = runs.back().scores;
    code = std::max(code, scores.left_out.exit_code(scores.results));
    if (runs.size() == 1) std::cerr << scores.remark;  // the truth is that of all runs
  }
  if (options.csv) io::write_file(*options.csv, csv_of(runs));
  std::cout << run_table(runs) << frames_that_differ(runs);
  return code;
}

/// The evaluation of a sequence or of two trajectories; nullopt if the input is neither.
std::optional<int> evaluate_over_time(const EvaluateOptions& options) {
  const auto is_trajectory = [](const std::string& path) {
    const fs::path file(path);
    std::error_code ignored;
    return fs::is_regular_file(file, ignored) &&
           (file.extension() == ".tum" || file.extension() == ".txt" || file.extension() == ".csv");
  };
  const bool trajectories =
      !options.sequence && std::all_of(options.results.begin(), options.results.end(), is_trajectory);
  if (options.tentative && !options.sequence) throw Error("--tentative: needs --sequence");
  if (!options.sequence && !trajectories) return std::nullopt;
  if (options.html) throw Error("--html " + *options.html + ": needs single frames, found a sequence");
  const EvaluateSequenceOptions over_time{options.results,   options.truth, options.objects.min_area,
                                          options.tentative, options.json,  options.csv};
  return trajectories ? evaluate_trajectory(over_time) : evaluate_sequence(over_time);
}

int evaluate(EvaluateOptions& options) {
  options.results = options.folders;
  options.truth = options.results.back();
  options.results.pop_back();
  if (options.results.empty())
    throw Error("TRUTH: found none after " + options.truth + ", expected RESULT and then TRUTH");
  if (const std::optional<int> code = evaluate_over_time(options)) return *code;
  if (options.results.size() > 1) return compare(options);
  std::vector<Run> runs;
  runs.push_back({options.results.front(), score_all(options.results.front(), options)});
  Scores& scores = runs.front().scores;
  std::cerr << scores.remark;
  if (options.csv) io::write_file(*options.csv, csv_of(runs));
  if (options.json || options.html) {
    const Json as_json = evaluation_json(scores, options);
    if (options.json) io::write_file(*options.json, output::json_text(as_json, 1) + "\n");
    if (options.html) write_page(scores, options, output::json_text(as_json));
  }
  std::cout << frame_table(scores.frames) << "\n"
            << object_lines(scores.frames, options) << disparity_lines(scores.frames, options.skip_left);
  std::cout << names_line("no result", " of the truth:", scores.without_result)
            << names_line("no truth", " of the results:", scores.without_truth);
  return scores.left_out.exit_code(scores.results);
}

}  // namespace

Work declare_evaluate(CLI::App& app) {
  auto options = std::make_shared<EvaluateOptions>();
  app.add_option("RESULT", options->folders,
                 "one or more RESULT to compare, then TRUTH. RESULT: output of cairn segment -o, one "
                 "frame or a folder of frames; TRUTH: folder with objects.png and/or disp_left.png (or "
                 "../gt next to it), a folder of such folders, or KITTI's. Or trajectories: pose files in "
                 "the form of TUM, KITTI or EuRoC; TRUTH may be a folder of frames with pose.txt")
      ->required()
      ->type_name("");
  app.add_option("--min-area", options->objects.min_area, "smallest true object that is scored, px")
      ->check(CLI::Range(1, 1 << 30).name(""))
      ->type_name("PX")
      ->capture_default_str();
  app.add_option("--boundary-tolerance", options->objects.boundary_tolerance,
                 "largest boundary distance of a match, % of the image diagonal, at least 1 px")
      ->check(CLI::Range(0.0F, 10.0F).name(""))
      ->type_name("PERCENT")
      ->capture_default_str();
  app.add_option("--skip-left", options->skip_left, "number of columns skipped at the left of disparities")
      ->check(CLI::Range(0, 1 << 20).name(""))
      ->type_name("N")
      ->capture_default_str();
  app.add_flag("--sequence", options->sequence,
               "RESULT from cairn follow or MOTS text; TRUTH: its folder of frames or MOTS text");
  app.add_flag("--tentative", options->tentative, "unconfirmed tracks included; needs --sequence");
  app.add_option("--json", options->json, "JSON file for the whole evaluation")->type_name("FILE");
  app.add_option("--html", options->html, "folder for evaluation.html, a page for the browser")
      ->type_name("DIR");
  app.add_option("--csv", options->csv, "CSV file with one row per run")->type_name("FILE");
  app.footer(
      "Columns of the table: E of each true object by its id (Eq. 5, 1/IoU - 1, in %), true "
      "objects found with\n"
      "IoU >= 0.5, found objects, those of them with IoU >= 0.5, phantoms, and disparity of "
      "pixels seen by both cameras.\n"
      "docs/evaluation.md defines the terms.");
  return [options] { return evaluate(*options); };
}

}  // namespace cairn::cli
