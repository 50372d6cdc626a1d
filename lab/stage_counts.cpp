// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The second frame of `cairn bench`'s pair at 320x240 with 64 disparities, one thread, preset `default`: prints the name of
// each stage at its end, and calls the system, where stage_counts_plugin.c notes the instructions so far. See
// stage_counts.sh.
#include <unistd.h>
#include <cairn/cairn.hpp>
#include <cairn/timing/drawn_pair.hpp>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

int main(int argc, char** argv) {
  const bool is_avx2 = argc > 1 && std::strcmp(argv[1], "avx2") == 0;
  const cairn::Config config;
  const cairn::timing::DrawnPair drawn = cairn::timing::draw_pair({320, 240}, config.match);
  cairn::Exec exec =
      is_avx2 ? cairn::Exec::with_threads(1, cairn::Target::avx2) : cairn::Exec::with_threads(1);
  (void)cairn::segment(drawn.pair(), drawn.rig, config, exec);  // loads network and trees
  std::vector<std::string> stages;
  exec.observe = [&stages](std::string_view stage, const cairn::StageResult&, double) {
    stages.emplace_back(stage);
    (void)getppid();
  };
  (void)getppid();
  (void)cairn::segment(drawn.pair(), drawn.rig, config, exec);
  (void)getppid();
  for (const std::string& stage : stages) std::puts(stage.c_str());
  std::puts("rest");
}
