// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Writes BENCHMARK.md and its plots: the stages at three sizes, on one and on all threads, and how time grows
// with pixels and with disparities.
//   page ROOT COMMIT [ENGINES]
// ROOT is the project's folder, ENGINES a file with what the program engines printed. All is measured on the
// pair that the program draws, so that nothing else is needed; what real pictures take, engines shows.
#include <algorithm>
#include <array>
#include <cairn/core/target.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <io/atomic_file.hpp>
#include <io/read_file.hpp>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <timing/drawn_pair.hpp>
#include <timing/frame_times.hpp>
#include <timing/machine.hpp>
#include <timing/statistics.hpp>
#include "markdown_table.hpp"
#include "svg_plot.hpp"

namespace {

using namespace cairn;
using namespace cairn::report;
namespace fs = std::filesystem;

struct Extent {
  Size size;
  int num_disparities;
  [[nodiscard]] std::string text() const { return cairn::text(size) + "x" + std::to_string(num_disparities); }
};
constexpr std::array kExtents{Extent{{320, 240}, 64}, Extent{{640, 480}, 64}, Extent{{1280, 720}, 128}};
constexpr std::array<std::string_view, 2> kPresets{"default", "paper"};

FrameTimes measured(const DrawnPair& drawn, std::string_view preset, int num_disparities, int threads,
                    double seconds) {
  Config config = Config::preset(preset);
  config.match.num_disparities = num_disparities;
  return time_frames(drawn.pair(), drawn.rig, config, Exec::with_threads(threads), {.seconds = seconds});
}

/// What the scene of an extent reaches: most of its search range.
float largest_disparity_px(int num_disparities) {
  return 0.75F * static_cast<float>(num_disparities);
}

// ---- stages ----

/// One column of the table of stages.
struct Column {
  std::string title;
  FrameTimes times;
};

std::vector<Column> columns_of(std::string_view preset, int all_threads) {
  constexpr double kSeconds = 3;
  std::vector<int> numbers_of_threads{1};
  if (all_threads > 1) numbers_of_threads.push_back(all_threads);
  std::vector<Column> columns;
  for (const Extent& extent : kExtents) {
    const DrawnPair drawn = draw_pair(extent.size, largest_disparity_px(extent.num_disparities));
    for (const int threads : numbers_of_threads) {
      columns.push_back(
          {extent.text() + ", " + std::to_string(threads) + (threads == 1 ? " thread" : " threads"),
           measured(drawn, preset, extent.num_disparities, threads, kSeconds)});
    }
  }
  return columns;
}

std::string stage_table(const std::vector<Column>& columns) {
  std::vector<std::string> header{"ms"};
  for (const Column& column : columns) header.push_back(column.title);
  MarkdownTable table(header);
  const auto add = [&](const std::string& title, const std::function<std::string(const FrameTimes&)>& cell) {
    std::vector<std::string> row{title};
    for (const Column& column : columns) row.push_back(cell(column.times));
    table.add(row);
  };
  const auto ms = [](double milliseconds) { return text_of("%.2f", milliseconds); };
  // A preset has the same stages at every size.
  for (std::size_t i = 0; i < columns.front().times.stages.size(); ++i) {
    add("`" + columns.front().times.stages[i].name + "`",
        [&](const FrameTimes& times) { return ms(median(times.stages.at(i).times.wall_ms)); });
  }
  add("**frame**, median",
      [&](const FrameTimes& times) { return "**" + ms(median(times.frame.wall_ms)) + "**"; });
  add("of it for disparity", [&](const FrameTimes& times) { return ms(median(times.disparity.wall_ms)); });
  add("frame, p99", [&](const FrameTimes& times) { return ms(percentile(times.frame.wall_ms, 0.99)); });
  add("frame, processor time", [&](const FrameTimes& times) { return ms(median(times.frame.cpu_ms)); });
  add("frames per second",
      [](const FrameTimes& times) { return text_of("%.1f", 1000 / median(times.frame.wall_ms)); });
  add("images at the peak, MB",
      [](const FrameTimes& times) { return text_of("%.1f", 1e-6 * static_cast<double>(times.pool_bytes)); });
  add("image buffers allocated after the first frame",
      [](const FrameTimes& times) { return std::to_string(times.later_allocations); });
  add("frames measured", [](const FrameTimes& times) { return std::to_string(times.frames()); });
  return table.text();
}

// ---- growth ----

/// Processor time of one thread, ms.
struct Point {
  double x = 0;
  double match = 0;
  double disparity = 0;
  double frame = 0;
};

Point point_of(double x, const FrameTimes& times) {
  const auto match = std::find_if(times.stages.begin(), times.stages.end(),
                                  [](const StageTimes& stage) { return stage.name == "match"; });
  return {x, median(match->times.cpu_ms), median(times.disparity.cpu_ms), median(times.frame.cpu_ms)};
}

struct Line {
  double at_zero = 0;
  double slope = 0;
  double most_off = 0;  // of a point from the line, share of the point
};

/// By least squares of the relative distances: near and far points count alike.
Line straight_line(const std::vector<Point>& points, double Point::*y) {
  double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
  for (const Point& p : points) {
    const double weight = 1 / (p.*y * p.*y);
    w += weight;
    wx += weight * p.x;
    wy += weight * p.*y;
    wxx += weight * p.x * p.x;
    wxy += weight * p.x * p.*y;
  }
  Line line;
  line.slope = (w * wxy - wx * wy) / (w * wxx - wx * wx);
  line.at_zero = (wy - line.slope * wx) / w;
  for (const Point& p : points) {
    line.most_off = std::max(line.most_off, std::abs(line.at_zero + line.slope * p.x - p.*y) / p.*y);
  }
  return line;
}

struct Growth {
  std::string x_title;  // of the plot
  std::string unit;     // that a slope is for
  double unit_x = 1;
  std::vector<Tick> ticks;
  std::vector<std::vector<Point>> of_presets;  // by kPresets
};

constexpr double kGrowthSeconds = 1.5;

Growth growth_with_pixels() {
  constexpr int kNumDisparities = 64;
  constexpr std::array kSizes{Size{320, 240}, Size{480, 360}, Size{640, 480},
                              Size{800, 600}, Size{960, 720}, Size{1280, 960}};
  Growth growth{"megapixels, 64 disparities", "megapixel", 1, {}, {}};
  for (const double megapixels : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2})
    growth.ticks.push_back({megapixels, text_of("%.1f", megapixels)});
  for (const std::string_view preset : kPresets) {
    std::vector<Point>& points = growth.of_presets.emplace_back();
    for (const Size size : kSizes) {
      const DrawnPair drawn = draw_pair(size, largest_disparity_px(kNumDisparities));
      points.push_back(point_of(1e-6 * static_cast<double>(size.area()),
                                measured(drawn, preset, kNumDisparities, 1, kGrowthSeconds)));
    }
  }
  return growth;
}

