// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Everything that is measured against truth, in one run: writes DOCS/accuracy.md and DOCS/images/accuracy/.
//   accuracy DATA DOCS COMMIT [THREADS]
// DATA is the folder that holds real/ and rendered/; COMMIT is what the page says was measured. Nothing is
// written before everything is measured. Exit code 2 where the data are not there.
#include <algorithm>
#include <array>
#include <cairn/cairn.hpp>
#include <cairn/core/target.hpp>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <io/atomic_file.hpp>
#include <io/overlay.hpp>
#include <io/read_file.hpp>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include <timing/clock.hpp>
#include <timing/machine.hpp>
#include <timing/opencv_matchers.hpp>
#include "ablations.hpp"
#include "markdown_table.hpp"
#include "scored_frames.hpp"
#include "svg_plot.hpp"

namespace {

using namespace cairn;
using namespace cairn::report;
namespace fs = std::filesystem;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// What `make` makes of each.
template <class Range, class Make>
auto each_of(const Range& range, const Make& make) {
  std::vector<std::decay_t<decltype(make(*std::begin(range)))>> made;
  made.reserve(std::size(range));
  for (const auto& element : range) made.push_back(make(element));
  return made;
}

// ---- what there is to measure on ----

/// A series of degradations of one thing, mild to hard.
struct Stress {
  const char* name;                                      // of its picture
  const char* title;                                     // of its x axis
  bool is_strength;                                      // false: kinds
  std::vector<std::pair<const char*, double>> variants;  // folder, and where it stands on the axis
  std::vector<const char*> labels;
};

const std::vector<Stress>& stresses() {
  static const std::vector<Stress> all{
      {"reflectivity",
       "mirror share of the floor",
       true,
       {{"floor_0.0", 0}, {"floor_0.3", 0.3}, {"floor_0.6", 0.6}},
       {"0", "0.3", "0.6"}},
      {"gain_offset",
       "right image: gain, offset",
       false,
       {{"gain_0.80_offset_-8", 0},
        {"gain_1.00_offset_+0", 1},
        {"gain_1.00_offset_+20", 2},
        {"gain_1.10_offset_+5", 3},
        {"gain_1.25_offset_+12", 4}},
       {"0.8,−8", "1,0", "1,20", "1.1,5", "1.25,12"}},
      {"noise",
       "noise, σ in grey levels",
       true,
       {{"noise_0", 0}, {"noise_4", 4}, {"noise_8", 8}},
       {"0", "4", "8"}},
      {"vertical_shift",
       "right image lower by, px",
       true,
       {{"vshift_0", 0}, {"vshift_0.5", 0.5}, {"vshift_1", 1}, {"vshift_2", 2}},
       {"0", "0.5", "1", "2"}},
      {"texture",
       "texture",
       false,
       {{"repetitive", 0}, {"floor_0.3", 1}, {"lowtexture", 2}},
       {"repetitive", "as it is", "low"}},
      {"dim_light",
       "light (each step about a third)",
       true,
       {{"dim_1.00", 0}, {"dim_0.35", 1}, {"dim_0.12", 2}, {"dim_0.05", 2.83}},
       {"1", "0.35", "0.12", "0.05"}}};
  return all;
}

constexpr std::array kScenesUnderStress{"base0", "base1", "base2"};
constexpr std::array kSequences{"dev_seqA", "dev_seqB"};
constexpr std::array kMiddlebury{"middlebury2001", "middlebury2003", "middlebury2005", "middlebury2006",
                                 "middlebury2014"};

struct FrameSet {
  const char* title;
  const char* folder;
};
constexpr std::array kFrameSets{FrameSet{"Rendered, 320x240", "rendered/dev/320x240"},
                                FrameSet{"Rendered, 640x480", "rendered/dev/640x480"},
                                FrameSet{"rc_tabletop, real, 640x480", "real/rc_tabletop"}};

/// A set of frames of which objects are known, and whether choices were made on it.
struct Split {
  const char* title;
  std::vector<fs::path> folders;
  bool chosen_on;
};

std::vector<Split> splits() {
  const fs::path real = "real";
  std::vector<fs::path> middlebury;
  std::transform(kMiddlebury.begin(), kMiddlebury.end(), std::back_inserter(middlebury),
                 [&](const char* name) { return real / name; });
  return {{"dev 320x240", {"rendered/dev/320x240"}, true},
          {"dev 640x480", {"rendered/dev/640x480"}, true},
          {"train 320x240", {"rendered/train/320x240"}, true},
          {"rc_tabletop", {real / "rc_tabletop"}, true},
          {"Middlebury", middlebury, true},
          {"validate 320x240", {"rendered/validate/320x240"}, false},
          {"validate 640x480", {"rendered/validate/640x480"}, false},
          {"validate rc_tabletop", {real / "validate/rc_tabletop"}, false},
          {"validate Middlebury", {real / "validate/middlebury"}, false}};
}

/// The first folder that is missing, or none.
std::optional<fs::path> missing_in(const fs::path& data) {
  std::vector<fs::path> folders =
      each_of(kFrameSets, [](const FrameSet& set) { return fs::path(set.folder); });
  for (const Split& split : splits())
    folders.insert(folders.end(), split.folders.begin(), split.folders.end());
  for (const char* name : kSequences) folders.push_back(fs::path("rendered/dev/sequences") / name);
  for (const char* scene : kScenesUnderStress) {
    const fs::path folder = fs::path("rendered/stress") / scene;
    folders.push_back(folder / "gt");
    for (const Stress& stress : stresses()) {
      for (const auto& variant : stress.variants) folders.push_back(folder / variant.first);
    }
  }
  std::error_code ignored;
  for (const fs::path& folder : folders) {
    if (!fs::is_directory(data / folder, ignored)) return data / folder;
  }
  return std::nullopt;
}

// ---- what is written ----

struct Page {
  std::string text;
  std::map<std::string, std::string> plots;    // file name, contents
  std::map<std::string, Image<Rgb>> pictures;  // file name, pixels
};

struct Preset {
  const char* name;
  const char* colour;
  Config config;
};

std::vector<Preset> presets() {
  return {{"paper", "#888888", Config::paper()}, {"default", "#d1495b", Config{}}};
}

std::vector<FrameObjects> objects_of(const std::vector<Score>& scores) {
  return each_of(scores, [](const Score& score) { return score.objects; });
}

DisparityErrors disparity_of(const std::vector<Score>& scores) {
  DisparityErrors sum;
  for (const Score& score : scores) sum += score.disparity;
  return sum;
}

constexpr std::size_t kBad1 = 1;  // of kBadThresholdsPx
constexpr std::size_t kBad2 = 2;
static_assert(kBadThresholdsPx[kBad1] == 1.0F && kBadThresholdsPx[kBad2] == 2.0F);

// ---- presets and ablations on frames ----

struct Run {
  std::string name;
  Config config;
  bool grey = false;
  bool is_ablation = false;
};

std::vector<Run> all_runs() {
  std::vector<Run> runs;
  runs.push_back(
      {"**" + std::string(kAsPrinted.meaning) + "**", ablated(kAsPrinted.settings).config, false, false});
  for (const Preset& preset : presets())
    runs.push_back({std::string("**") + preset.name + "**", preset.config, false, false});
  for (const auto& [settings, meaning] : all_ablations()) {
    const AblatedConfig config = ablated(settings);
    runs.push_back({"`" + settings + "`", config.config, config.grey, true});
  }
  return runs;
}

std::vector<std::string> accuracy_cells(const std::vector<Score>& scores) {
  const ObjectSummary sum = summarise(objects_of(scores));
  const DisparityErrors disparity = disparity_of(scores);
  return {percent(sum.recall_50()),     percent(sum.recall_75()),
          percent(sum.precision_50()),  percent(sum.median_error),
          percent(sum.mean_boundary_f), text_of("%.2f", sum.phantoms_per_frame()),
          percent(disparity.density()), percent(disparity.bad_of_matched(kBad2))};
}

std::string time_cell(const std::vector<Score>& scores) {
  return text_of("%.0f", median(each_of(scores, [](const Score& score) { return score.milliseconds; })));
}

std::string frame_set_section(const FrameSet& set, const std::vector<TrueFrame>& frames, int threads) {
  MarkdownTable table({"", "found 0.5, %", "found 0.75, %", "precision, %", "median E, %", "boundary F, %",
                       "phantoms", "density, %", "bad-2, %", "ms"});
  const std::vector<Score> as_default = score_all(frames, Config{}, false, threads);
  const int objects = summarise(objects_of(as_default)).true_objects;
  std::string without_effect;
  for (const Run& run : all_runs()) {
    const std::vector<Score> scores = score_all(frames, run.config, run.grey, threads);
    std::vector<std::string> row = accuracy_cells(scores);
    if (run.is_ablation && row == accuracy_cells(as_default)) {
      without_effect += (without_effect.empty() ? "" : ", ") + run.name;
      continue;
    }
    row.insert(row.begin(), run.name);
    row.push_back(time_cell(scores));
    table.add(row);
  }
  std::string text = std::string("### ") + set.title + "\n\n" + std::to_string(frames.size()) + " frames, " +
                     std::to_string(objects) + " scored objects: one object is " + percent(1.0 / objects) +
                     " % of found.\n\n" + table.text() + "\n";
  if (!without_effect.empty()) text += "The same figures as `default`: " + without_effect + ".\n\n";
  return text;
}

std::string ablation_list() {
  MarkdownTable table({"`default` with", "meaning"}, 2);
  for (const auto& [settings, meaning] : all_ablations()) table.add({"`" + settings + "`", meaning});
  return table.text();
}

// ---- fit and validation side by side ----

/// A share of a count with Wilson's interval of 95 %, in per cent.
std::string share_text(int part, int whole) {
  if (whole == 0) return "–";
  constexpr double kDeviations = 1.96;
  const double n = whole;
  const double p = part / n;
  const double scale = 1 + kDeviations * kDeviations / n;
  const double middle = (p + kDeviations * kDeviations / (2 * n)) / scale;
  const double reach =
      kDeviations / scale * std::sqrt(p * (1 - p) / n + kDeviations * kDeviations / (4 * n * n));
  return percent(p) + " (" + percent(std::max(0.0, middle - reach)) + " … " +
         percent(std::min(1.0, middle + reach)) + ")";
}

void add_splits(Page& page, const fs::path& data, int threads) {
  struct Input {
    const char* name;
    Config config;
    bool grey;
  };
  const std::array inputs{Input{"default", Config{}, false}, Input{"default, grey", Config{}, true},
                          Input{"paper", Config::paper(), true}};
  MarkdownTable table({"frames", "choices made on it", "preset", "objects", "found 0.5, %", "found 0.75, %",
                       "precision, %", "median E, %", "phantoms"},
                      3);
  for (const Split& split : splits()) {
    std::vector<TrueFrame> frames;
    for (const fs::path& folder : split.folders) {
      for (TrueFrame& frame : load_true_frames(data / folder)) {
        if (!frame.objects.empty()) frames.push_back(std::move(frame));
      }
    }
    for (const Input& input : inputs) {
      const ObjectSummary sum = summarise(objects_of(score_all(frames, input.config, input.grey, threads)));
      table.add({std::string(split.title), split.chosen_on ? "yes" : "no", input.name,
                 std::to_string(sum.true_objects), share_text(sum.found_50, sum.true_objects),
                 share_text(sum.found_75, sum.true_objects), share_text(sum.right_50, sum.our_objects),
                 percent(sum.median_error), text_of("%.2f", sum.phantoms_per_frame())});
    }
  }
  page.text += "## Fit and validation\n\n";
  page.text +=
      "Options, features and trees were chosen on the sets marked *yes*, so results there are optimistic. "
      "[What was fitted](fitting.md) has the same sets scored by trees fitted without their scenes, and "
      "[what is lost](failures.md) the failures. The other sets are only reported. In brackets: Wilson's 95 "
      "% interval. Middlebury's objects are only partly labelled, so precision is undefined there.\n\n";
  page.text += table.text() + "\n";
}

// ---- the best, the median and the worst frame ----

/// The truth in the form that draw_objects() takes.
Objects as_objects(const TrueFrame& frame) {
  Objects objects{Image<ObjectId>(frame.objects.size(), ObjectId::none, {}), {}};
  std::map<TruthId, std::vector<double>> disparities;
  std::map<TruthId, Object> by_id;
  for (int y = 0; y < frame.objects.height(); ++y) {
    for (int x = 0; x < frame.objects.width(); ++x) {
      const TruthId id = frame.objects(x, y);
      if (id == TruthId::none || id == TruthId::dont_care) continue;
      Object& object = by_id[id];
      object.id = ObjectId{number(id)};
      object.box_px = united(object.box_px, {x, y, 1, 1});
      ++object.pixel_count;
      disparities[id].push_back(frame.truth_px(x, y));
      objects.labels(x, y) = object.id;
    }
  }
  for (auto& [id, object] : by_id) {
    object.disparity_px = static_cast<float>(median(disparities[id]));
    if (frame.rig) object.position_in_camera_m = frame.rig->point_in_camera_m(0, 0, object.disparity_px);
    objects.list.push_back(object);
  }
  return objects;
}

/// Both beside each other, in sixteen levels a channel: enough for a page, and a third of the bytes.
Image<Rgb> beside(View<const Rgb> left, View<const Rgb> right) {
  constexpr int kGap = 8;
  Image<Rgb> both({left.width() + kGap + right.width(), std::max(left.height(), right.height())},
                  Rgb{255, 255, 255}, {});
  const auto coarse = [](std::uint8_t v) { return static_cast<std::uint8_t>((v * 15 + 127) / 255 * 17); };
  const auto put = [&](View<const Rgb> image, int x0) {
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        const Rgb c = image(x, y);
        both(x0 + x, y) = {coarse(c.r), coarse(c.g), coarse(c.b)};
      }
    }
  };
  put(left, 0);
  put(right, left.width() + kGap);
  return both;
}

