// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/output/tuning_json.hpp>

#include <algorithm>
#include <array>
#include <cairn/output/json.hpp>
#include <cmath>

namespace cairn::output {
namespace {

std::vector<TuningFigure> object_figures(const Measures& measures) {
  std::vector<FrameObjects> objects;
  for (const FrameMeasure& m : measures) {
    if (m.objects) objects.push_back(*m.objects);
  }
  const ObjectSummary s = summarise(objects);
  return {{"median_error", "E, median", s.median_error},
          {"recall_50", "found, IoU >= 0.5", s.recall_50()},
          {"precision_50", "precision", s.precision_50()},
          {"phantoms_per_frame", "phantoms per frame", s.phantoms_per_frame(), false}};
}

std::vector<TuningFigure> disparity_figures(const Measures& measures) {
  DisparityErrors all;
  for (const FrameMeasure& m : measures) {
    if (m.disparity) all += *m.disparity;
  }
  if (all.known == 0) return {};
  return {{"bad_1_of_known", "bad-1 with holes", all.bad_of_known(1)},
          {"bad_1_of_matched", "bad-1 of the matched", all.bad_of_matched(1)},
          {"density", "density", all.density()}};
}

std::vector<TuningFigure> consistency_figures(const Measures& measures) {
  Consistency all;
  Steadiness steady;
  for (const FrameMeasure& m : measures) {
    if (m.consistency) all += *m.consistency;
    if (m.since_last) steady += *m.since_last;
  }
  return {{"density", "density", all.density()},
          {"agreement", "right image agrees", all.agreement()},
          {"photometric", "photometric difference", all.photometric()},
          {"unsteady", "unsteady where still", steady.unsteady_share()}};
}

Json figures_json(const std::vector<TuningFigure>& before, const std::vector<TuningFigure>& after,
                  int frames) {
  if (before.empty()) return nullptr;
  Json j{{"frames", frames}};
  for (std::size_t i = 0; i < before.size(); ++i)
    j[before[i].key] = {{"before", finite(before[i].value)}, {"after", finite(after[i].value)}};
  return j;
}

}  // namespace

std::string goal_word(TuningGoal goal) {
  switch (goal) {
    case TuningGoal::objects:
      return "mean E";
    case TuningGoal::disparities:
      return "bad disparities";
    case TuningGoal::consistency:
      return "contradictions";
  }
  return {};
}

std::vector<TuningFigure> tuning_figures(const Measures& measures, TuningGoal goal) {
  if (measures.empty()) return {};
  std::vector<TuningFigure> all{{"loss", goal_word(goal), mean_loss(losses_of(measures))}};
  const auto add = [&](const std::vector<TuningFigure>& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  if (goal == TuningGoal::objects) add(object_figures(measures));
  add(goal == TuningGoal::consistency ? consistency_figures(measures) : disparity_figures(measures));
  return all;
}

Json json_of(const Tuning& tuned, const std::vector<std::string>& names, std::uint32_t seed) {
  constexpr std::array kGoals{"objects", "disparities", "consistency"};
  constexpr std::array kEnds{"converged", "evaluations", "time", "interrupted"};
  Json j;
  j["cairn"] = CAIRN_VERSION;
  j["goal"] = kGoals[static_cast<std::size_t>(tuned.goal)];
  j["frames"] = names.size();
  j["sequence"] = tuned.sequence;
  j["seed"] = seed;
  j["options"] = tuned.tunables.size();
  j["evaluations"] = tuned.search.evaluations;
  j["seconds"] = tuned.seconds;
  j["end"] = kEnds[static_cast<std::size_t>(tuned.end)];
  j["tuned_on"] =
      figures_json(tuning_figures(tuned.before, tuned.goal), tuning_figures(tuned.after, tuned.goal),
                   static_cast<int>(tuned.before.size()));
  j["held_out"] = figures_json(
      tuning_figures(tuned.held_out_before, tuned.goal), tuning_figures(tuned.held_out_after, tuned.goal),
      static_cast<int>(std::count(tuned.held_out.begin(), tuned.held_out.end(), true)));
  const auto gain = [](const Measures& before, const Measures& after) {
    if (before.empty()) return Json(nullptr);
    const Gain g = gain_of(losses_of(before), losses_of(after));
    return Json{{"mean", finite(g.mean)}, {"low", finite(g.low)}, {"high", finite(g.high)}};
  };
  j["gain"] = {{"tuned_on", gain(tuned.before, tuned.after)},
               {"held_out", gain(tuned.held_out_before, tuned.held_out_after)}};
  j["held_out_frames"] = Json::array();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (tuned.held_out[i]) j["held_out_frames"].push_back(names[i]);
  }
  j["kept_because"] = tuned.kept_because.empty() ? Json(nullptr) : Json(tuned.kept_because);
  j["found"] = Json::object();
  for (std::size_t i = 0; i < tuned.search.best.size(); ++i) {
    const Setting& before = tuned.search.start[i];
    const Setting& after = tuned.search.best[i];
    if (before.value != after.value)
      j["found"][before.option] = {{"before", before.value}, {"after", after.value}};
  }
  return j;
}

std::string tuning_json(const Tuning& tuned, const std::vector<std::string>& names, std::uint32_t seed) {
  return json_text(json_of(tuned, names, seed));
}

}  // namespace cairn::output
