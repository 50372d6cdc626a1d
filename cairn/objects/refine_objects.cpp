// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/objects/object_match.hpp>
#include <cairn/objects/refine_objects.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 64;         // rows
constexpr double kDoubt = 0.08;    // px; also DOUBT of lab/fit.py
constexpr double kMaxBias = 1;     // px; also MOST_CORRECTION there
constexpr double kMaxShare = 0.5;  // of the disparity: a distant object stays in front of the camera

/// Predictions are uncertain, and most disparities are right, so each is reduced by kDoubt.
double beyond_doubt(double bias) {
  return std::copysign(std::clamp(std::abs(bias) - kDoubt, 0.0, kMaxBias), bias);
}

/// Pixels of a row whose neighbours up to kOutline on both sides belong to the same object and have a disparity; of
/// every row_step()-th row of an object.
std::vector<std::vector<Stretch>> interiors(const Objects& objects, View<const float> disparity_px) {
  std::vector<std::vector<Stretch>> of(objects.list.size());
  std::vector<int> steps;
  for (const Object& object : objects.list) steps.push_back(row_step(object.pixel_count));
  const int width = disparity_px.width();
  for (int y = 0; y < disparity_px.height(); ++y) {
    const ObjectId* const id = objects.labels.row(y);
    const float* const d = disparity_px.row(y);
    for (int x = 0; x < width;) {
      const int begin = x++;
      if (id[begin] == ObjectId::none || std::isnan(d[begin])) continue;
      while (x < width && id[x] == id[begin] && !std::isnan(d[x])) ++x;
      const auto object = slot(number(id[begin]) - 1);
      if (x - begin > 2 * kOutline && y % steps[object] == 0)
        of[object].push_back({y, begin + kOutline, x - kOutline});
    }
  }
  return of;
}

/// Nearest first, ties as before.
void number_by_distance(Objects& objects, const Exec& exec) {
  const auto farther = [](const Object& a, const Object& b) { return a.disparity_px > b.disparity_px; };
  if (std::is_sorted(objects.list.begin(), objects.list.end(), farther)) return;
  std::stable_sort(objects.list.begin(), objects.list.end(), farther);
  std::vector<ObjectId> now(objects.list.size() + 1, ObjectId::none);
  for (std::size_t i = 0; i < objects.list.size(); ++i) {
    Object& object = objects.list[i];
    const ObjectId id{static_cast<std::int32_t>(i) + 1};
    now[slot(number(object.id))] = id;
    object.id = id;
  }
  parallel_for(exec, objects.labels.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      ObjectId* const id = objects.labels.row(y);
      for (int x = 0; x < objects.labels.width(); ++x) id[x] = now[slot(number(id[x]))];
    }
  });
}

}  // namespace

std::vector<double> image_shifts(const Objects& objects, const DisparityMap& disparity, View<const Gray> left,
                                 View<const Gray> right, const Exec& exec) {
  const std::vector<std::vector<Stretch>> interior = interiors(objects, disparity.disparity_px);
  std::vector<double> shifts(objects.list.size());
  const auto measured = [&](int x, int y) { return double{disparity.disparity_px(x, y)}; };
  parallel_for(exec, static_cast<int>(interior.size()), 1, [&](int first, int last) {
    for (auto i = slot(first); i < slot(last); ++i) {
      const int step = row_step(objects.list[i].pixel_count);
      shifts[i] = match_shift(interior[i], measured, left, right, kShiftSigma, step).shift_px;
    }
  });
  return shifts;
}

Objects refine_objects(Objects objects, const DisparityMap& disparity, View<const Gray> left,
                       View<const Gray> right, const FittedTrees& bias, const Exec& exec) {
  if (right.empty() || objects.list.empty()) return objects;
  const std::vector<double> shifts = image_shifts(objects, disparity, left, right, exec);
  const std::vector<BiasFeatures> features = bias_features(objects, shifts, disparity, left, right, exec);
  for (std::size_t i = 0; i < objects.list.size(); ++i) {
    float& d = objects.list[i].disparity_px;
    const double most = kMaxShare * std::abs(double{d});
    d = static_cast<float>(double{d} + std::clamp(shifts[i] + beyond_doubt(bias(features[i])), -most, most));
  }
  number_by_distance(objects, exec);
  return objects;
}

}  // namespace cairn