void add_pictures(Page& page, const std::vector<TrueFrame>& frames, int threads) {
  const std::vector<Score> scores = score_all(frames, Config{}, false, threads);
  std::vector<std::pair<double, std::size_t>> order;  // by mean E
  for (std::size_t i = 0; i < frames.size(); ++i)
    order.emplace_back(summarise({scores[i].objects}).mean_error, i);
  std::sort(order.begin(), order.end());
  page.text += "## The best, the median and the worst frame\n\n";
  page.text +=
      "By the mean E of a frame's objects, of `rendered/dev/320x240` with `default`. "
      "The truth is on the left, the result on the right, with distances in metres; colours have no "
      "meaning.\n\n";
  const std::array<std::pair<const char*, std::size_t>, 3> shown{
      std::pair{"best", std::size_t{0}}, {"median", (order.size() - 1) / 2}, {"worst", order.size() - 1}};
  for (const auto& [name, rank] : shown) {
    const TrueFrame& frame = frames[order[rank].second];
    const Frame found = segment_frame(frame, Config{}, false, {});
    const auto& left = frame.pictures.left;
    const Image<Rgb> truth = io::draw_objects(left.gray, left.rgb, as_objects(frame), {});
    const Image<Rgb> ours = io::draw_objects(left.gray, left.rgb, found.objects, found.floor);
    page.pictures.emplace(name, beside(truth, ours));
    page.text += std::string("The ") + name + ", " + frame.name + ": mean E " + percent(order[rank].first) +
                 " %.\n\n![truth and result of the " + name + " frame](images/accuracy/" + name + ".png)\n\n";
  }
}

