// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The matching kernels on every instruction set of this processor. Takes Google Benchmark's options, e.g.
// --benchmark_filter=match_rows/sad.
#include <benchmark/benchmark.h>

#include <cairn/core/target.hpp>
#include <cairn/image/prefilter.hpp>
#include <cairn/stereo/left_right.hpp>
#include <cairn/stereo/semi_global.hpp>
#include <cairn/stereo/subpixel.hpp>
#include <random>
#include <string>

namespace {

using namespace cairn;

constexpr Size kSize{640, 480};

/// The right image is the left one shifted by 5 px, with some dots of its own.
struct ImagePair {
  Image<Gray> left{kSize};
  Image<Gray> right{kSize};
  ImagePair() {
    std::mt19937 random(1);
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) left(x, y) = static_cast<Gray>(random());
      for (int x = 0; x < kSize.width; ++x) {
        right(x, y) = x + 5 < kSize.width && random() % 4 != 0 ? left(x + 5, y) : static_cast<Gray>(random());
      }
    }
  }
  [[nodiscard]] StereoPair pair() const { return StereoPair::from(left, right); }
};
const ImagePair& images() {
  static const ImagePair all;
  return all;
}

/// Pixels times disparities per second.
void count_candidates(benchmark::State& state, const MatchConfig& config) {
  const auto candidates = state.iterations() * kSize.width * kSize.height * config.num_disparities;
  state.counters["candidates"] =
      benchmark::Counter(static_cast<double>(candidates), benchmark::Counter::kIsRate);
}

Exec exec_on(Target target) {
  Exec exec;
  exec.target = target;
  exec.pool = Pool::make();
  return exec;
}

void match_on(benchmark::State& state, const MatchConfig& config, Target target) {
  const Exec exec = exec_on(target);
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(match(images().pair(), config, SemiGlobalConfig(), exec));
  }
  count_candidates(state, config);
}

template <class Stage>
void add_stage(const std::string& stage_name, Stage stage) {
  benchmark::RegisterBenchmark(stage_name.c_str(), [stage](benchmark::State& state) {
    const Exec exec = exec_on(Target::best);
    for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(stage(exec));
  })->Unit(benchmark::kMicrosecond);
}

void add_match(const std::string& case_name, const MatchConfig& config) {
  for (const Target target : supported_targets()) {
    if (target == Target::scalar) continue;
    benchmark::RegisterBenchmark((case_name + "/" + std::string(name(target))).c_str(),
                                 [=](benchmark::State& state) { match_on(state, config, target); })
        ->Unit(benchmark::kMicrosecond);
  }
}

void add_all() {
  for (const auto& [cost_name, cost] : kCosts) {
    for (const auto& [maps_name, maps] : kMatchMaps) {
      add_match("match/" + std::string(cost_name) + "/" + std::string(maps_name),
                {.cost = cost, .maps = maps});
    }
  }
  constexpr MatchConfig kFiltered{.cost = Cost::sad, .prefilter = Prefilter::xsobel};
  for (const auto& [maps_name, maps] : kMatchMaps) {
    MatchConfig config = kFiltered;
    config.maps = maps;
    add_match("match/sad on xsobel/" + std::string(maps_name), config);
  }
  add_match("match/semi_global", {.method = MatchMethod::semi_global});

  static const Matches matches = match_windows(images().pair(), kFiltered, {});
  add_stage("filter_xsobel", [](const Exec& exec) { return filter_xsobel(images().left, 31, exec); });
  add_stage("remove_mean", [](const Exec& exec) { return remove_mean(images().left, 9, exec); });
  add_stage("refine_subpixel", [](const Exec& exec) { return refine_subpixel(matches, {}, exec); });
  add_stage("reject_inconsistent/true",
            [](const Exec& exec) { return reject_inconsistent(matches, {}, exec); });
  add_stage("reject_inconsistent/vote", [](const Exec& exec) {
    return reject_inconsistent(matches, {.method = LeftRightMethod::vote}, exec);
  });
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  add_all();
  benchmark::RunSpecifiedBenchmarks();
}
