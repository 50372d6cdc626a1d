// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/image.hpp>
#include <cairn/core/statistics.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cassert>
#include <cmath>
#include <map>
#include <utility>

namespace cairn {
namespace {

constexpr double kPhantomShare = 0.25;

/// Pixel counts of each true object, each of ours, and each pair.
struct Overlaps {
  std::map<TruthId, int> truth;
  std::map<ObjectId, int> ours;
  std::map<ObjectId, int> ours_on_dont_care;
  std::map<std::pair<TruthId, ObjectId>, int> both;

  [[nodiscard]] double iou(TruthId t, ObjectId o) const {
    const auto found = both.find({t, o});
    if (found == both.end()) return 0;
    return found->second / static_cast<double>(truth.at(t) + ours.at(o) - found->second);
  }
  [[nodiscard]] int common(TruthId t, ObjectId o) const {
    const auto found = both.find({t, o});
    return found == both.end() ? 0 : found->second;
  }
};

Overlaps count_overlaps(View<const ObjectId> ours, View<const TruthId> truth) {
  Overlaps count;
  const auto add = [&count](TruthId t, ObjectId o, int pixels) {
    if (o != ObjectId::none) count.ours[o];  // listed even if all of its pixels are don't-care
    if (t == TruthId::dont_care) {
      if (o != ObjectId::none) count.ours_on_dont_care[o] += pixels;
      return;
    }
    if (t != TruthId::none) count.truth[t] += pixels;
    if (o != ObjectId::none) count.ours[o] += pixels;
    if (t != TruthId::none && o != ObjectId::none) count.both[{t, o}] += pixels;
  };
  for (int y = 0; y < ours.height(); ++y) {
    int run_start = 0;
    for (int x = 1; x <= ours.width(); ++x) {
      const bool ends =
          x == ours.width() || ours(x, y) != ours(run_start, y) || truth(x, y) != truth(run_start, y);
      if (!ends) continue;
      add(truth(run_start, y), ours(run_start, y), x - run_start);
      run_start = x;
    }
  }
  return count;
}

/// Over-segmentation as defined by Hoover et al., "An experimental comparison of range image segmentation
/// algorithms", 1996, with a threshold of one half.
bool is_over_segmented(TruthId t, const Overlaps& count) {
  int parts = 0;
  int covered = 0;
  for (const auto& [o, area] : count.ours) {
    const int common = count.common(t, o);
    if (2 * common <= area) continue;
    ++parts;
    covered += common;
  }
  return parts >= 2 && 2 * covered > count.truth.at(t);
}

bool is_under_segmented(TruthId t, const Overlaps& count, int min_area) {
  const auto holds = [&count](ObjectId o, TruthId id) {
    return 2 * count.common(id, o) > count.truth.at(id);
  };
  for (const auto& [o, area] : count.ours) {
    if (!holds(o, t)) continue;
    const auto also_held = [&, ours = o](const auto& other) {
      return other.first != t && other.second >= min_area && holds(ours, other.first);
    };
    return std::any_of(count.truth.begin(), count.truth.end(),
                       also_held);  // only one can hold more than half
  }
  return false;
}

TrueObjectScore score_true_object(TruthId t, const Overlaps& count, int min_area) {
  TrueObjectScore score;
  score.id = t;
  score.pixel_count = count.truth.at(t);
  for (const auto& [o, area] : count.ours) {
    const double iou = count.iou(t, o);
    if (iou > score.iou) {
      score.iou = iou;
      score.found = o;
    }
  }
  score.over_segmented = is_over_segmented(t, count);
  score.under_segmented = is_under_segmented(t, count, min_area);
  return score;
}

FoundObjectScore score_found_object(ObjectId o, const Overlaps& count, int min_area) {
  FoundObjectScore score;
  score.id = o;
  score.pixel_count = count.ours.at(o);
  int on_objects = 0;
  for (const auto& [t, area] : count.truth) {
    on_objects += count.common(t, o);
    const double iou = count.iou(t, o);
    if (iou > score.iou) {
      score.iou = iou;
      score.best = t;
    }
  }
  const auto dont_care = count.ours_on_dont_care.find(o);
  score.mostly_dont_care =
      dont_care != count.ours_on_dont_care.end() && dont_care->second > score.pixel_count;
  score.share_on_objects = score.pixel_count > 0 ? on_objects / static_cast<double>(score.pixel_count) : 0;
  score.phantom =
      !score.mostly_dont_care && score.pixel_count >= min_area && score.share_on_objects < kPhantomShare;
  return score;
}

std::vector<Point> boundary(View<const std::uint8_t> mask, View<const std::uint8_t> ignored) {
  const auto outside = [&](int x, int y) {
    return mask.contains(x, y) && mask(x, y) == 0 && (ignored.empty() || ignored(x, y) == 0);
  };
  std::vector<Point> points;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (mask(x, y) == 0 || (!ignored.empty() && ignored(x, y) != 0)) continue;
      if (outside(x - 1, y) || outside(x + 1, y) || outside(x, y - 1) || outside(x, y + 1))
        points.push_back({x, y});
    }
  }
  return points;
}

