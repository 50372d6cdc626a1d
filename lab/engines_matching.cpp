// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Our matching compared with OpenCV's, and with itself.
#include <algorithm>
#include <array>
#include <atomic>
#include <cairn/cairn.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <random>
#include <utility>

#include "engines.hpp"
#include "markdown_table.hpp"
#include "scored_frames.hpp"

namespace {

/// Heap use of the process, for the section on memory. StereoBM's 2.4 MB were measured in the same way: what
/// is added to the images.
std::atomic<std::int64_t> held_bytes{0};
std::atomic<std::int64_t> most_held_bytes{0};

void* counted(std::size_t bytes, std::size_t alignment) {
  // The size is stored before the block, for operator delete.
  const std::size_t header = std::max<std::size_t>(alignment, 16);
  void* block = std::aligned_alloc(header, (bytes + 2 * header - 1) / header * header);
  if (block == nullptr) throw std::bad_alloc();
  *static_cast<std::size_t*>(block) = bytes;
  const std::int64_t now = held_bytes += static_cast<std::int64_t>(bytes);
  for (std::int64_t most = most_held_bytes;
       most < now && !most_held_bytes.compare_exchange_weak(most, now);) {
  }
  return static_cast<std::byte*>(block) + header;
}
void discount(void* data, std::size_t alignment) noexcept {
  if (data == nullptr) return;
  void* block = static_cast<std::byte*>(data) - std::max<std::size_t>(alignment, 16);
  held_bytes -= static_cast<std::int64_t>(*static_cast<std::size_t*>(block));
  std::free(block);
}

}  // namespace