// ---- stress ----

/// The pair of one variant with the truth of its scene.
TrueFrame load_variant(const fs::path& scene, const char* variant) {
  return load_true_frame(io::find_frames(scene / variant).front());
}

/// Of one preset: what each panel shows, by variant.
struct StressCurves {
  std::vector<double> found;
  std::vector<double> error;
  std::vector<double> density;
  std::vector<double> bad2;
};

StressCurves curves_of(const std::vector<std::vector<TrueFrame>>& variants, const Config& config,
                       int threads) {
  StressCurves curves;
  for (const std::vector<TrueFrame>& frames : variants) {
    const std::vector<Score> scores = score_all(frames, config, false, threads);
    const ObjectSummary sum = summarise(objects_of(scores));
    const DisparityErrors disparity = disparity_of(scores);
    curves.found.push_back(100 * sum.recall_50());
    curves.error.push_back(100 * sum.median_error);
    curves.density.push_back(100 * disparity.density());
    curves.bad2.push_back(100 * disparity.bad_of_matched(kBad2));
  }
  return curves;
}

double axis_end(const std::vector<Series>& series) {
  double most = 0;
  for (const Series& s : series) {
    for (const double y : s.y) most = std::isnan(y) ? most : std::max(most, y);
  }
  return round_up_for_axis(most);
}

