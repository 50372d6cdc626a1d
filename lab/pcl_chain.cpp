// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Objects from common libraries, next to ours: OpenCV's semi-global matcher, points in metres, voxels, the
// largest planes removed by PCL's RANSAC, Euclidean clusters of the rest.
//   pcl_chain DATA [--yardstick FOLDER] [--threads N]
//   pcl_chain --search DATA [--threads N] [--draws N] [--rounds N] [--report] [OPTION=VALUE]...
// DATA is the folder with rendered/ and real/, FOLDER that of `./dev worlds yardstick`. The first form prints
// the tables of docs/comparison.md. The second chooses the chain's parameters on the fit set, by the search that
// chose those of the preset `paper` (lab/search_program.hpp). Times are processor times of one thread.
#include <pcl/ModelCoefficients.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <algorithm>
#include <array>
#include <cairn/cairn.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <numeric>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <cairn/timing/clock.hpp>
#include <cairn/timing/opencv_matchers.hpp>
#include <cairn/timing/opencv_matrix.hpp>
#include "arguments.hpp"
#include "markdown_table.hpp"
#include "search_program.hpp"

namespace {

using namespace cairn;
using lab::percent;
using lab::text_of;
using Cloud = pcl::PointCloud<pcl::PointXYZ>;

struct Settings {
  double block_size, p1, p2;  // the penalties are per block pixel
  double uniqueness, speckle_size, speckle_range;
  double farthest_m, voxel_m;
  double planes, plane_m,
      least_plane;  // smallest plane to remove; tolerance of its points; share of all points, %
  double cluster_m, smallest,
      largest;  // distance between points of a cluster; its share of the image, %
};

struct ChainKnob {
  double Settings::*value;
  lab::Knob knob;
  const char* usual;   // as in tutorials
  const char* chosen;  // found by --search
};

const std::vector<ChainKnob>& chain_knobs() {
  static const std::vector<ChainKnob> all{
      {&Settings::farthest_m, {"cloud.farthest_m", {"4", "6", "10"}}, "10", "4"},
      {&Settings::voxel_m, {"cloud.voxel_m", {"0.01", "0.02", "0.03", "0.05"}}, "0.01", "0.01"},
      {&Settings::planes, {"planes.count", {"1", "2", "3", "4"}}, "3", "1"},
      {&Settings::plane_m, {"planes.within_m", {"0.01", "0.02", "0.03", "0.05", "0.08"}}, "0.02", "0.05"},
      {&Settings::least_plane, {"planes.least", {"5", "10", "20"}}, "10", "10"},
      {&Settings::cluster_m, {"clusters.within_m", {"0.02", "0.03", "0.05", "0.08", "0.12"}}, "0.02", "0.02"},
      {&Settings::smallest, {"clusters.smallest", {"0.1", "0.2", "0.5", "1"}}, "0.5", "1"},
      {&Settings::largest, {"clusters.largest", {"10", "20", "40", "100"}}, "100", "100"},
      {&Settings::block_size, {"sgbm.block_size", {"3", "5", "7", "9", "11"}}, "5", "5"},
      {&Settings::p1, {"sgbm.p1", {"2", "4", "8", "16"}}, "8", "8"},
      {&Settings::p2, {"sgbm.p2", {"16", "32", "64", "128"}}, "32", "32"},
      {&Settings::uniqueness, {"sgbm.uniqueness", {"0", "5", "10", "15"}}, "10", "0"},
      {&Settings::speckle_size, {"sgbm.speckle_size", {"0", "50", "100", "200"}}, "100", "100"},
      {&Settings::speckle_range, {"sgbm.speckle_range", {"1", "2", "4"}}, "2", "2"},
  };
  return all;
}

Settings settings_of(const lab::Values& values) {
  Settings settings{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ChainKnob& knob = chain_knobs()[i];
    const std::vector<std::string>& known = knob.knob.values;
    if (std::find(known.begin(), known.end(), values[i]) == known.end())
      throw Error(knob.knob.option + ": found '" + values[i] + "', expected one of the values searched");
    settings.*knob.value = std::stod(values[i]);
  }
  return settings;
}

Image<float> matched(const lab::TrueFrame& frame, const Settings& s) {
  const int pixels = static_cast<int>(s.block_size * s.block_size);
  const int range = (frame.num_disparities + 15) / 16 * 16;
  const auto matcher =
      cv::StereoSGBM::create(0, range, static_cast<int>(s.block_size), static_cast<int>(s.p1) * pixels,
                             static_cast<int>(s.p2) * pixels, 1, 63, static_cast<int>(s.uniqueness),
                             static_cast<int>(s.speckle_size), static_cast<int>(s.speckle_range));
  cv::Mat sixteenths;
  matcher->compute(timing::matrix(frame.images.left.gray), timing::matrix(frame.images.right.gray),
                   sixteenths);
  return timing::disparity_px_of(sixteenths, 0);
}

/// One point per voxel, the mean of those inside.
struct Points {
  Cloud::Ptr cloud = std::make_shared<Cloud>();
  std::vector<std::vector<Point>> pixels;  // pixels of each voxel
};

Points points_of(View<const float> disparity_px, const StereoRig& rig, const Settings& settings) {
  Points points;
  std::unordered_map<std::uint64_t, std::size_t> voxels;
  for (int y = 0; y < disparity_px.height(); ++y) {
    for (int x = 0; x < disparity_px.width(); ++x) {
      const float d = disparity_px(x, y);
      if (!(d > 0)) continue;
      const auto at = rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), d);
      if (!at || at->z > settings.farthest_m) continue;
      const auto step = [&](float metres) {  // 21 bits per coordinate
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(metres / settings.voxel_m))) &
               0x1fffff;
      };
      const auto [voxel, is_new] =
          voxels.try_emplace(step(at->x) << 42 | step(at->y) << 21 | step(at->z), points.cloud->size());
      if (is_new) {
        points.cloud->push_back({0, 0, 0});
        points.pixels.emplace_back();
      }
      pcl::PointXYZ& sum = (*points.cloud)[voxel->second];
      sum.x += at->x;
      sum.y += at->y;
      sum.z += at->z;
      points.pixels[voxel->second].push_back({x, y});
    }
  }
  for (std::size_t i = 0; i < points.pixels.size(); ++i) {
    const auto n = static_cast<float>(points.pixels[i].size());
    pcl::PointXYZ& at = (*points.cloud)[i];
    at = {at.x / n, at.y / n, at.z / n};
  }
  return points;
}