/// The share of `points` within `tolerance_px` of any of `others`.
double share_near(const std::vector<Point>& points, const std::vector<Point>& others, Size size,
                  int tolerance_px) {
  Image<std::uint8_t> near(size, 0, {});
  for (const Point& p : others) {
    for (int dy = -tolerance_px; dy <= tolerance_px; ++dy) {
      const int y = p.y + dy;
      if (y < 0 || y >= size.height) continue;
      const int dx = static_cast<int>(std::sqrt(static_cast<double>(tolerance_px * tolerance_px - dy * dy)));
      const int first = std::max(0, p.x - dx);
      const int last = std::min(size.width - 1, p.x + dx);
      std::fill_n(near.row(y) + first, last - first + 1, std::uint8_t{1});
    }
  }
  const auto hits = std::count_if(points.begin(), points.end(), [&](Point p) { return near(p.x, p.y) != 0; });
  return static_cast<double>(hits) / static_cast<double>(points.size());
}

template <class T, class Predicate>
Image<std::uint8_t> mask_where(View<const T> labels, Predicate inside) {
  Image<std::uint8_t> mask(labels.size());
  for (int y = 0; y < labels.height(); ++y) {
    std::transform(labels.row(y), labels.row(y) + labels.width(), mask.row(y),
                   [&](T label) { return static_cast<std::uint8_t>(inside(label) ? 1 : 0); });
  }
  return mask;
}

}  // namespace

double boundary_f(View<const std::uint8_t> a, View<const std::uint8_t> b, View<const std::uint8_t> ignored,
                  int tolerance_px) {
  const std::vector<Point> of_a = boundary(a, ignored);
  const std::vector<Point> of_b = boundary(b, ignored);
  if (of_a.empty() && of_b.empty()) return 1;
  if (of_a.empty() || of_b.empty()) return 0;
  const double precision = share_near(of_b, of_a, a.size(), tolerance_px);
  const double recall = share_near(of_a, of_b, a.size(), tolerance_px);
  return precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0;
}

ObjectErrors object_errors(View<const ObjectId> ours, View<const TruthId> truth,
                           const ObjectErrorConfig& config) {
  assert(ours.size() == truth.size());
  const Overlaps count = count_overlaps(ours, truth);
  const double diagonal = std::hypot(ours.width(), ours.height());
  ObjectErrors errors;
  errors.boundary_tolerance_px = std::max(
      1, static_cast<int>(std::lround(diagonal * static_cast<double>(config.boundary_tolerance) / 100)));

  const Image<std::uint8_t> ignored = mask_where(truth, [](TruthId id) { return id == TruthId::dont_care; });
  for (const auto& [t, area] : count.truth) {
    if (area < config.min_area) continue;
    TrueObjectScore score = score_true_object(t, count, config.min_area);
    if (score.found != ObjectId::none) {
      const Image<std::uint8_t> theirs = mask_where(truth, [id = t](TruthId label) { return label == id; });
      const Image<std::uint8_t> found =
          mask_where(ours, [&](ObjectId label) { return label == score.found; });
      score.boundary_f = boundary_f(theirs, found, ignored, errors.boundary_tolerance_px);
    }
    errors.truth.push_back(score);
  }
  for (const auto& [o, area] : count.ours)
    errors.ours.push_back(score_found_object(o, count, config.min_area));
  return errors;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

ObjectSummary summarise(const std::vector<FrameObjects>& frames) {
  ObjectSummary sum;
  std::vector<double> errors;
  std::vector<double> ious;
  std::vector<double> fs;
  std::vector<double> fs_found;
  for (const FrameObjects& frame : frames) {
    ++sum.frames;
    for (const TrueObjectScore& score : frame.errors.truth) {
      ++sum.true_objects;
      sum.found_50 += score.iou >= 0.5 ? 1 : 0;
      sum.found_75 += score.iou >= 0.75 ? 1 : 0;
      sum.missed += score.error() >= kErrorCap ? 1 : 0;
      sum.over_segmented += score.over_segmented ? 1 : 0;
      sum.under_segmented += score.under_segmented ? 1 : 0;
      errors.push_back(score.capped_error());
      ious.push_back(score.iou);
      fs.push_back(score.boundary_f);
      if (score.iou >= 0.5) fs_found.push_back(score.boundary_f);
    }
    if (frame.partial) continue;
    ++sum.complete_frames;
    for (const FoundObjectScore& score : frame.errors.ours) {
      if (score.mostly_dont_care) continue;
      ++sum.our_objects;
      sum.right_50 += score.iou >= 0.5 ? 1 : 0;
      sum.right_75 += score.iou >= 0.75 ? 1 : 0;
      sum.phantoms += score.phantom ? 1 : 0;
    }
  }
  sum.mean_error = mean(errors);
  sum.median_error = median(errors);
  sum.mean_iou = mean(ious);
  sum.mean_boundary_f = mean(fs);
  sum.mean_boundary_f_found = mean(fs_found);
  return sum;
}

double ObjectSummary::recall_50() const {
  return share(found_50, true_objects);
}
double ObjectSummary::recall_75() const {
  return share(found_75, true_objects);
}
double ObjectSummary::precision_50() const {
  return share(right_50, our_objects);
}
double ObjectSummary::precision_75() const {
  return share(right_75, our_objects);
}
double ObjectSummary::phantoms_per_frame() const {
  return share(phantoms, complete_frames);
}

}  // namespace cairn