Plot stress_plot(const Stress& stress, const std::vector<std::pair<Preset, StressCurves>>& curves) {
  Plot plot{.x_title = stress.title, .connected = stress.is_strength};
  for (std::size_t i = 0; i < stress.variants.size(); ++i) {
    plot.x.push_back(stress.variants[i].second);
    plot.ticks.push_back({stress.variants[i].second, stress.labels[i]});
  }
  const auto panel = [&](const char* title, std::vector<double> StressCurves::*what, double y_max) {
    Panel result{.title = title};
    for (const auto& [preset, all] : curves) result.series.push_back({preset.name, preset.colour, all.*what});
    result.y_max = y_max > 0 ? y_max : axis_end(result.series);
    plot.panels.push_back(result);
  };
  panel("objects found (IoU ≥ 0.5), %", &StressCurves::found, 100);
  panel("median E, % (200 = missed)", &StressCurves::error, 200);
  panel("density, %", &StressCurves::density, 100);
  panel("bad-2 of the matched, %", &StressCurves::bad2, 0);
  return plot;
}

/// Those large enough to be scored.
int true_objects_in(const std::vector<TrueFrame>& frames) {
  int count = 0;
  for (const TrueFrame& frame : frames) {
    const Image<ObjectId> nothing(frame.objects.size(), ObjectId::none, {});
    count += static_cast<int>(object_errors(nothing, frame.objects, {}).truth.size());
  }
  return count;
}