/// The indices that remain after removing the largest planes.
pcl::IndicesPtr without_planes(const Cloud::Ptr& cloud, const Settings& settings) {
  auto left = std::make_shared<pcl::Indices>(cloud->size());
  std::iota(left->begin(), left->end(), 0);
  pcl::SACSegmentation<pcl::PointXYZ> planes(false);  // deterministic: the same random numbers in every run
  planes.setModelType(pcl::SACMODEL_PLANE);
  planes.setMethodType(pcl::SAC_RANSAC);
  planes.setDistanceThreshold(settings.plane_m);
  planes.setMaxIterations(100);
  planes.setInputCloud(cloud);
  for (int i = 0; i < static_cast<int>(settings.planes) && left->size() > 3; ++i) {
    planes.setIndices(left);
    pcl::PointIndices inliers;
    pcl::ModelCoefficients plane;
    planes.segment(inliers, plane);
    if (static_cast<double>(inliers.indices.size()) <
        settings.least_plane / 100 * static_cast<double>(cloud->size()))
      break;
    std::vector<bool> gone(cloud->size(), false);
    for (const int point : inliers.indices) gone[static_cast<std::size_t>(point)] = true;
    auto rest = std::make_shared<pcl::Indices>();
    for (const int point : *left) {
      if (!gone[static_cast<std::size_t>(point)]) rest->push_back(point);
    }
    left = rest;
  }
  return left;
}

Image<ObjectId> clusters(const Points& points, Size size, const Settings& settings) {
  Image<ObjectId> labels(size);
  labels.fill(ObjectId{});
  const pcl::IndicesPtr left = without_planes(points.cloud, settings);
  if (left->empty()) return labels;
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setClusterTolerance(settings.cluster_m);
  extraction.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  extraction.setInputCloud(points.cloud);
  extraction.setIndices(left);
  std::vector<pcl::PointIndices> found;
  extraction.extract(found);
  int id = 0;
  for (const pcl::PointIndices& cluster : found) {
    std::vector<Point> pixels;
    for (const int point : cluster.indices) {
      const std::vector<Point>& seen = points.pixels[static_cast<std::size_t>(point)];
      pixels.insert(pixels.end(), seen.begin(), seen.end());
    }
    const double share = 100 * static_cast<double>(pixels.size()) / static_cast<double>(size.area());
    if (share < settings.smallest || share > settings.largest) continue;
    ++id;
    for (const Point at : pixels) labels(at.x, at.y) = ObjectId{id};
  }
  return labels;
}

/// The last matching result of a frame: most settings only change later steps.
struct MatchResult {
  std::array<double, 6> by{};
  Image<float> disparity_px;
};

lab::Score score(const lab::TrueFrame& frame, const Settings& s, MatchResult& matched_once) {
  const std::array<double, 6> by{s.block_size, s.p1, s.p2, s.uniqueness, s.speckle_size, s.speckle_range};
  if (!frame.rig)
    throw Error(frame.name + ": found no focal length and baseline, expected both in calib.txt");
  lab::Score result;
  const double start = timing::now_ms(CLOCK_THREAD_CPUTIME_ID);
  if (matched_once.by != by) matched_once = {by, matched(frame, s)};
  const Points points = points_of(matched_once.disparity_px, *frame.rig, s);
  const Image<ObjectId> labels = clusters(points, frame.objects.size(), s);
  result.milliseconds = timing::now_ms(CLOCK_THREAD_CPUTIME_ID) - start;
  result.objects = {object_errors(labels, frame.objects, {}), frame.partial};
  return result;
}

