// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/evidence.hpp>
#include <cairn/objects/measure.hpp>
#include <cairn/regions/runs.hpp>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace cairn {
namespace {

constexpr int kGrain = 64;  // rows

/// What one look at every pixel tells of a fused region.
struct Outline {
  std::int64_t pixel_count = 0;
  std::int64_t valid_count = 0;
  std::array<std::int64_t, 3> colour_sum{};
  int first_pixel = 0;
  Rect box;
};

struct Inputs {
  const Fusion& fusion;
  const Image<float>& disparity_px;
  View<const Gray> left;
  View<const Rgb> left_rgb;
  const std::optional<StereoRig>& rig;
  int edge_min;  // grey levels: what differs by more across an outline is an edge
};

constexpr float kEdgeMin = 4.0F;          // grey levels …
constexpr float kEdgeNoiseFactor = 3.0F;  // … plus deviations of the image noise

std::vector<Outline> outlines(const Inputs& in) {
  const int width = in.fusion.labels.width();
  std::vector<Outline> result(in.fusion.parts.size());
  for_each_run(in.fusion.labels, [&](const Run& run) {
    const float* const disparity = in.disparity_px.row(run.y);
    int valid = 0;
    for (int x = run.first; x < run.last; ++x)
      valid += disparity[x] == disparity[x] ? 1 : 0;  // a hole is NaN
    const std::array<int, 3> colour = colour_sum(in.left, in.left_rgb, run);
    Outline& outline = result[index(run.label)];
    if (outline.pixel_count == 0) outline.first_pixel = run.y * width + run.first;
    outline.pixel_count += run.length();
    outline.valid_count += valid;
    for (std::size_t c = 0; c < 3; ++c) outline.colour_sum[c] += colour[c];
    outline.box = united(outline.box, run.box());
  });
  return result;
}

int borders_touched(Rect box, Size image) {
  return (box.x == 0 ? 1 : 0) + (box.y == 0 ? 1 : 0) + (box.x + box.width == image.width ? 1 : 0) +
         (box.y + box.height == image.height ? 1 : 0);
}

bool is_object(const Outline& outline, const Region& disparity_region, Size image,
               const ObjectsConfig& config) {
  const double percent = 100.0 * static_cast<double>(outline.pixel_count) / static_cast<double>(image.area());
  return !disparity_region.is_floor && outline.valid_count > 0 && percent >= config.min_area &&
         percent <= config.max_area && borders_touched(outline.box, image) < 3;
}

/// The 2nd to the 98th percentile: the values of ranks ⌊(p·(n−1) + 50)/100⌋ in ascending order. Reorders
/// `values`, which are not empty.
float span_without_tails(std::vector<float>& values) {
  const auto rank = [&](std::size_t percent) {
    return values.begin() + static_cast<std::ptrdiff_t>((percent * (values.size() - 1) + 50) / 100);
  };
  const auto low = rank(2);
  const auto high = rank(98);
  std::nth_element(values.begin(), low, values.end());
  const float lowest = *low;
  std::nth_element(low, high, values.end());  // what is not below it keeps its ranks
  return *high - lowest;
}

/// The mean of the two middle values where their number is even. Reorders `values`, which are not empty.
float median(std::vector<float>& values) {
  const auto upper = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), upper, values.end());
  if (values.size() % 2 == 1) return *upper;
  return (*upper + *std::max_element(values.begin(), upper)) / 2;
}

Rgb mean_colour(const Outline& outline) {
  const auto mean = [&](std::size_t c) {
    return static_cast<std::uint8_t>((outline.colour_sum[c] + outline.pixel_count / 2) / outline.pixel_count);
  };
  return {mean(0), mean(1), mean(2)};
}

/// Position and extent from the coordinates of an object's points, one list per axis.
void place(Object& object, std::array<std::vector<float>, 3>& points) {
  if (points[0].empty()) return;
  std::array<float, 3> mean{};
  std::array<float, 3> span{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<float>& values = points[axis];
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    mean[axis] = static_cast<float>(sum / static_cast<double>(values.size()));
    span[axis] = span_without_tails(values);
  }
  object.position_in_camera_m = Vec3{mean[0], mean[1], mean[2]};
  object.extent_in_camera_m = Vec3{span[0], span[1], span[2]};
}

/// How an object's outline looks, in steps from a pixel of it to a 4-neighbour that is not.
struct Rim {
  std::int64_t length = 0;
  std::int64_t at_edge = 0;
  std::int64_t cut = 0;
};