void add_stress(Page& page, const fs::path& data, int threads) {
  int objects = 0;
  std::string plots;
  for (const Stress& stress : stresses()) {
    std::vector<std::vector<TrueFrame>> variants(stress.variants.size());
    for (std::size_t v = 0; v < variants.size(); ++v) {
      for (const char* scene : kScenesUnderStress)
        variants[v].push_back(load_variant(data / "rendered/stress" / scene, stress.variants[v].first));
    }
    objects = true_objects_in(variants.front());
    std::vector<std::pair<Preset, StressCurves>> curves;
    for (const Preset& preset : presets())
      curves.emplace_back(preset, curves_of(variants, preset.config, threads));
    const std::string file = std::string("stress_") + stress.name + ".svg";
    page.plots[file] = svg_of(stress_plot(stress, curves));
    plots += std::string("![found, E, density and bad-2 against: ") + stress.title + "](images/accuracy/" +
             file + ")\n\n";
  }
  page.text +=
      "## Under stress\n\nThree rendered scenes, 320x240, in which one condition at a time gets worse "
      "(`rendered/stress`): " +
      std::to_string(objects) + " scored objects, so that one is " + percent(1.0 / objects) +
      " % of found. Disparity where both cameras see.\n\n" + plots;
}

// ---- Middlebury ----

struct DisparityScore {
  DisparityErrors all_columns;
  DisparityErrors from_range;  // columns x ≥ num_disparities only
  double milliseconds = 0;
};

struct Matcher {
  std::string name;
  std::function<Image<float>(const TrueFrame& frame, const Exec& exec)> match;
};

std::vector<Matcher> all_matchers() {
  std::vector<Matcher> all;
  for (const Preset& preset : presets()) {
    all.push_back({std::string("cairn, `") + preset.name + "`",
                   [config = preset.config](const TrueFrame& frame, const Exec& exec) {
                     Config own = config;
                     own.match.num_disparities = frame.num_disparities;
                     const io::Picture& left = frame.pictures.left;
                     return estimate_disparity(
                                StereoPair::from(left.gray, frame.pictures.right.gray, left.rgb), frame.rig,
                                own, exec)
                         .disparity.disparity_px.clone();
                   }});
  }
  for (const OpenCvMatcher& matcher : accurate_opencv_matchers()) {
    all.push_back({"OpenCV " + std::string(matcher.name), [&matcher](const TrueFrame& frame, const Exec&) {
                     const io::PicturePair& pictures = frame.pictures;
                     const ReadyMatcher ready = matcher.prepare({.num_disparities = frame.num_disparities});
                     ready.compute(StereoPair::from(pictures.left.gray, pictures.right.gray));
                     return ready.disparity_px();
                   }});
  }
  return all;
}

std::vector<DisparityScore> scores_of(const Matcher& matcher, const std::vector<TrueFrame>& frames,
                                      int threads) {
  std::vector<DisparityScore> scores(frames.size());
  for_each_index(frames.size(), threads, [&](std::size_t i, const Exec& exec) {
    const TrueFrame& frame = frames[i];
    const double start = now_ms(CLOCK_THREAD_CPUTIME_ID);
    const Image<float> found_px = matcher.match(frame, exec);
    scores[i].milliseconds = now_ms(CLOCK_THREAD_CPUTIME_ID) - start;
    scores[i].all_columns = disparity_errors(found_px, frame.truth_px, frame.hidden, 0);
    scores[i].from_range = disparity_errors(found_px, frame.truth_px, frame.hidden, frame.num_disparities);
  });
  return scores;
}

/// Mean over the pairs, each of which counts the same, of a figure of their errors.
template <class Figure>
double mean_over(const std::vector<DisparityScore>& scores, DisparityErrors DisparityScore::*columns,
                 const Figure& figure) {
  return mean(each_of(scores, [&](const DisparityScore& score) { return figure(score.*columns); }));
}

std::vector<std::string> matcher_row(const std::string& name, const std::vector<DisparityScore>& scores,
                                     DisparityErrors DisparityScore::*columns) {
  const auto of = [&](const auto& figure) { return percent(mean_over(scores, columns, figure)); };
  return {name,
          of([](const DisparityErrors& e) { return e.density(); }),
          of([](const DisparityErrors& e) { return e.bad_of_matched(kBad1); }),
          of([](const DisparityErrors& e) { return e.bad_of_matched(kBad2); }),
          of([](const DisparityErrors& e) { return e.bad_of_known(kBad1); }),
          of([](const DisparityErrors& e) { return e.bad_of_known(kBad2); }),
          text_of("%.0f", mean(each_of(scores, [](const DisparityScore& s) { return s.milliseconds; })))};
}