void* operator new(std::size_t bytes) {
  return counted(bytes, 16);
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return counted(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* data) noexcept {
  discount(data, 16);
}
void operator delete(void* data, std::size_t) noexcept {
  discount(data, 16);
}
void operator delete(void* data, std::align_val_t alignment) noexcept {
  discount(data, static_cast<std::size_t>(alignment));
}
void operator delete(void* data, std::size_t, std::align_val_t alignment) noexcept {
  discount(data, static_cast<std::size_t>(alignment));
}

namespace cairn::lab {
namespace {

/// The matching stages of a configuration, as run by segment(): with left-right check and uniqueness if they
/// are on.
DisparityMap match_and_check(const StereoPair& pair, const Config& config, const Exec& exec) {
  const Matches matches = match(pair, config.match, config.semi_global, exec);
  auto refined = refine_subpixel(matches, config.subpixel, exec);
  const auto inconsistent = reject_inconsistent(matches, config.left_right, exec);
  const auto ambiguous = reject_ambiguous(matches, config.uniqueness, exec);
  return combine(std::move(refined), {inconsistent, ambiguous}, exec);
}

Exec one_thread(Target target = Target::best) {
  Exec exec;
  exec.target = target;
  exec.pool = Pool::make();
  return exec;
}

MatchConfig search(const Scene& scene, MatchConfig config) {
  config.num_disparities = scene.num_disparities;
  return config;
}

Run winner(const Scene& scene, MatchConfig config, const Exec& exec = one_thread()) {
  config.maps = MatchMaps::winner;
  return [=, &scene] { static_cast<void>(match_windows(scene.pair(), search(scene, config), exec)); };
}

/// As StereoBM's default.
constexpr MatchConfig kSobelSad{.cost = Cost::sad, .prefilter = Prefilter::xsobel, .prefilter_cap = 31};

Config complete_config(const MatchConfig& match, LeftRightMethod method) {
  Config config = Config::paper();
  config.match = match;
  config.left_right = {.max_diff = 1, .method = method};
  // StereoBM requires 15 % more than the lowest cost; this option is the lowest cost as a share of the
  // runner-up.
  config.uniqueness.ratio = 13;
  config.flatness.threshold = -1;
  config.match.maps = method == LeftRightMethod::vote ? MatchMaps::minimum : MatchMaps::full;
  return config;
}

Run complete(const Scene& scene, LeftRightMethod method, const Exec& exec = one_thread()) {
  const Config config = complete_config(search(scene, kSobelSad), method);
  return [=, &scene] { static_cast<void>(match_and_check(scene.pair(), config, exec)); };
}

/// Two threads share a pool, as for a video.
Exec two_threads() {
  Exec exec = Exec::with_threads(2);
  exec.pool = Pool::make();
  return exec;
}

/// Same size as the scene, different content.
Run complete_on(const Scene& scene, Gray (*pixel)(std::mt19937&)) {
  auto other = std::make_shared<Scene>(Scene{
      scene.name, scene.num_disparities, Image<Gray>(scene.left.size()), Image<Gray>(scene.left.size()), {}});
  std::mt19937 random(1);
  for (Image<Gray>* image : {&other->left, &other->right}) {
    for (int y = 0; y < image->height(); ++y) {
      std::generate_n(image->row(y), image->width(), [&] { return pixel(random); });
    }
  }
  return [other, run = complete(*other, LeftRightMethod::right_winner)] { run(); };
}

void add_engines(Registry& all) {
  const auto add = [&](std::string_view name, std::function<Run(const Scene&)> prepare) {
    all.engines.push_back({name, std::move(prepare)});
  };
  add("SAD", [](const Scene& s) { return winner(s, kSobelSad); });
  add("SAD, AVX2", [](const Scene& s) { return winner(s, kSobelSad, one_thread(Target::avx2)); });
  add("SAD, two threads", [](const Scene& s) { return winner(s, kSobelSad, two_threads()); });
  add("SAD complete, vote", [](const Scene& s) { return complete(s, LeftRightMethod::vote); });
  add("SAD complete, true", [](const Scene& s) { return complete(s, LeftRightMethod::right_winner); });
  add("SAD complete, vote, two threads",
      [](const Scene& s) { return complete(s, LeftRightMethod::vote, two_threads()); });
  add("SAD complete, true, two threads",
      [](const Scene& s) { return complete(s, LeftRightMethod::right_winner, two_threads()); });
  add("SAD complete, black",
      [](const Scene& s) { return complete_on(s, [](std::mt19937&) { return Gray{0}; }); });
  add("SAD complete, noise", [](const Scene& s) {
    return complete_on(s, [](std::mt19937& random) { return static_cast<Gray>(random()); });
  });
  add("SAD, rows ±1", [](const Scene& s) {
    MatchConfig config = kSobelSad;
    config.row_band = 1;
    return winner(s, config);
  });
  add("SAD, rows ±2", [](const Scene& s) {
    MatchConfig config = kSobelSad;
    config.row_band = 2;
    return winner(s, config);
  });
  add("SAD unfiltered", [](const Scene& s) { return winner(s, {.cost = Cost::sad}); });
  add("SAD unfiltered 21x21",
      [](const Scene& s) { return winner(s, {.cost = Cost::sad, .window_size = 21}); });
  add("ZNCC", [](const Scene& s) { return winner(s, {.cost = Cost::zncc}); });
  add("ZNCC, two threads", [](const Scene& s) { return winner(s, {.cost = Cost::zncc}, two_threads()); });
  add("SSD", [](const Scene& s) { return winner(s, {.cost = Cost::ssd}); });
  add("ZSAD", [](const Scene& s) { return winner(s, {.cost = Cost::zsad}); });
  add("ZSSD", [](const Scene& s) { return winner(s, {.cost = Cost::zssd}); });
  add("NSSD", [](const Scene& s) { return winner(s, {.cost = Cost::nssd}); });
  add("semi-global", [](const Scene& s) {
    return [config = search(s, Config().match), exec = one_thread(), &s] {
      static_cast<void>(match(s.pair(), config, SemiGlobalConfig(), exec));
    };
  });
}

void add_comparisons(Registry& all) {
  constexpr std::string_view kSmall = "320x240x64";
  constexpr std::string_view kMiddle = "640x480x64";
  constexpr std::string_view kLarge = "1280x720x128";
  const auto add = [&](const Comparison& row) { all.comparisons.push_back(row); };
  add({"SAD 9x9 on xsobel, winner only", "SAD", "StereoBM raw", kMiddle, {5}});
  add({"SAD 9x9 on xsobel, complete, left-right by vote",
       "SAD complete, vote",
       "StereoBM full",
       kMiddle,
       {4.5}});
  add({"SAD 9x9 on xsobel, complete, true left-right", "SAD complete, true", "StereoBM full", kMiddle, {3}});
  add({"SAD 9x9 on xsobel, winner only", "SAD", "StereoBM raw", kLarge, {}});
  add({"SAD 9x9 on xsobel, complete, left-right by vote",
       "SAD complete, vote",
       "StereoBM full",
       kLarge,
       {4.5}});
  add({"SAD 9x9 on xsobel, complete, true left-right", "SAD complete, true", "StereoBM full", kLarge, {}});
  add({"SAD 9x9 without prefilter", "SAD unfiltered", "StereoBM raw", kMiddle, {2}});
  add({"SAD 21x21 without prefilter: 32-bit sums", "SAD unfiltered 21x21", "StereoBM raw", kMiddle, {2}});
  add({"exact ZNCC 9x9, winner only", "ZNCC", "StereoBM raw", kMiddle, {2}});
  add({"SSD against ZNCC", "SSD", "ZNCC", kMiddle, {1}});
  add({"ZSAD against ZNCC", "ZSAD", "ZNCC", kMiddle, {1}});
  add({"ZSSD against ZNCC", "ZSSD", "ZNCC", kMiddle, {1}});
  add({"NSSD against ZNCC", "NSSD", "ZNCC", kMiddle, {1}});
  add({"AVX2 against AVX-512, SAD", "SAD, AVX2", "SAD", kMiddle, {0.9}});
  add({"black against natural, complete",
       "SAD complete, black",
       "SAD complete, true",
       kMiddle,
       {0.95, 1.05}});
  add({"noise against natural, complete",
       "SAD complete, noise",
       "SAD complete, true",
       kMiddle,
       {0.95, 1.05}});
  add({"price of row_band 1 (ratio)", "SAD", "SAD, rows ±1", kMiddle, {0, 3}});
  add({"price of row_band 2 (ratio)", "SAD", "SAD, rows ±2", kMiddle, {0, 5}});
  add({"semi-global", "semi-global", "StereoSGBM 3WAY", kMiddle, {}});
  add({"semi-global", "semi-global", "StereoSGBM", kMiddle, {}});
  for (const auto& [extent, goal] :
       {std::pair{kSmall, 1.6}, std::pair{kMiddle, 1.8}, std::pair{kLarge, 1.85}}) {
    const auto add_threads = [&, at = extent, least = goal](std::string_view what, std::string_view two,
                                                            std::string_view one) {
      add({what, two, one, at, {least}, Clock::wall});
    };
    add_threads("two threads: SAD complete, vote", "SAD complete, vote, two threads", "SAD complete, vote");
    add_threads("two threads: SAD complete, true", "SAD complete, true, two threads", "SAD complete, true");
    add_threads("two threads: ZNCC", "ZNCC, two threads", "ZNCC");
    add({"two threads: StereoBM full",
         "StereoBM full, two threads",
         "StereoBM full",
         extent,
         {},
         Clock::wall});
  }
}

/// Peak memory of match(), without the images and the maps of Matches.
std::int64_t working_bytes(const Scene& scene, const MatchConfig& config, const Exec& exec) {
  const std::int64_t before = held_bytes;
  most_held_bytes = before;
  const Matches matches = match_windows(scene.pair(), search(scene, config), exec);
  const std::int64_t maps = held_bytes - before;
  return most_held_bytes - before - maps;
}

std::string memory_section(const std::filesystem::path&, const std::vector<Scene>& scenes) {
  MarkdownTable table({"", "on", "MB", "goal", "met"}, 2);
  MatchConfig zncc;
  for (const auto& [name, config] : {std::pair{"SAD", kSobelSad}, std::pair{"ZNCC", zncc}}) {
    for (const Scene& scene : scenes) {
      const double most = scene.extent() == "1280x720x128" ? 4 : 2;
      for (const int threads : {1, 2}) {
        const double megabytes =
            1e-6 * static_cast<double>(working_bytes(scene, config, Exec::with_threads(threads)));
        table.add({std::string(name) + (threads > 1 ? ", two threads" : ""),
                   scene.name + " " + scene.extent(), text_of("%.2f", megabytes),
                   "≤ " + text_of("%.0f", most), megabytes <= most ? "yes" : "**no**"});
      }
    }
  }
  return table.text();
}

constexpr std::array kMiddlebury{"middlebury2001", "middlebury2003", "middlebury2005", "middlebury2006",
                                 "middlebury2014"};

std::string accuracy_section(const std::filesystem::path& data, const std::vector<Scene>&) {
  constexpr std::size_t kBad2 = 2;
  constexpr int kWindow = 15;
  MatchConfig match = kSobelSad;
  match.window_size = kWindow;
  match.prefilter_cap = 9;
  std::vector<double> ours_bad, ours_density, theirs_bad, theirs_density;
  for (const char* folder : kMiddlebury) {
    for (const TrueFrame& frame : load_true_frames(data / "real" / folder)) {
      const auto pair = StereoPair::from(frame.images.left.gray, frame.images.right.gray);
      match.num_disparities = (frame.num_disparities + 15) / 16 * 16;  // required by StereoBM
      const auto errors = [&](View<const float> disparity_px) {
        return disparity_errors(disparity_px, frame.truth_px, frame.hidden, match.num_disparities);
      };
      const DisparityMap ours =
          match_and_check(pair, complete_config(match, LeftRightMethod::right_winner), one_thread());
      const Image<float> theirs = block_matched(pair, match.num_disparities, kWindow);
      ours_bad.push_back(errors(ours.disparity_px).bad_of_matched(kBad2));
      ours_density.push_back(errors(ours.disparity_px).density());
      theirs_bad.push_back(errors(theirs).bad_of_matched(kBad2));
      theirs_density.push_back(errors(theirs).density());
    }
  }
  MarkdownTable table(
      {"mean of " + std::to_string(ours_bad.size()) + " pairs", "bad-2 of matched, %", "density, %"});
  table.add({"SAD complete, true left-right, 15x15, xsobel with cap 9", text_of("%.2f", 100 * mean(ours_bad)),
             percent(mean(ours_density))});
  table.add({"StereoBM, 15x15, its defaults, uniqueness 15, texture 10, left-right 1",
             text_of("%.2f", 100 * mean(theirs_bad)), percent(mean(theirs_density))});
  return table.text();
}

/// Copies as much memory as the maps of Matches take, several times, to measure the variation of the machine
/// and its caches.
Run copying(const Scene& scene) {
  constexpr int kTimes = 4;
  const auto bytes = static_cast<std::size_t>(scene.left.size().area()) * (5 * sizeof(float) + 4);
  const auto from = std::make_shared<std::vector<std::byte>>(bytes, std::byte{1});
  const auto to = std::make_shared<std::vector<std::byte>>(bytes);
  return [=] {
    for (int i = 0; i < kTimes; ++i) std::copy(from->begin(), from->end(), to->begin());
  };
}

std::string steadiness_section(const std::filesystem::path&, const std::vector<Scene>& scenes) {
  constexpr int kFrames = 500;
  const auto spread = [](const std::vector<double>& times) {
    return percentile(times, 0.99) / median(times);
  };
  MarkdownTable table({"on", "median ms", "p99 ms", "p99 / median", "goal", "met",
                       "p99 / median of StereoBM full, interleaved", "p99 / median of memcpy"});
  for (const Scene& scene : scenes) {
    if (scene.extent() != "640x480x64") continue;
    const std::array<Run, 3> runs{complete(scene, LeftRightMethod::right_winner),
                                  engine_named("StereoBM full").prepare(scene), copying(scene)};
    std::array<std::vector<double>, 3> times;
    for (int i = 0; i < kFrames; ++i) {
      for (std::size_t k = 0; k < runs.size(); ++k) times[k].push_back(milliseconds(runs[k], Clock::cpu));
    }
    const double ratio = spread(times[0]);
    table.add({scene.name + " " + scene.extent(), text_of("%.2f", median(times[0])),
               text_of("%.2f", percentile(times[0], 0.99)), text_of("%.2f", ratio), "≤ 1.20",
               ratio <= 1.2 ? "yes" : "**no**", text_of("%.2f", spread(times[1])),
               text_of("%.2f", spread(times[2]))});
  }
  return table.text();
}

const Registration kMatching([](Registry& all) {
  add_engines(all);
  add_comparisons(all);
  all.sections.push_back(
      {"Working memory of matching, beyond the images and the maps of Matches", memory_section});
  all.sections.push_back({"SAD complete over 500 frames, processor time", steadiness_section});
  all.sections.push_back({"Accuracy on Middlebury, columns x ≥ the number of disparities", accuracy_section});
});

}  // namespace
}  // namespace cairn::lab