Rim rim(const Inputs& in, RegionId region, Rect box) {
  const View<const RegionId> labels = in.fusion.labels;
  const auto step = [&](int x, int y, int u, int v) {
    if (in.left_rgb.empty()) return std::abs(in.left(x, y) - in.left(u, v));
    const Rgb p = in.left_rgb(x, y);
    const Rgb q = in.left_rgb(u, v);
    return std::max({std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)});
  };
  Rim result;
  const auto look = [&](int x, int y, int u, int v) {
    if (!labels.contains(u, v)) {
      ++result.length;
      ++result.cut;
    } else if (labels(u, v) != region) {
      ++result.length;
      result.at_edge += step(x, y, u, v) > in.edge_min ? 1 : 0;
    }
  };
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (labels(x, y) != region) continue;
      look(x, y, x - 1, y);
      look(x, y, x + 1, y);
      look(x, y, x, y - 1);
      look(x, y, x, y + 1);
    }
  }
  return result;
}

float confidence_of(const Object& object, Size image) {
  const double size = std::log(static_cast<double>(object.pixel_count) / static_cast<double>(image.area()));
  const double sum = 1.53 * size + 11.72 * object.edge_share - 4.72 * object.cut_share - 2.41;
  const double supported = std::min(2.0 * object.valid_share, 1.0);
  return static_cast<float>(supported / (1.0 + std::exp(-sum)));
}

Object measured(const Inputs& in, RegionId region, const Outline& outline) {
  std::vector<float> disparities;
  disparities.reserve(static_cast<std::size_t>(outline.valid_count));
  std::array<std::vector<float>, 3> points;
  for (std::vector<float>& axis : points) axis.reserve(in.rig ? disparities.capacity() : 0);
  const Rect box = outline.box;
  for (int y = box.y; y < box.y + box.height; ++y) {
    const RegionId* const label = in.fusion.labels.row(y);
    const float* const disparity = in.disparity_px.row(y);
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (label[x] != region || disparity[x] != disparity[x]) continue;
      disparities.push_back(disparity[x]);
      if (!in.rig) continue;
      const auto point =
          in.rig->point_in_camera_m(static_cast<float>(x), static_cast<float>(y), disparity[x]);
      if (!point) continue;
      points[0].push_back(point->x);
      points[1].push_back(point->y);
      points[2].push_back(point->z);
    }
  }
  Object object;
  object.box_px = box;
  object.pixel_count = static_cast<int>(outline.pixel_count);
  object.disparity_px = median(disparities);
  object.valid_share = static_cast<float>(outline.valid_count) / static_cast<float>(outline.pixel_count);
  object.mean_colour = mean_colour(outline);
  place(object, points);
  const Rim outer = rim(in, region, box);
  const auto share = [&](std::int64_t part) {
    return static_cast<float>(part) / static_cast<float>(std::max<std::int64_t>(outer.length, 1));
  };
  object.edge_share = share(outer.at_edge);
  object.cut_share = share(outer.cut);
  object.confidence = confidence_of(object, in.left.size());
  return object;
}

}  // namespace

Objects measure(const Fusion& fusion, const Segmentation& by_disparity, const DisparityMap& disparity,
                View<const Gray> left, View<const Rgb> left_rgb, const std::optional<StereoRig>& rig,
                const ObjectsConfig& config, const Exec& exec) {
  const auto edge_min = static_cast<int>(kEdgeMin + kEdgeNoiseFactor * noise_sigma(left));
  const Inputs in{fusion, disparity.disparity_px, left, left_rgb, rig, edge_min};
  const Size size = fusion.labels.size();
  const std::vector<Outline> outline = outlines(in);

  struct Found {
    std::size_t region;
    Object object;
  };
  std::vector<Found> found;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Region& followed = by_disparity.regions[index(fusion.disparity_region[i])];
    if (is_object(outline[i], followed, size, config)) found.push_back({i, {}});
  }
  parallel_for(exec, static_cast<int>(found.size()), 1, [&](int first, int last) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      const std::size_t region = found[i].region;
      found[i].object = measured(in, RegionId{static_cast<std::int32_t>(region)}, outline[region]);
    }
  });
  std::erase_if(found, [&](const Found& f) { return f.object.confidence < config.min_confidence; });
  std::sort(found.begin(), found.end(), [&](const Found& a, const Found& b) {
    if (a.object.disparity_px != b.object.disparity_px) return a.object.disparity_px > b.object.disparity_px;
    return outline[a.region].first_pixel < outline[b.region].first_pixel;
  });

  Objects objects{Image<ObjectId>(size, exec.pool), {}};
  std::vector<ObjectId> id_of(fusion.parts.size(), ObjectId::none);
  for (Found& f : found) {
    f.object.id = ObjectId{static_cast<std::int32_t>(objects.list.size()) + 1};
    id_of[f.region] = f.object.id;
    objects.list.push_back(f.object);
  }
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const RegionId* const in_row = fusion.labels.row(y);
      ObjectId* const out = objects.labels.row(y);
      for (int x = 0; x < size.width; ++x) out[x] = id_of[index(in_row[x])];
    }
  });
  return objects;
}

}  // namespace cairn