void add_middlebury(Page& page, const fs::path& data, int threads) {
  std::vector<TrueFrame> frames;
  for (const char* folder : kMiddlebury) {
    for (TrueFrame& frame : load_true_frames(data / "real" / folder)) frames.push_back(std::move(frame));
  }
  const std::vector<std::string> header{
      "", "density, %", "bad-1, %", "bad-2, %", "bad-1 with holes, %", "bad-2 with holes, %", "ms"};
  MarkdownTable from_range(header);
  MarkdownTable all_columns(header);
  std::vector<std::string> pair_header{"bad-2, % / density, %"};
  std::vector<std::vector<DisparityScore>> scores;
  for (const Matcher& matcher : all_matchers()) {
    scores.push_back(scores_of(matcher, frames, threads));
    from_range.add(matcher_row(matcher.name, scores.back(), &DisparityScore::from_range));
    // OpenCV's matchers leave the left columns empty.
    if (!matcher.name.starts_with("OpenCV"))
      all_columns.add(matcher_row(matcher.name, scores.back(), &DisparityScore::all_columns));
    pair_header.push_back(matcher.name);
  }
  MarkdownTable pairs(pair_header);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    std::vector<std::string> row{frames[i].name};
    for (const auto& of_matcher : scores) {
      const DisparityErrors& errors = of_matcher[i].from_range;
      row.push_back(percent(errors.bad_of_matched(kBad2)) + " / " + percent(errors.density()));
    }
    pairs.add(row);
  }
  page.text += "## Disparity on Middlebury\n\n";
  page.text += "Means over " + std::to_string(frames.size()) +
               " pairs of the Middlebury collections of 2001 to 2014, where both cameras see (of Motorcycle: "
               "all pixels with truth); OpenCV " +
               std::string(opencv_version()) + " in the same run, grey images for all. ";
  page.text +=
      "bad-t: share of the matched pixels that are off by more than t px; with holes: share of all pixels, "
      "with holes counted as bad.\n\n";
  page.text +=
      "Only columns x ≥ the number of disparities, since OpenCV's matchers leave the others empty:\n\n" +
      from_range.text() + "\nAll columns:\n\n" + all_columns.text() + "\n";
  page.text += "OpenCV's settings: ";
  for (const OpenCvMatcher& matcher : accurate_opencv_matchers()) {
    page.text += std::string(matcher.name) + ": " + std::string(matcher.settings) +
                 (&matcher == &accurate_opencv_matchers().back() ? ".\n\n" : "; ");
  }
  page.text += "<details><summary>Pair by pair, columns x ≥ the number of disparities</summary>\n\n" +
               pairs.text() + "\n</details>\n\n";
}

// ---- sequences ----

/// A figure over the frames of a sequence: its mean, and what all but the worst twentieth of them reach.
std::string mean_and_tail(const std::vector<double>& values, const char* format, bool more_is_better) {
  const double tail = percentile(values, more_is_better ? 0.05 : 0.95);
  return text_of(format, mean(values)) + " (" + text_of(format, tail) + ")";
}

struct FrameFigures {
  std::vector<double> found_50, found_75, precision, error, phantoms, density, bad2;
};

FrameFigures figures_of(const std::vector<Score>& scores) {
  FrameFigures figures;
  for (const Score& score : scores) {
    const ObjectSummary sum = summarise({score.objects});
    figures.found_50.push_back(100 * sum.recall_50());
    figures.found_75.push_back(100 * sum.recall_75());
    // A frame in which nothing is found has no precision: no share of nothing.
    figures.precision.push_back(100 * sum.precision_50());
    figures.error.push_back(100 * sum.median_error);
    figures.phantoms.push_back(sum.phantoms_per_frame());
    figures.density.push_back(100 * score.disparity.density());
    figures.bad2.push_back(100 * score.disparity.bad_of_matched(kBad2));
  }
  return figures;
}

std::vector<std::string> sequence_row(const std::string& name, const FrameFigures& f) {
  return {name,
          mean_and_tail(f.found_50, "%.0f", true),
          mean_and_tail(f.found_75, "%.0f", true),
          mean_and_tail(f.precision, "%.0f", true),
          mean_and_tail(f.error, "%.1f", false),
          mean_and_tail(f.phantoms, "%.2f", false),
          mean_and_tail(f.density, "%.0f", true),
          mean_and_tail(f.bad2, "%.1f", false)};
}

/// One true object over a sequence.
struct Track {
  std::vector<double> iou;  // by frame; NaN where it is too small to be scored, or not in sight
  int merged = 0;           // frames in which it was not found, but lay in one of ours with another object
};

std::map<TruthId, Track> tracks_of(const std::vector<Score>& scores) {
  std::map<TruthId, Track> tracks;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    for (const TrueObjectScore& score : scores[i].objects.errors.truth) {
      Track& track = tracks[score.id];
      track.iou.resize(scores.size(), kUnknown);
      track.iou[i] = score.iou;
      track.merged += score.iou < 0.5 && score.under_segmented ? 1 : 0;
    }
  }
  return tracks;
}

/// The names that the renderer gave the objects.
std::map<TruthId, std::string> names_in(const fs::path& scene_json) {
  constexpr std::size_t kMost = std::size_t{16} << 20;
  std::map<TruthId, std::string> names;
  const auto scene = nlohmann::json::parse(io::read_file(scene_json, kMost));
  for (const auto& object : scene.at("objects"))
    names[TruthId{object.at("id").get<int>()}] = object.at("name").get<std::string>();
  return names;
}

