// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/core/statistics.hpp>
#include <cairn/fitted/fitted.hpp>
#include <cairn/objects/floor_probability.hpp>
#include <cairn/objects/obstacle_rows.hpp>
#include <cairn/regions/object_hints.hpp>
#include <cairn/regions/region_features.hpp>
#include <cmath>
#include <limits>
#include <mutex>

namespace cairn {
namespace {

constexpr int kGrain = 64;  // rows
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
using kernels::HeightsOut;

constexpr std::array<std::string_view, kFloorFeatures> kNames{
    "kind",
    "matched: in front of the floor, px",
    "matched: confidence",
    "refined: in front of the floor, px",
    "refined: confidence",
    "refined: on the floor, share",
    "hints: object",
    "hints: outline",
    "superpixel: share of the image",
    "disparity of the floor, share of its nearest",
    "height in the image",
    "height above the floor, share of the camera's",
    "superpixel: matched, share",
    "superpixel: matched on the floor, share",
    "superpixel: matched in front of the floor, share",
    "superpixel: refined on the floor, by confidence",
    "superpixel: refined in front of the floor, by confidence",
    "superpixel: hints: object"};

/// Sums over pixels. Integers, so that their order does not matter.
struct FloorSums {
  struct Disparities {
    std::int64_t known = 0, height = 0, confidence = 0;
    std::int64_t on = 0, front = 0;            // within the margin of the floor, nearer
    std::int64_t sure_on = 0, sure_front = 0;  // their confidences
    void add(std::int32_t steps, std::int32_t marks) {
      const std::int32_t sure = marks & HeightsOut::kSure;
      const bool is_on = (marks & HeightsOut::kOn) != 0;
      const bool is_front = (marks & HeightsOut::kFront) != 0;
      known += (marks & HeightsOut::kKnown) != 0 ? 1 : 0, height += steps, confidence += sure;
      on += is_on ? 1 : 0, front += is_front ? 1 : 0;
      sure_on += is_on ? sure : 0, sure_front += is_front ? sure : 0;
    }
    void add(const Disparities& other) {
      known += other.known, height += other.height, confidence += other.confidence;
      on += other.on, front += other.front;
      sure_on += other.sure_on, sure_front += other.sure_front;
    }
  };
  std::int64_t pixels = 0, x = 0, y = 0;
  std::int64_t object = 0, outline = 0;  // hints, in their units
  Disparities matched, refined;
  void add(const FloorSums& other) {
    pixels += other.pixels, x += other.x, y += other.y;
    object += other.object, outline += other.outline;
    matched.add(other.matched), refined.add(other.refined);
  }
};

class FloorGrouping {
 public:
  FloorGrouping(const ObstacleCues& cues, View<const ObjectHint> hints, const std::optional<StereoRig>& rig,
                const GroundConfig& config, const Exec& exec)
      : cues_(cues),
        hints_(hints),
        rig_(rig),
        infinity_px_(rig ? -rig->doffs_px : 0),
        floor_(cues.ground.plane.value_or(GroundPlane{})),
        margin_(config.margin),
        exec_(exec),
        size_(cues.superpixels.size()),
        surface_px_(cues.surface_disparity_px.empty() ? cues.disparity.disparity_px.view()
                                                      : cues.surface_disparity_px),
        kinds_(size_, FloorKind::not_judged, exec.pool),
        column_(slot(size_.width)) {
    for (int x = 0; x < size_.width; ++x) column_[slot(x)] = x * hints.width() / size_.width;
    for (const int x : {0, size_.width - 1}) {
      for (const int y : {0, size_.height - 1}) {
        const float at = floor_.disparity_px(static_cast<float>(x), static_cast<float>(y));
        nearest_px_ = std::max(nearest_px_, at - infinity_px_);
      }
    }
  }

