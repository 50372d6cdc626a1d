// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Objects as one would get them without us: OpenCV's semi-global matcher, the points in metres, the largest
// planes taken away by PCL's RANSAC, Euclidean clusters of the rest; beside ours, on frames with true
// objects.
//   pcl_chain [DATA]
// DATA is the folder that holds rendered/ and real/. PCL's numbers have no defaults that suit every rig, so a
// grid of them runs, and what does best on the very frames that are reported is what is shown: the
// peer is tuned to each set, `default` is not. Processor time of one thread.
#include <pcl/ModelCoefficients.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <algorithm>
#include <cairn/cairn.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <timing/clock.hpp>
#include <timing/opencv_matchers.hpp>
#include "markdown_table.hpp"
#include "scored_frames.hpp"

namespace {

using namespace cairn;
using report::percent;
using report::text_of;
using Cloud = pcl::PointCloud<pcl::PointXYZ>;

struct Settings {
  int planes;             // the largest, where they hold a tenth of the points or more
  double plane_m;         // how far from a plane its points lie
  double cluster_m;       // how far apart the points of a cluster lie
  double smallest_share;  // of the image, that a cluster covers
};

std::vector<Settings> grid() {
  std::vector<Settings> all;
  for (const int planes : {1, 3}) {
    for (const double plane_m : {0.02, 0.05}) {
      for (const double cluster_m : {0.02, 0.05}) {
        for (const double smallest : {0.002, 0.005}) all.push_back({planes, plane_m, cluster_m, smallest});
      }
    }
  }
  return all;
}

std::string text_of(const Settings& s) {
  return std::to_string(s.planes) + " planes within " + text_of("%g", s.plane_m) + " m, clusters within " +
         text_of("%g", s.cluster_m) + " m of at least " + text_of("%g", 100 * s.smallest_share) + " %";
}

struct Points {
  Cloud::Ptr cloud = std::make_shared<Cloud>();
  std::vector<Point> pixels;  // where each was seen
};

Points points_of(const Image<float>& disparity_px, const StereoRig& rig) {
  Points points;
  for (int y = 0; y < disparity_px.height(); ++y) {
    for (int x = 0; x < disparity_px.width(); ++x) {
      const float d = disparity_px(x, y);
      if (!(d > 0)) continue;
      const auto at = rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), d);
      if (!at) continue;
      points.cloud->push_back({at->x, at->y, at->z});
      points.pixels.push_back({x, y});
    }
  }
  return points;
}

/// The indices that are left when the largest planes are gone.
pcl::IndicesPtr without_planes(const Cloud::Ptr& cloud, const Settings& settings) {
  auto left = std::make_shared<pcl::Indices>(cloud->size());
  std::iota(left->begin(), left->end(), 0);
  pcl::SACSegmentation<pcl::PointXYZ> planes(false);  // the same numbers in every run
  planes.setModelType(pcl::SACMODEL_PLANE);
  planes.setMethodType(pcl::SAC_RANSAC);
  planes.setDistanceThreshold(settings.plane_m);
  planes.setMaxIterations(200);
  planes.setInputCloud(cloud);
  for (int i = 0; i < settings.planes && left->size() > 3; ++i) {
    planes.setIndices(left);
    pcl::PointIndices inliers;
    pcl::ModelCoefficients plane;
    planes.segment(inliers, plane);
    if (inliers.indices.size() * 10 < cloud->size()) break;
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
  extraction.setMinClusterSize(static_cast<int>(settings.smallest_share * size.width * size.height));
  extraction.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  extraction.setInputCloud(points.cloud);
  extraction.setIndices(left);
  std::vector<pcl::PointIndices> found;
  extraction.extract(found);
  int id = 0;
  for (const pcl::PointIndices& cluster : found) {
    ++id;
    for (const int point : cluster.indices) {
      const Point at = points.pixels[static_cast<std::size_t>(point)];
      labels(at.x, at.y) = ObjectId{id};
    }
  }
  return labels;
}

std::vector<report::Score> score_all(const std::vector<report::TrueFrame>& frames, const Settings& settings,
                                     int threads) {
  std::vector<report::Score> scores(frames.size());
  for_each_index(frames.size(), threads, [&](std::size_t i, const Exec&) {
    const report::TrueFrame& frame = frames[i];
    const StereoPair pair = StereoPair::from(frame.pictures.left.gray, frame.pictures.right.gray);
    const auto matcher =
        report::accurate_opencv_matchers()[1].prepare({.num_disparities = frame.num_disparities});
    const double start = report::now_ms(CLOCK_THREAD_CPUTIME_ID);
    matcher.compute(pair);
    const Points points = points_of(matcher.disparity_px(), *frame.rig);
    const Image<ObjectId> labels = clusters(points, pair.size(), settings);
    scores[i].milliseconds = report::now_ms(CLOCK_THREAD_CPUTIME_ID) - start;
    scores[i].objects = {object_errors(labels, frame.objects, {}), frame.partial};
  });
  return scores;
}

ObjectSummary summary_of(const std::vector<report::Score>& scores) {
  std::vector<FrameObjects> objects;
  for (const report::Score& score : scores) objects.push_back(score.objects);
  return summarise(objects);
}

void add_row(report::MarkdownTable& table, const std::string& name,
             const std::vector<report::Score>& scores) {
  const ObjectSummary sum = summary_of(scores);
  std::vector<double> times;
  for (const report::Score& score : scores) times.push_back(score.milliseconds);
  table.add({name, percent(sum.recall_50()), percent(sum.recall_75()), percent(sum.precision_50()),
             percent(sum.median_error), text_of("%.2f", sum.phantoms_per_frame()),
             text_of("%.0f", median(times))});
}

void compare(const std::filesystem::path& data) {
  report::set_opencv_threads(1);
  const int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  for (const char* folder : {"rendered/dev/320x240", "rendered/dev/640x480", "real/rc_tabletop"}) {
    const std::vector<report::TrueFrame> frames = report::load_true_frames(data / folder);
    std::vector<report::Score> best;
    Settings best_settings{};
    for (const Settings& settings : grid()) {
      std::vector<report::Score> scores = score_all(frames, settings, threads);
      // Of found and precision the harmonic mean: either alone is had for nothing.
      const auto key = [](const ObjectSummary& sum) {
        return 2.0 * sum.found_50 / std::max(1, sum.true_objects + sum.our_objects);
      };
      if (best.empty() || key(summary_of(scores)) > key(summary_of(best))) {
        best = std::move(scores);
        best_settings = settings;
      }
    }
    report::MarkdownTable table(
        {"", "found 0.5, %", "found 0.75, %", "precision, %", "median E, %", "phantoms", "ms"});
    add_row(table, "StereoSGBM and PCL", best);
    add_row(table, "cairn, `paper`", report::score_all(frames, Config::paper(), false, threads));
    add_row(table, "cairn, `default`", report::score_all(frames, Config{}, false, threads));
    std::printf("### %s\n\n%s\nPCL: %s.\n\n", folder, table.text().c_str(), text_of(best_settings).c_str());
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  compare(argc > 1 ? argv[1] : "../shared/data");
} catch (const cairn::Error& error) {
  std::fprintf(stderr, "pcl_chain: %s\n", error.what());
  return 2;
}
