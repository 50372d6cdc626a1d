// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Our segmentations compared with OpenCV's, the whole pipeline with StereoBM, and the time of each stage. One
// thread each, unless the name says two.
#include <algorithm>
#include <cairn/cairn.hpp>
#include <cairn/image/gradient.hpp>
#include <cairn/regions/watershed.hpp>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include <cairn/timing/clock.hpp>
#include "engines.hpp"
#include "markdown_table.hpp"

#if CAIRN_WITH_XIMGPROC
#include <opencv2/ximgproc/segmentation.hpp>
#endif

namespace cairn::lab {
namespace {

Exec pooled(int threads) {
  Exec exec = Exec::with_threads(threads);
  exec.pool = Pool::make();
  return exec;
}

/// The paper's method with StereoBM-like settings: all checks, both segmentations, fusion, objects.
Config paper_chain(const Scene& scene) {
  Config config = Config::paper();
  config.match.cost = Cost::sad;
  config.match.prefilter = Prefilter::xsobel;
  config.match.num_disparities = scene.num_disparities;
  return config;
}
Config default_chain(const Scene& scene) {
  Config config;
  config.match.num_disparities = scene.num_disparities;
  return config;
}

Run chain(const Scene& scene, const Config& config, int threads) {
  return [=, exec = pooled(threads), &scene] {
    static_cast<void>(segment(scene.pair(), std::nullopt, config, exec));
  };
}

Run intensity(const Scene& scene) {
  return [config = paper_chain(scene).intensity, exec = pooled(1), &scene] {
    static_cast<void>(segment_intensity(scene.left, config, exec));
  };
}

std::shared_ptr<Image<std::uint16_t>> gradient_of(const Scene& scene) {
  return std::make_shared<Image<std::uint16_t>>(
      gradient(scene.left, paper_chain(scene).intensity.smoothing_sigma, {}));
}

Run our_watershed(const Scene& scene) {
  return [heights = gradient_of(scene), exec = pooled(1)] { static_cast<void>(watershed(*heights, exec)); };
}

/// cv::watershed on the same gradient. It requires markers, which ours finds itself: here the lowest pixels
/// of each of our basins.
Run opencv_watershed(const Scene& scene) {
  const auto heights = gradient_of(scene);
  const Basins basins = watershed(*heights, {});
  std::vector<std::uint16_t> lowest(static_cast<std::size_t>(basins.count), UINT16_MAX);
  const Size size = heights->size();
  const auto for_each_pixel = [&](auto found) {
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) found(x, y, lowest[index(basins.labels(x, y))], (*heights)(x, y));
    }
  };
  for_each_pixel(
      [](int, int, std::uint16_t& least, std::uint16_t height) { least = std::min(least, height); });
  cv::Mat picture(size.height, size.width, CV_8UC3);
  cv::Mat markers(size.height, size.width, CV_32S);
  for_each_pixel([&](int x, int y, std::uint16_t least, std::uint16_t height) {
    const auto level = static_cast<std::uint8_t>(std::min<int>(height, 255));
    picture.at<cv::Vec3b>(y, x) = {level, level, level};
    markers.at<std::int32_t>(y, x) = height == least ? number(basins.labels(x, y)) + 1 : 0;
  });
  return [=, work = std::make_shared<cv::Mat>()] {
    cv::setNumThreads(1);
    markers.copyTo(*work);
    cv::watershed(picture, *work);
  };
}

#if CAIRN_WITH_XIMGPROC
cv::Mat picture_of(const Scene& scene) {
  cv::Mat picture(scene.left.height(), scene.left.width(), CV_8UC3);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const Gray grey = scene.left(x, y);
      const Rgb colour = scene.left_rgb.empty() ? Rgb{grey, grey, grey} : scene.left_rgb(x, y);
      picture.at<cv::Vec3b>(y, x) = {colour.b, colour.g, colour.r};
    }
  }
  return picture;
}

Run graph_segmentation(const Scene& scene) {
  return [picture = picture_of(scene), labels = std::make_shared<cv::Mat>()] {
    cv::setNumThreads(1);
    cv::ximgproc::segmentation::createGraphSegmentation()->processImage(picture, *labels);
  };
}

/// The usual combination of OpenCV functions for this purpose.
Run opencv_chain(const Scene& scene) {
  return [segment = graph_segmentation(scene), match = engine_named("StereoSGBM 3WAY").prepare(scene)] {
    segment();
    match();
  };
}
#endif