Growth growth_with_disparities() {
  constexpr Size kSize{640, 480};
  constexpr std::array kNumbers{32, 64, 96, 128, 160, 192, 224, 256};
  // The scene is one for all, and the least range holds it.
  const DrawnPair drawn = draw_pair(kSize, largest_disparity_px(kNumbers.front()));
  Growth growth{"disparities, 640x480", "64 disparities", 64, {}, {}};
  for (const int number : {0, 64, 128, 192, 256})
    growth.ticks.push_back({double(number), std::to_string(number)});
  for (const std::string_view preset : kPresets) {
    std::vector<Point>& points = growth.of_presets.emplace_back();
    for (const int number : kNumbers)
      points.push_back(point_of(number, measured(drawn, preset, number, 1, kGrowthSeconds)));
  }
  return growth;
}

/// Four whole steps of two digits' precision at most, not far above the most.
double end_of_axis(double most) {
  constexpr int kSteps = 4;
  const double power = std::pow(10.0, std::floor(std::log10(most / kSteps)));
  return kSteps * power * std::ceil(most / kSteps / power);
}

/// A panel for each preset; the axes begin at 0, so that a line through the origin looks like one.
Plot plot_of(const Growth& growth) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Plot plot{.x_title = growth.x_title, .x = {0}, .ticks = growth.ticks};
  for (const Point& point : growth.of_presets.front()) plot.x.push_back(point.x);
  for (std::size_t i = 0; i < kPresets.size(); ++i) {
    const std::vector<Point>& points = growth.of_presets[i];
    Panel panel{.title = "preset " + std::string(kPresets[i]) + ", ms of one core"};
    const auto add = [&](const char* name, const char* colour, double Point::*y) {
      Series series{name, colour, {kNone}};
      for (const Point& point : points) series.y.push_back(point.*y);
      panel.series.push_back(std::move(series));
    };
    add("frame", "#1f77b4", &Point::frame);
    add("disparity", "#d62728", &Point::disparity);
    add("match", "#2ca02c", &Point::match);
    double most = 0;
    for (const Point& point : points) most = std::max(most, point.frame);
    panel.y_max = end_of_axis(most);
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

std::string growth_table(const Growth& growth) {
  MarkdownTable table(
      {"preset", "of", "ms for each " + growth.unit, "ms besides", "farthest from the line, %"}, 2);
  for (std::size_t i = 0; i < kPresets.size(); ++i) {
    const auto add = [&](const char* name, double Point::*y) {
      const Line line = straight_line(growth.of_presets[i], y);
      table.add({std::string(kPresets[i]), name, text_of("%.2f", line.slope * growth.unit_x),
                 text_of("%.2f", line.at_zero), percent(line.most_off)});
    };
    add("frame", &Point::frame);
    add("disparity", &Point::disparity);
    add("match", &Point::match);
  }
  return table.text();
}

std::string point_table(const Growth& growth, const char* x_name, const char* x_format) {
  std::vector<std::string> header{x_name};
  for (const std::string_view preset : kPresets) {
    for (const char* what : {"frame", "disparity", "match"})
      header.push_back(std::string(preset) + ": " + what);
  }
  MarkdownTable table(header);
  for (std::size_t p = 0; p < growth.of_presets.front().size(); ++p) {
    std::vector<std::string> row{text_of(x_format, growth.of_presets.front()[p].x)};
    for (const std::vector<Point>& points : growth.of_presets) {
      for (const double y : {points[p].frame, points[p].disparity, points[p].match})
        row.push_back(text_of("%.2f", y));
    }
    table.add(row);
  }
  return table.text();
}

// ---- the page ----

std::string head(const std::string& commit, int threads) {
  return "# Benchmark\n\n<!-- Written by ./dev bench; do not edit. -->\n\n"
         "Measured on " +
         today() + " at commit " + commit + ", on " + processor() + " with " + std::to_string(threads) +
         (threads == 1 ? " processor" : " processors") +
         " (kernels: " + std::string(name(supported_targets().back())) + "), compiled with " + compiler() +
         ".\nThis page reports the time of each stage, its growth with the image size, and a comparison with "
         "OpenCV. `./dev bench` measures everything again and writes this page and its plots. It needs an "
         "otherwise idle machine.\n\n";
}

constexpr std::string_view kStagesIntro =
    "## Stages\n\n"
    "Wall-clock times on the pair that `cairn bench` generates: the median over the frames after a first "
    "warm-up frame, for each size with its number of disparities. The generated room has fewer and larger "
    "regions than many photographs, on which the grouping stages take longer; the time of matching depends "
    "only on the size.\n\n";

constexpr std::string_view kGrowthIntro =
    "## Growth\n\n"
    "Median processor time on one thread, and the straight line (constant ms + ms per unit) that fits it "
    "best, by relative distance. Matching processes whole vectors of disparities, so its time grows in "
    "steps.\n\n";

std::string growth_section(const char* title, const char* picture, const Growth& growth, const char* x_name,
                           const char* x_format) {
  return "### " + std::string(title) + "\n\n![" + title + "](docs/images/benchmark/" + picture + ")\n\n" +
         growth_table(growth) + "\n" + point_table(growth, x_name, x_format) + "\n";
}

void write_page(const fs::path& root, const std::string& commit, const std::optional<fs::path>& engines) {
  const int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const fs::path pictures = root / "docs" / "images" / "benchmark";
  const auto tell = [](const std::string& what) { std::fprintf(stderr, "page: %s\n", what.c_str()); };
  std::string page = head(commit, threads) + std::string(kStagesIntro);
  for (const std::string_view preset : kPresets) {
    tell("stages, preset " + std::string(preset));
    page += "### Preset `" + std::string(preset) + "`\n\n" + stage_table(columns_of(preset, threads)) + "\n";
  }
  tell("growth with pixels");
  const Growth with_pixels = growth_with_pixels();
  tell("growth with disparities");
  const Growth with_disparities = growth_with_disparities();
  page +=
      std::string(kGrowthIntro) +
      growth_section("Time against pixels", "pixels.svg", with_pixels, "megapixels", "%.2f") +
      growth_section("Time against disparities", "disparities.svg", with_disparities, "disparities", "%.0f");
  page += "## Comparison with OpenCV\n\n";
  if (engines) {
    constexpr std::size_t kMost = std::size_t{1} << 24;
    page +=
        "The output of `./dev bench engines`: ours and theirs interleaved in one process, on real images, "
        "one thread each unless stated otherwise; the ratio is theirs to ours, of the minimum times.\n\n" +
        io::read_file(*engines, kMost);
  } else {
    page += "Not measured in this run: it needs OpenCV's calib3d and the data collection.\n";
  }
  io::make_folder(pictures);
  io::write_file(pictures / "pixels.svg", svg_of(plot_of(with_pixels)));
  io::write_file(pictures / "disparities.svg", svg_of(plot_of(with_disparities)));
  io::write_file(root / "BENCHMARK.md", page);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fprintf(stderr, "usage: page ROOT COMMIT [ENGINES]\n");
    return 2;
  }
  try {
    const auto start = std::chrono::steady_clock::now();
    write_page(argv[1], argv[2], argc == 4 ? std::optional<fs::path>(argv[3]) : std::nullopt);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    std::printf("wrote BENCHMARK.md and its pictures in %.0f s\n", took.count());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "page: %s\n", error.what());
    return 1;
  }
}