std::vector<std::string> track_row(const std::string& name, const Track& track) {
  int seen = 0;
  int found = 0;
  int lost = 0;
  std::vector<double> changes;
  double largest_fall = 0;
  std::size_t at = 0;
  double before = kUnknown;
  for (std::size_t i = 0; i < track.iou.size(); ++i) {
    const double iou = track.iou[i];
    if (!std::isnan(iou)) {
      ++seen;
      found += iou >= 0.5 ? 1 : 0;
      lost += before >= 0.5 && iou < 0.5 ? 1 : 0;
      if (!std::isnan(before)) changes.push_back(std::abs(iou - before));
      if (before - iou > largest_fall) {
        largest_fall = before - iou;
        at = i;
      }
    }
    before = iou;
  }
  const std::string fall =
      largest_fall > 0 ? text_of("%.2f", largest_fall) + " at " + std::to_string(at) : "–";
  return {name,
          std::to_string(seen),
          std::to_string(found),
          std::to_string(seen - found),
          std::to_string(track.merged),
          std::to_string(lost),
          text_of("%.2f", percentile(track.iou, 0.5)),
          text_of("%.3f", mean(changes)),
          fall};
}

Plot sequence_plot(const std::vector<std::pair<Preset, FrameFigures>>& all) {
  Plot plot{.x_title = "frame", .marked = false};
  const std::size_t count = all.front().second.error.size();
  for (std::size_t i = 0; i < count; ++i) plot.x.push_back(static_cast<double>(i));
  constexpr std::size_t kEvery = 10;
  for (std::size_t i = 0; i < count; i += kEvery)
    plot.ticks.push_back({static_cast<double>(i), std::to_string(i)});
  const auto panel = [&](const char* title, std::vector<double> FrameFigures::*what, double y_max) {
    Panel result{.title = title};
    for (const auto& [preset, figures] : all)
      result.series.push_back({preset.name, preset.colour, figures.*what});
    result.y_max = y_max > 0 ? y_max : axis_end(result.series);
    plot.panels.push_back(result);
  };
  panel("objects found (IoU ≥ 0.5), %", &FrameFigures::found_50, 100);
  panel("precision, %", &FrameFigures::precision, 100);
  panel("median E, % (200 = missed)", &FrameFigures::error, 200);
  panel("phantoms", &FrameFigures::phantoms, 0);
  return plot;
}

void add_sequences(Page& page, const fs::path& data, int threads) {
  MarkdownTable table({"", "found 0.5, %", "found 0.75, %", "precision, %", "median E, %", "phantoms",
                       "density, %", "bad-2, %"});
  MarkdownTable objects({"`default`, object", "frames", "found", "not found", "of these merged", "lost",
                         "median IoU", "mean change of IoU", "greatest fall of IoU"});
  std::string pictures;
  for (const char* name : kSequences) {
    const fs::path folder = data / "rendered/dev/sequences" / name;
    const std::vector<TrueFrame> frames = load_true_frames(folder);
    std::vector<std::pair<Preset, FrameFigures>> figures;
    std::vector<Score> scores;
    for (const Preset& preset : presets()) {
      scores = score_all(frames, preset.config, false, threads);
      figures.emplace_back(preset, figures_of(scores));
      table.add(sequence_row(std::string(name) + ", `" + preset.name + "`", figures.back().second));
    }
    const auto names = names_in(folder / frames.front().name / "scene.json");
    for (const auto& [id, track] : tracks_of(scores)) {  // of the last preset, which is default
      const auto known = names.find(id);
      const std::string what = known == names.end() ? std::to_string(number(id)) : known->second;
      objects.add(track_row(std::string(name) + ", " + what, track));
    }
    const std::string file = std::string(name) + ".svg";
    page.plots[file] = svg_of(sequence_plot(figures));
    pictures += std::string("![found, precision, E and phantoms of each frame of ") + name +
                "](images/accuracy/" + file + ")\n\n";
  }
  page.text += "## Frame by frame\n\n";
  page.text +=
      "Two rendered sequences of 40 frames at 320x240 (`rendered/dev/sequences`): in A, the robot drives and "
      "turns among static objects; in B, a ball rolls past. Each frame is segmented independently, so this "
      "also shows how stable the result is. The table has means over the frames, and in brackets the 5th "
      "percentile, or the 95th of E, phantoms and bad-2, where less is better.\n\n";
  page.text += table.text() + "\n" + pictures;
  page.text +=
      "Found: frames with IoU ≥ 0.5. Merged: frames in which more than half of the object lay in one of ours "
      "that also contains more than half of another. Lost: the number of times the object was found in one "
      "frame and not in the next. The greatest fall is between consecutive frames, with the number of the "
      "later one.\n\n" +
      objects.text() + "\n";
}

