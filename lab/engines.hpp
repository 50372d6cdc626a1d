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

/// The engines raced in engines.cpp. A file of engines registers them and their rows of the table with one
/// static `const Registration`; the program itself knows none of them.
namespace cairn::lab {

/// An image pair of one of the sizes for which there are goals.
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

/// Processes one frame.
using Run = std::function<void()>;

/// One implementation of a task. `prepare` does the work that is shared by many frames; the scene outlives
/// the run.
struct Engine {
  std::string_view name;
  std::function<Run(const Scene& scene)> prepare;
};

/// The range of ratios that meets the goal.
struct Goal {
  double at_least = 0;
  double at_most = std::numeric_limits<double>::infinity();
};

/// cpu: time of the whole process. wall: elapsed time, to compare numbers of threads.
enum class Clock { cpu, wall };

/// A row of the table: the time of `peer` divided by that of `ours`, on the scenes of one size.
struct Comparison {
  std::string_view what;
  std::string_view ours;
  std::string_view peer;
  std::string_view extent;
  Goal goal;
  Clock clock = Clock::cpu;
};

/// A further section of the report, in Markdown. `data` is the folder with real/.
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

/// Milliseconds of `run` on the given clock.
double milliseconds(const Run& run, Clock clock);

/// Throws Error for an unknown name.
const Engine& engine_named(std::string_view name);

// Defined in engines_opencv.cpp:

/// StereoBM with its defaults: uniqueness 15, texture 10 and left-right 1; px, NaN = hole.
Image<float> block_matched(const StereoPair& pair, int num_disparities, int window);

/// With bilinear interpolation.
Image<Gray> resized(const Image<Gray>& image, Size size);
Image<Rgb> resized(const Image<Rgb>& image, Size size);

}  // namespace cairn::lab