  FloorGroups run() && {
    if (!cues_.ground.plane) return {std::move(kinds_), {}, {}};
    std::mutex lock;
    parallel_for(exec_, size_.height, kGrain, [&](int first, int last) {
      BackgroundRow behind(cues_, rig_, exec_);
      SeenRow seen(cues_, exec_);
      std::size_t lowest = std::numeric_limits<std::size_t>::max();  // superpixel
      std::size_t highest = 0;
      for (int y = first; y < last; ++y) {
        behind.look_at(y);
        seen.look_at(y);
        kernels::obstacle_kernels(exec_).mark_kinds(
            {cues_.objects.row(y), cues_.disparity.reject.row(y), seen.surface_px(), behind.free_floor_px()},
            margin_, size_.width, kinds_.row(y));
        const RegionId* const superpixel = cues_.superpixels.row(y);
        const auto [low, high] = std::minmax_element(superpixel, superpixel + size_.width);
        lowest = std::min(lowest, index(*low));
        highest = std::max(highest, index(*high));
      }
      std::vector<FloorSums> sums(kFloorKinds * (highest + 1 - lowest));
      RowSteps steps(size_.width);
      for (int y = first; y < last; ++y) sum_up(y, lowest, steps, sums);
      const std::lock_guard guard(lock);
      if (sums_.size() < kFloorKinds * (highest + 1)) sums_.resize(kFloorKinds * (highest + 1));
      for (std::size_t i = 0; i < sums.size(); ++i) sums_[kFloorKinds * lowest + i].add(sums[i]);
    });
    FloorGroups groups{std::move(kinds_), std::vector<std::int64_t>(sums_.size()),
                       std::vector<FloorFeatures>(sums_.size())};
    for (std::size_t first = 0; first < sums_.size(); first += kFloorKinds) {
      FloorSums superpixel;
      for (std::size_t k = 0; k < kFloorKinds; ++k) superpixel.add(sums_[first + k]);
      for (std::size_t k = 0; k < kFloorKinds; ++k) {
        groups.pixels[first + k] = sums_[first + k].pixels;
        if (FloorKind{static_cast<std::uint8_t>(k)} != FloorKind::not_judged && sums_[first + k].pixels > 0)
          groups.features[first + k] = features_of(static_cast<float>(k), sums_[first + k], superpixel);
      }
    }
    return groups;
  }

 private:
  /// Of one row, relative to the floor.
  struct RowSteps {
    explicit RowSteps(int width)
        : trusted(slot(width), 1.0F),
          matched_height(slot(width)),
          matched_marks(slot(width)),
          refined_height(slot(width)),
          refined_marks(slot(width)) {}
    std::vector<float> trusted;  // all of it
    std::vector<std::int32_t> matched_height, matched_marks, refined_height, refined_marks;
  };

  /// Every second pixel, as on a chequerboard.
  void sum_up(int y, std::size_t first_superpixel, RowSteps& row, std::vector<FloorSums>& sums) const {
    const auto steps = kernels::obstacle_kernels(exec_).in_steps_from_floor;
    const float* const sure = cues_.confidence.empty() ? row.trusted.data() : cues_.confidence.row(y);
    steps(surface_px_.row(y), sure, y, floor_, margin_, size_.width,
          {row.matched_height.data(), row.matched_marks.data()});
    steps(cues_.refined_px.row(y), cues_.refined_confidence.row(y), y, floor_, margin_, size_.width,
          {row.refined_height.data(), row.refined_marks.data()});
    const RegionId* const superpixel = cues_.superpixels.row(y);
    const FloorKind* const kinds = kinds_.row(y);
    const ObjectHint* const hint = hints_.empty() ? nullptr : hints_.row(y * hints_.height() / size_.height);
    for (int x = y % 2; x < size_.width;) {
      FloorSums run;  // of pixels of one group
      const std::size_t group = FloorGroups::group(superpixel[x], kinds[x]);
      for (; x < size_.width && FloorGroups::group(superpixel[x], kinds[x]) == group; x += 2) {
        ++run.pixels;
        run.x += x;
        if (hint != nullptr) {
          const ObjectHint& at = hint[column_[slot(x)]];
          run.object += at.object, run.outline += at.outline;
        }
        run.matched.add(row.matched_height[slot(x)], row.matched_marks[slot(x)]);
        run.refined.add(row.refined_height[slot(x)], row.refined_marks[slot(x)]);
      }
      run.y = run.pixels * y;
      sums[group - kFloorKinds * first_superpixel].add(run);
    }
  }