lab::SearchProgram search_chain(std::map<const lab::TrueFrame*, MatchResult>& matched_once,
                                std::mutex& guard) {
  lab::SearchProgram program{"pcl_chain", {}, {}, {}};
  for (const ChainKnob& knob : chain_knobs()) {
    program.knobs.push_back(knob.knob);
    program.start.emplace_back(knob.usual);
  }
  program.score = [&](const lab::TrueFrame& frame, const lab::Values& values, const Exec&) {
    MatchResult* known = nullptr;
    {
      const std::lock_guard lock(guard);
      known = &matched_once[&frame];
    }
    return score(frame, settings_of(values), *known);
  };
  return program;
}

using Way = std::function<lab::Score(const lab::TrueFrame&, const Exec&)>;

Way chain(const char* ChainKnob::*which) {
  lab::Values values;
  for (const ChainKnob& knob : chain_knobs()) values.emplace_back(knob.*which);
  return [settings = settings_of(values)](const lab::TrueFrame& frame, const Exec&) {
    MatchResult none;
    return score(frame, settings, none);
  };
}

Way ours(const Config& config, bool grey) {
  return [=](const lab::TrueFrame& frame, const Exec& exec) { return lab::score(frame, config, grey, exec); };
}

std::string counted(int part, int of) {
  return std::to_string(part) + "/" + std::to_string(of) + " = " +
         percent(of > 0 ? static_cast<double>(part) / of : NAN);
}

void add_row(lab::MarkdownTable& table, const std::string& name, std::span<const lab::FrameSet> sets,
             const Way& way, int threads) {
  std::vector<FrameObjects> objects;
  std::vector<double> times;
  for (const lab::FrameSet& set : sets) {
    std::vector<lab::Score> scores(set.frames.size());
    for_each_index(scores.size(), threads,
                   [&](std::size_t i, const Exec& exec) { scores[i] = way(set.frames[i], exec); });
    for (const lab::Score& score : scores) {
      objects.push_back(score.objects);
      times.push_back(score.milliseconds);
    }
  }
  const ObjectSummary sum = summarise(objects);
  table.add({name, counted(sum.found_50, sum.true_objects), counted(sum.found_75, sum.true_objects),
             counted(sum.right_50, sum.our_objects), percent(sum.mean_error), percent(sum.median_error),
             text_of("%.2f", sum.phantoms_per_frame()), text_of("%.0f", median(times))});
}

void compare(const std::filesystem::path& data, const std::filesystem::path& yardstick, int threads) {
  const auto show = [&](const std::string& title, std::span<const lab::FrameSet> sets) {
    lab::MarkdownTable table({"", "found 0.5, %", "found 0.75, %", "precision, %", "mean E, %", "median E, %",
                              "phantoms per frame", "ms"});
    add_row(table, "StereoSGBM and PCL, usual numbers", sets, chain(&ChainKnob::usual), threads);
    add_row(table, "StereoSGBM and PCL, searched", sets, chain(&ChainKnob::chosen), threads);
    add_row(table, "cairn, `paper`", sets, ours(Config::paper(), true), threads);
    add_row(table, "cairn, `default`, grey", sets, ours(Config{}, true), threads);
    add_row(table, "cairn, `default`, colour", sets, ours(Config{}, false), threads);
    std::printf("### %s\n\n%s\n", title.c_str(), table.text().c_str());
    std::fflush(stdout);
  };
  const auto show_each = [&](const std::vector<lab::FrameSet>& sets) {
    for (const lab::FrameSet& set : sets) show(set.name, {&set, 1});
  };
  show("fit", lab::fit_sets(data));
  show_each(lab::validation_sets(data));
  show_each(lab::hard_sets(data, yardstick));
}

void run(std::vector<std::string> arguments) {
  timing::set_opencv_threads(1);
  if (!arguments.empty() && arguments[0] == "--search") {
    arguments.erase(arguments.begin());
    std::map<const lab::TrueFrame*, MatchResult> matched_once;
    std::mutex guard;
    lab::run_search(search_chain(matched_once, guard), arguments);
    return;
  }
  int threads = 1;
  std::filesystem::path yardstick;
  for (; arguments.size() >= 3; arguments.resize(arguments.size() - 2)) {
    const std::string& option = arguments[arguments.size() - 2];
    if (option == "--threads") {
      threads = lab::positive_number(arguments.back());
    } else if (option == "--yardstick") {
      yardstick = arguments.back();
    } else {
      break;
    }
  }
  if (arguments.size() != 1)
    throw Error("expected DATA [--yardstick FOLDER] [--threads N], or --search DATA ...");
  compare(arguments[0], yardstick, threads);
}

}  // namespace

int main(int count, char** arguments) try {
  run({arguments + 1, arguments + count});
} catch (const std::exception& error) {
  std::fprintf(stderr, "pcl_chain: %s\n", error.what());
  return 2;
}