void add_engines(Registry& all) {
  const auto add = [&](std::string_view name, std::function<Run(const Scene&)> prepare) {
    all.engines.push_back({name, std::move(prepare)});
  };
  add("watershed", our_watershed);
  add("cv::watershed", opencv_watershed);
  add("segment_intensity", intensity);
  add("chain", [](const Scene& s) { return chain(s, paper_chain(s), 1); });
  add("chain, two threads", [](const Scene& s) { return chain(s, paper_chain(s), 2); });
  add("default", [](const Scene& s) { return chain(s, default_chain(s), 1); });
  add("default, two threads", [](const Scene& s) { return chain(s, default_chain(s), 2); });
#if CAIRN_WITH_XIMGPROC
  add("createGraphSegmentation", graph_segmentation);
  add("SGBM 3WAY + createGraphSegmentation", opencv_chain);
#endif
}

void add_comparisons(Registry& all) {
  constexpr std::string_view kSmall = "320x240x64";
  constexpr std::string_view kMiddle = "640x480x64";
  constexpr std::string_view kLarge = "1280x720x128";
  const auto add = [&](const Comparison& row) { all.comparisons.push_back(row); };
  add({"watershed of the same gradient", "watershed", "cv::watershed", kMiddle, {5}});
#if CAIRN_WITH_XIMGPROC
  add({"intensity segmentation, complete", "segment_intensity", "createGraphSegmentation", kMiddle, {20}});
  add({"whole chain, default", "default", "SGBM 3WAY + createGraphSegmentation", kMiddle, {5}});
#endif
  // At most 1.25, 1.1 and 0.75 times a full call.
  add({"whole chain, paper with SAD on xsobel", "chain", "StereoBM full", kSmall, {1 / 1.25}});
  add({"whole chain, paper with SAD on xsobel", "chain", "StereoBM full", kMiddle, {1 / 1.1}});
  add({"whole chain, paper with SAD on xsobel", "chain", "StereoBM full", kLarge, {1 / 0.75}});
  for (const auto& [extent, goal] :
       {std::pair{kSmall, 1.5}, std::pair{kMiddle, 1.7}, std::pair{kLarge, 1.7}}) {
    add({"two threads: whole chain", "chain, two threads", "chain", extent, {goal}, Clock::wall});
    add({"two threads: whole chain, default", "default, two threads", "default", extent, {}, Clock::wall});
  }
}

double processor_ms() {
  return timing::now_ms(CLOCK_PROCESS_CPUTIME_ID);
}

/// The least processor time of each stage over several frames, in order, and the total without matching.
std::vector<std::pair<std::string, double>> stage_times(const Scene& scene, const Config& config) {
  constexpr int kFrames = 15;
  std::vector<std::pair<std::string, double>> least;
  double least_rest = std::numeric_limits<double>::infinity();
  Exec exec = pooled(1);
  std::size_t stage = 0;
  double last = 0;
  double rest = 0;
  exec.observe = [&](std::string_view name, const StageResult&, double) {
    const double time = processor_ms() - last;
    if (stage == least.size()) least.emplace_back(name, time);
    least[stage].second = std::min(least[stage].second, time);
    if (name != "match") rest += time;
    ++stage;
    last = processor_ms();
  };
  for (int frame = 0; frame < kFrames; ++frame) {
    stage = 0;
    rest = 0;
    last = processor_ms();
    static_cast<void>(segment(scene.pair(), std::nullopt, config, exec));
    least_rest = std::min(least_rest, rest);
  }
  least.emplace_back("all except match", least_rest);
  return least;
}

std::string stages_section(const std::vector<Scene>& scenes, Config (*config_for)(const Scene&)) {
  std::vector<std::string> head{"min ms"};
  std::vector<std::vector<std::pair<std::string, double>>> columns;
  for (const Scene& scene : scenes) {
    head.push_back(scene.name + " " + scene.extent());
    columns.push_back(stage_times(scene, config_for(scene)));
  }
  MarkdownTable table(head, 1);
  for (std::size_t i = 0; i < columns.front().size(); ++i) {
    std::vector<std::string> row{columns.front()[i].first};
    for (const auto& column : columns) row.push_back(text_of("%.2f", column.at(i).second));
    table.add(row);
  }
  return table.text();
}

const Registration kRegions([](Registry& all) {
  add_engines(all);
  add_comparisons(all);
  all.sections.push_back({"Stages of the whole chain, paper with SAD on xsobel, processor time",
                          [](const std::filesystem::path&, const std::vector<Scene>& scenes) {
                            return stages_section(scenes, paper_chain);
                          }});
  all.sections.push_back({"Stages of the whole chain, default, processor time",
                          [](const std::filesystem::path&, const std::vector<Scene>& scenes) {
                            return stages_section(scenes, default_chain);
                          }});
});

}  // namespace
}  // namespace cairn::lab