  [[nodiscard]] FloorFeatures features_of(float kind, const FloorSums& group,
                                          const FloorSums& superpixel) const {
    const auto mean = [](std::int64_t sum, std::int64_t n, double steps) {
      return n > 0 ? static_cast<double>(sum) / static_cast<double>(n) / steps : double{kUnknown};
    };
    const auto height = [&](const FloorSums::Disparities& of) {
      return of.known > 0 ? mean(of.height, of.known, HeightsOut::kSteps) + double{HeightsOut::kLowest}
                          : double{kUnknown};
    };
    const auto n = static_cast<double>(group.pixels);
    const auto x = static_cast<float>(static_cast<double>(group.x) / n);
    const auto y = static_cast<float>(static_cast<double>(group.y) / n);
    const float floor_px = floor_.disparity_px(x, y) - infinity_px_;
    const double above = height(group.refined);
    const bool is_known = group.refined.known > 0;
    const double of_camera = std::clamp(above / std::max(0.5, double{floor_px}), -1.0, 3.0);
    const auto hint = [&](std::int64_t sum, std::int64_t pixels) {
      return mean(sum, hints_.empty() ? 0 : pixels, 16);
    };
    const std::array values{double{kind},
                            height(group.matched),
                            mean(group.matched.confidence, group.matched.known, HeightsOut::kSureSteps),
                            above,
                            mean(group.refined.confidence, group.pixels, HeightsOut::kSureSteps),
                            mean(group.refined.on, group.pixels, 1),
                            hint(group.object, group.pixels),
                            hint(group.outline, group.pixels),
                            2 * static_cast<double>(superpixel.pixels) / static_cast<double>(size_.area()),
                            double{floor_px / nearest_px_},
                            double{y} / size_.height,
                            is_known ? of_camera : double{kUnknown},
                            mean(superpixel.matched.known, superpixel.pixels, 1),
                            mean(superpixel.matched.on, superpixel.pixels, 1),
                            mean(superpixel.matched.front, superpixel.pixels, 1),
                            mean(superpixel.refined.sure_on, superpixel.pixels, HeightsOut::kSureSteps),
                            mean(superpixel.refined.sure_front, superpixel.pixels, HeightsOut::kSureSteps),
                            hint(superpixel.object, superpixel.pixels)};
    FloorFeatures features{};
    std::transform(values.begin(), values.end(), features.begin(),
                   [](double v) { return static_cast<float>(v); });
    return features;
  }

  const ObstacleCues& cues_;
  View<const ObjectHint> hints_;
  const std::optional<StereoRig>& rig_;
  float infinity_px_;
  GroundPlane floor_;
  float margin_;
  const Exec& exec_;
  Size size_;
  View<const float> surface_px_;
  Image<FloorKind> kinds_;
  float nearest_px_ = 1;         // of the floor in the image, from infinity
  std::vector<int> column_;      // of the hints
  std::vector<FloorSums> sums_;  // of each group
};

}  // namespace

std::array<std::string_view, kFloorFeatures> floor_feature_names() {
  return kNames;
}

FloorGroups group_by_floor(const ObstacleCues& cues, View<const ObjectHint> hints,
                           const std::optional<StereoRig>& rig, const GroundConfig& config,
                           const Exec& exec) {
  return FloorGrouping(cues, hints, rig, config, exec).run();
}

Image<float> floor_probability(const FloorGroups& groups, View<const RegionId> superpixels,
                               const FittedTrees& shows_floor, const Exec& exec) {
  std::vector<std::span<const float>> samples;
  std::vector<std::size_t> judged;
  for (std::size_t i = 0; i < groups.pixels.size(); ++i) {
    if (groups.pixels[i] == 0 || i % kFloorKinds == static_cast<std::size_t>(FloorKind::not_judged)) continue;
    judged.push_back(i);
    samples.emplace_back(groups.features[i]);
  }
  std::vector<float> likely(groups.pixels.size(), kNan);
  const std::vector<float> log_odds = shows_floor(samples, exec);
  for (std::size_t i = 0; i < judged.size(); ++i) likely[judged[i]] = likelihood(log_odds[i]);
  Image<float> probability(superpixels.size(), exec.pool);
  parallel_for(exec, probability.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const RegionId* const superpixel = superpixels.row(y);
      const FloorKind* const kind = groups.kinds.row(y);
      float* const out = probability.row(y);
      for (int x = 0; x < probability.width(); ++x)
        out[x] = likely.empty() ? kNan : likely[FloorGroups::group(superpixel[x], kind[x])];
    }
  });
  return probability;
}

const FittedTrees& floor_classifier() {
  static const FittedTrees trees = load_trees(fitted::shows_floor());
  return trees;
}

}  // namespace cairn