// ---- the page ----

std::string head(const std::string& commit) {
  return "# Accuracy\n\n<!-- Written by ./dev accuracy; do not edit. -->\n\n"
         "Measured on " +
         today() + " at commit " + commit + ", on " + processor() +
         " (kernels: " + std::string(name(supported_targets().back())) +
         ").\nThis page reports how well cairn finds objects and disparities, against ground truth and "
         "compared with OpenCV's matchers. `./dev accuracy` measures everything again and writes this page "
         "and its plots; it needs the data collection in `../shared/data`, or in `CAIRN_DATA`.\n\n";
}

constexpr std::string_view kNotHeldOut =
    "**Most of it is not held out.** After the first table, results are measured on frames that the options "
    "and the trees of `default` were fitted to, so they are optimistic. The rendered frames are our own.\n\n";

constexpr std::string_view kColumns =
    "## Presets and ablations\n\n"
    "| column | content |\n|---|---|\n"
    "| found 0.5, found 0.75 | share of the true objects of at least 200 px with IoU ≥ 0.5 and ≥ 0.75 |\n"
    "| precision | share of our objects with IoU ≥ 0.5 with a true object |\n"
    "| median E | of the paper's E (Eq. 5, 1/IoU − 1) over all true objects; each counts for 200 % at most "
    "|\n"
    "| boundary F | mean over all true objects |\n"
    "| phantoms | per frame: objects of ours of at least 200 px with little overlap with true ones |\n"
    "| density, bad-2 | of the disparity, where both cameras see: share of the pixels with a disparity, and "
    "of these the share that is off by more than 2 px; rc_tabletop has no true disparity |\n"
    "| ms | one core's time for the whole method, median frame |\n\n"
    "[Evaluation](evaluation.md) defines the words. **paper** and **default** are the presets, **as "
    "printed** is `paper` without the floor label and the gradient thresholds. Each other row is an "
    "ablation: `default` with one feature disabled or as in `paper`. A difference of one object is noise; "
    "each section gives the share of one object.\n\n";

Page measure_all(const fs::path& data, const std::string& commit, int threads) {
  Page page;
  const auto tell = [](const char* what) { std::fprintf(stderr, "accuracy: %s\n", what); };
  page.text = head(commit) + std::string(kNotHeldOut);
  tell("fit and validation");
  add_splits(page, data, threads);
  page.text += std::string(kColumns) + ablation_list() + "\n";
  for (const FrameSet& set : kFrameSets) {
    tell(set.folder);
    const std::vector<TrueFrame> frames = load_true_frames(data / set.folder);
    page.text += frame_set_section(set, frames, threads);
    // The real frames may not be shown.
    if (&set == &kFrameSets.back())
      add_pictures(page, load_true_frames(data / kFrameSets.front().folder), threads);
  }
  tell("stress");
  add_stress(page, data, threads);
  tell("middlebury");
  add_middlebury(page, data, threads);
  tell("sequences");
  add_sequences(page, data, threads);
  return page;
}

void write(const Page& page, const fs::path& docs) {
  const fs::path pictures = docs / "images" / "accuracy";
  io::make_folder(pictures);
  for (const auto& [name, contents] : page.plots) io::write_file(pictures / name, contents);
  for (const auto& [name, image] : page.pictures) io::save_png(pictures / (name + ".png"), image);
  io::write_file(docs / "accuracy.md", page.text);
}

int threads_of(std::string_view text) {
  int threads = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), threads);
  constexpr int kMost = 256;
  if (error != std::errc{} || end != text.data() + text.size() || threads < 1 || threads > kMost)
    throw Error("THREADS: found '" + std::string(text) + "', expected 1 … 256");
  return threads;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 4 && argc != 5) {
      std::fprintf(stderr, "usage: accuracy DATA DOCS COMMIT [THREADS]\n");
      return 2;
    }
    const fs::path data = argv[1];
    if (const auto missing = missing_in(data)) {
      std::fprintf(stderr, "accuracy: %s: no such folder; CAIRN_DATA says where the data collection is\n",
                   missing->c_str());
      return 2;
    }
    const auto start = std::chrono::steady_clock::now();
    const int threads = argc == 5 ? threads_of(argv[4]) : std::max(1U, std::thread::hardware_concurrency());
    set_opencv_threads(1);
    write(measure_all(data, argv[3], threads), argv[2]);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    std::printf("wrote %s/accuracy.md and its pictures in %.0f s on %d threads\n", argv[2], took.count(),
                threads);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "accuracy: %s\n", error.what());
    return 1;
  }
}
