// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/evidence.hpp>
#include <cairn/objects/measure.hpp>
#include <cairn/objects/ranks.hpp>
#include <cairn/regions/runs.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <utility>

namespace cairn {
namespace {

constexpr int kGrain = 64;  // rows

/// What the runs of a fused region tell of it.
struct Outline {
  std::int64_t pixel_count = 0;
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

std::vector<Outline> outlines(const Inputs& in, std::vector<Run>& runs) {
  const int width = in.fusion.labels.width();
  std::vector<Outline> result(in.fusion.parts.size());
  for_each_run(in.fusion.labels, [&](const Run& run) {
    runs.push_back(run);
    Outline& outline = result[index(run.label)];
    if (outline.pixel_count == 0) outline.first_pixel = run.y * width + run.first;
    outline.pixel_count += run.length();
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
  return !disparity_region.is_floor && percent >= config.min_area && percent <= config.max_area &&
         borders_touched(outline.box, image) < 3;
}

/// The 2nd to the 98th percentile: the values of ranks ⌊(p·(n−1) + 50)/100⌋ in ascending order. Reorders
/// `values`, which are not empty.
float span_without_tails(std::vector<float>& values) {
  const auto rank = [&](std::size_t percent) { return (percent * (values.size() - 1) + 50) / 100; };
  const auto [lowest, highest] = values_at_ranks(values, rank(2), rank(98));
  return highest - lowest;
}

/// The mean of the two middle values where their number is even. Reorders `values`, which are not empty.
float median(std::vector<float>& values) {
  const std::size_t upper = values.size() / 2;
  if (values.size() % 2 == 1) return values_at_ranks(values, upper, upper).first;
  const auto [below, above] = values_at_ranks(values, upper - 1, upper);
  return (above + below) / 2;
}

/// How an object's outline looks, in steps from a pixel of it to a 4-neighbour that is not.
struct Rim {
  std::int64_t length = 0;
  std::int64_t at_edge = 0;
  std::int64_t cut = 0;
};

/// What the pixels of an object show, gathered run by run. Values are appended without a branch: holes come
/// irregularly.
class Gathered {
 public:
  Gathered(const Inputs& in, std::size_t pixels) : in_(in), disparities_(pixels + 1) {
    if (!in.rig) return;
    for (std::vector<float>& axis : points_) axis.resize(pixels + 1);
    for (std::vector<float>& axis : of_run_) axis.resize(slot(in.left.width()));
  }

  void add(const Run& run) {
    const std::array<int, 3> colour = cairn::colour_sum(in_.left, in_.left_rgb, run);
    for (std::size_t c = 0; c < 3; ++c) colour_sum_[c] += colour[c];
    const float* const disparity = in_.disparity_px.row(run.y);
    float* const room = disparities_.data() + valid_count_;
    std::size_t valid = 0;
    for (int x = run.first; x < run.last; ++x) {
      room[valid] = disparity[x];
      valid += disparity[x] == disparity[x] ? 1 : 0;  // a hole is NaN
    }
    valid_count_ += valid;
    if (in_.rig) add_points(*in_.rig, run, disparity);
    look_aside(run, run.first, run.first - 1);
    look_aside(run, run.last - 1, run.last);
    look_along(run, run.y - 1);
    look_along(run, run.y + 1);
  }

  [[nodiscard]] std::size_t valid_count() const { return valid_count_; }
  [[nodiscard]] const std::array<std::int64_t, 3>& colour_sum() const { return colour_sum_; }
  [[nodiscard]] const Rim& rim() const { return rim_; }
  struct Lists {
    std::array<std::vector<float>, 3> points;  // in the camera's frame, before infinity; one list per axis
    std::vector<float> disparities;
  };
  /// Of the valid pixels.
  [[nodiscard]] Lists lists() && {
    for (std::vector<float>& axis : points_) axis.resize(point_count_);
    disparities_.resize(valid_count_);
    return {std::move(points_), std::move(disparities_)};
  }

 private:
  /// As StereoRig::point_in_camera_m(), for a run at once.
  void add_points(const StereoRig& rig, const Run& run, const float* disparity) {
    float* const x = of_run_[0].data();
    float* const y = of_run_[1].data();
    float* const z = of_run_[2].data();
    const float row = static_cast<float>(run.y) - rig.cy_px;
    for (int i = 0; i < run.length(); ++i) {
      z[i] = rig.focal_px * rig.baseline_m / (disparity[run.first + i] + rig.doffs_px);
      x[i] = (static_cast<float>(run.first + i) - rig.cx_px) * z[i] / rig.focal_px;
      y[i] = row * z[i] / rig.focal_px;
    }
    float* const xs = points_[0].data() + point_count_;
    float* const ys = points_[1].data() + point_count_;
    float* const zs = points_[2].data() + point_count_;
    std::size_t count = 0;
    for (int i = 0; i < run.length(); ++i) {
      xs[count] = x[i];
      ys[count] = y[i];
      zs[count] = z[i];
      count += disparity[run.first + i] + rig.doffs_px > 0 ? 1 : 0;
    }
    point_count_ += count;
  }

  [[nodiscard]] bool is_edge(int x, int y, int u, int v) const {
    if (in_.left_rgb.empty()) return std::abs(in_.left(x, y) - in_.left(u, v)) > in_.edge_min;
    const Rgb p = in_.left_rgb(x, y);
    const Rgb q = in_.left_rgb(u, v);
    return std::max({std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)}) > in_.edge_min;
  }

  /// From an end of the run, x, to the pixel beside it, u.
  void look_aside(const Run& run, int x, int u) {
    ++rim_.length;
    if (u < 0 || u >= in_.left.width()) {
      ++rim_.cut;
    } else {
      rim_.at_edge += is_edge(x, run.y, u, run.y) ? 1 : 0;
    }
  }

  /// From the run to the row above or below, v.
  void look_along(const Run& run, int v) {
    if (v < 0 || v >= in_.left.height()) {
      rim_.length += run.length();
      rim_.cut += run.length();
      return;
    }
    const RegionId* const label = in_.fusion.labels.row(v);
    const RegionId here = run.label;
    int crossed = 0;
    for (int x = run.first; x < run.last; ++x) crossed += label[x] != here ? 1 : 0;
    if (crossed == 0) return;  // most are inside
    rim_.length += crossed;
    for (int x = run.first; x < run.last; ++x) {
      if (label[x] != run.label) rim_.at_edge += is_edge(x, run.y, x, v) ? 1 : 0;
    }
  }

  const Inputs& in_;
  std::vector<float> disparities_;  // one more than there can be, as each is written before it is judged
  std::array<std::vector<float>, 3> points_;
  std::array<std::vector<float>, 3> of_run_;
  std::array<std::int64_t, 3> colour_sum_{};
  std::size_t valid_count_ = 0;
  std::size_t point_count_ = 0;
  Rim rim_;
};

Rgb mean_colour(const std::array<std::int64_t, 3>& sum, std::int64_t pixels) {
  const auto mean = [&](std::size_t c) { return static_cast<std::uint8_t>((sum[c] + pixels / 2) / pixels); };
  return {mean(0), mean(1), mean(2)};
}

/// Position and extent from the coordinates of an object's points, one list per axis.
void place(Object& object, std::array<std::vector<float>, 3>& points) {
  auto& [x, y, z] = points;
  if (x.empty()) return;
  std::array<double, 3> sum{};
  // Three chains, of which each alone would wait for its additions.
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum[0] += x[i];
    sum[1] += y[i];
    sum[2] += z[i];
  }
  const auto count = static_cast<double>(x.size());
  const auto mean = [&](std::size_t axis) { return static_cast<float>(sum.at(axis) / count); };
  object.position_in_camera_m = Vec3{mean(0), mean(1), mean(2)};
  object.extent_in_camera_m = Vec3{span_without_tails(x), span_without_tails(y), span_without_tails(z)};
}

float confidence_of(const Object& object, Size image) {
  const double size = std::log(static_cast<double>(object.pixel_count) / static_cast<double>(image.area()));
  const double sum = 1.53 * size + 11.72 * object.edge_share - 4.72 * object.cut_share - 2.41;
  const double supported = std::min(2.0 * object.valid_share, 1.0);
  return static_cast<float>(supported / (1.0 + std::exp(-sum)));
}

/// nullopt where no pixel has a disparity.
std::optional<Object> measured(const Outline& outline, Gathered gathered, Size image) {
  if (gathered.valid_count() == 0) return std::nullopt;
  Object object;
  object.box_px = outline.box;
  object.pixel_count = static_cast<int>(outline.pixel_count);
  object.valid_share = static_cast<float>(gathered.valid_count()) / static_cast<float>(outline.pixel_count);
  object.mean_colour = mean_colour(gathered.colour_sum(), outline.pixel_count);
  const Rim rim = gathered.rim();
  const auto share = [&](std::int64_t part) {
    return static_cast<float>(part) / static_cast<float>(std::max<std::int64_t>(rim.length, 1));
  };
  object.edge_share = share(rim.at_edge);
  object.cut_share = share(rim.cut);
  object.confidence = confidence_of(object, image);
  Gathered::Lists lists = std::move(gathered).lists();
  place(object, lists.points);
  object.disparity_px = median(lists.disparities);
  return object;
}

/// A region that may be an object.
struct Candidate {
  std::size_t region;
  std::optional<Object> object;
};

/// Measures the candidates first … last − 1, all together in one pass over the picture: region after region
/// would fetch every row anew.
void measure_range(const Inputs& in, const std::vector<Run>& runs, const std::vector<Outline>& outline,
                   std::vector<Candidate>& candidates, int first, int last) {
  const std::span<Candidate> range = std::span(candidates).subspan(slot(first), slot(last) - slot(first));
  std::vector<Gathered> gathered;
  gathered.reserve(range.size());
  std::vector<Gathered*> of_region(outline.size(), nullptr);
  for (const Candidate& candidate : range) {
    of_region[candidate.region] =
        &gathered.emplace_back(in, static_cast<std::size_t>(outline[candidate.region].pixel_count));
  }
  for (const Run& run : runs) {
    if (Gathered* const of = of_region[index(run.label)]; of != nullptr) of->add(run);
  }
  for (std::size_t i = 0; i < range.size(); ++i) {
    range[i].object = measured(outline[range[i].region], std::move(gathered[i]), in.left.size());
  }
}

}  // namespace

Objects measure(const Fusion& fusion, const Segmentation& by_disparity, const DisparityMap& disparity,
                View<const Gray> left, View<const Rgb> left_rgb, const std::optional<StereoRig>& rig,
                const ObjectsConfig& config, const Exec& exec) {
  const auto edge_min = static_cast<int>(kEdgeMin + kEdgeNoiseFactor * noise_sigma(left));
  const Inputs in{fusion, disparity.disparity_px, left, left_rgb, rig, edge_min};
  const Size size = fusion.labels.size();
  std::vector<Run> runs;
  const std::vector<Outline> outline = outlines(in, runs);

  std::vector<Candidate> found;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Region& followed = by_disparity.regions[index(fusion.disparity_region[i])];
    if (is_object(outline[i], followed, size, config)) found.push_back({i, std::nullopt});
  }
  parallel_for(exec, static_cast<int>(found.size()), 1,
               [&](int first, int last) { measure_range(in, runs, outline, found, first, last); });
  std::erase_if(found, [&](const Candidate& candidate) {
    return !candidate.object || candidate.object->confidence < config.min_confidence;
  });
  std::sort(found.begin(), found.end(), [&](const Candidate& a, const Candidate& b) {
    if (a.object->disparity_px != b.object->disparity_px)
      return a.object->disparity_px > b.object->disparity_px;
    return outline[a.region].first_pixel < outline[b.region].first_pixel;
  });

  Objects objects{Image<ObjectId>(size, exec.pool), {}};
  std::vector<ObjectId> id_of(fusion.parts.size(), ObjectId::none);
  for (Candidate& candidate : found) {
    candidate.object->id = ObjectId{static_cast<std::int32_t>(objects.list.size()) + 1};
    id_of[candidate.region] = candidate.object->id;
    objects.list.push_back(*candidate.object);
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
