// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

/// What is raced in engines.cpp. A file of engines registers them, and the rows of the table that they stand
/// in, with one static `const Registration`; the program itself knows none of them.
namespace cairn::engines {

/// A pair of pictures at one of the sizes that the goals are about.
struct Scene {
  std::string name;
  int num_disparities;
  Image<Gray> left;
  Image<Gray> right;
  Image<Rgb> left_rgb;

  [[nodiscard]] StereoPair pair() const { return StereoPair::from(left, right, left_rgb); }
  /// "640x480x64"
  [[nodiscard]] std::string extent() const;
};

/// Does one frame's work.
using Run = std::function<void()>;

/// One way to do something. `prepare` does what is done once for many frames; the scene outlives the run.
struct Engine {
  std::string_view name;
  std::function<Run(const Scene& scene)> prepare;
};

/// Which ratios are good enough.
struct Goal {
  double at_least = 0;
  double at_most = std::numeric_limits<double>::infinity();
};

/// cpu: of the whole process. wall: what one waits for, to compare numbers of threads.
enum class Clock { cpu, wall };

/// One row of the table: how many times as long `peer` takes as `ours`, on the scenes of one extent.
struct Comparison {
  std::string_view what;
  std::string_view ours;
  std::string_view peer;
  std::string_view extent;
  Goal goal;
  Clock clock = Clock::cpu;
};

/// A part of the report that is no race: returns Markdown. `data` is the folder that holds real/.
struct Section {
  std::string_view title;
  std::function<std::string(const std::filesystem::path& data, const std::vector<Scene>& scenes)> write;
};

struct Registry {
  std::vector<Engine> engines;
  std::vector<Comparison> comparisons;
  std::vector<Section> sections;
};
Registry& registry();

struct Registration {
  explicit Registration(void (*add_to)(Registry&)) { add_to(registry()); }
};

/// Milliseconds of `run`, by either clock.
double milliseconds(const Run& run, Clock clock);

/// Throws Error where none is called so.
const Engine& engine_named(std::string_view name);

// Of engines_opencv.cpp:

/// StereoBM with its defaults, uniqueness 15, texture 10 and left-right 1; px, NaN = hole.
Image<float> block_matched(const StereoPair& pair, int num_disparities, int window);

/// Bilinear.
Image<Gray> resized(const Image<Gray>& image, Size size);
Image<Rgb> resized(const Image<Rgb>& image, Size size);

}  // namespace cairn::engines
