// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/reliability.hpp>

#include <algorithm>
#include <cairn/evaluation/consistency.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <cairn/scene/plane_fit.hpp>
#include <cmath>
#include <numbers>

#include <cairn/sequence/first_pose.hpp>
#include <cairn/sequence/follower.hpp>

namespace cairn {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr int kEveryRow = 4;  // a share needs only every fourth row

template <class T>
View<const T> some_rows(View<const T> all) {
  return {all.data(), {all.width(), (all.height() + kEveryRow - 1) / kEveryRow}, kEveryRow * all.stride()};
}

std::optional<float> known(double share) {
  if (!std::isfinite(share)) return std::nullopt;
  return static_cast<float>(std::clamp(share, 0.0, 1.0));
}

// ---- stereo, photometric ----

void judge_pair(const Frame& frame, const ReliabilityInputs& evidence, Witnesses& seen) {
  if (evidence.right.empty() || evidence.best_right.empty()) return;
  Image<Gray> moved;
  View<const Gray> right = evidence.right;
  if (frame.epipolar.outcome == EpipolarOutcome::corrected) {
    moved = shift_rows(right, frame.epipolar, Exec{});
    right = moved;
  }
  const View<const float> disparity = frame.disparity.disparity_px;
  const Consistency both =
      consistency(some_rows<Gray>(evidence.left), some_rows<Gray>(right), some_rows<float>(disparity),
                  some_rows<std::int16_t>(evidence.best_right));
  std::int64_t denied = 0;
  const View<const Reject> reject = some_rows<Reject>(frame.disparity.reject);
  for (int y = 0; y < reject.height(); ++y) {
    for (int x = 0; x < reject.width(); ++x)
      denied += (reject(x, y) & ~Reject::sky) == Reject::left_right ? 1 : 0;
  }
  if (both.matched + denied == 0) {
    seen.stereo = 0.0F;
    return;
  }
  seen.stereo = known(static_cast<double>(both.confirmed) / static_cast<double>(both.matched + denied));
  seen.photometric = known(1 - both.photometric());
}

// ---- temporal ----

/// Predicted tracks and objects of this frame, and the pixels with a disparity that they have in common.
struct Overlay {
  std::vector<TrackId> rows;        // tracks that are expected in view, ascending
  std::vector<double> sure_before;  // their confidence
  std::vector<bool> counts;         // of each object: belongs to a track
  std::vector<int> common;          // px, by row and column
  std::vector<int> expected;        // px of each row
  std::vector<int> found;           // px of each column
};

Overlay overlay_of(const TrackedFrame& step, const MaskPrediction& predicted) {
  constexpr float kInView = 0.5F;
  constexpr int kMinPixels = 16;
  const Objects& objects = step.frame.objects;
  Overlay overlay;
  for (const MaskPrediction::Mask& mask : predicted.masks) {
    const auto track = std::ranges::find(step.tracks.list, mask.track, &Track::id);
    const bool was_seen = track != step.tracks.list.end() && (track->recent >> 1U & 1U) != 0;
    if (!was_seen || mask.in_view < kInView || mask.area < kMinPixels) continue;
    overlay.rows.push_back(mask.track);
    overlay.sure_before.push_back(double{track->confidence});
  }
  // Objects too uncertain to start a track are never predicted, so they do not count as unexpected.
  const std::size_t columns = objects.list.size();
  overlay.counts.assign(columns, false);
  for (const Track& track : step.tracks.list) {
    if (track.object != ObjectId::none) overlay.counts[slot(number(track.object)) - 1] = true;
    for (const ObjectId part : track.parts) overlay.counts[slot(number(part)) - 1] = true;
  }
  overlay.common.assign(overlay.rows.size() * columns, 0);
  overlay.expected.assign(overlay.rows.size(), 0);
  overlay.found.assign(columns, 0);
  for (int y = 0; y < objects.labels.height(); ++y) {
    const ObjectId* const labels = objects.labels.row(y);
    const TrackId* const ids = predicted.ids.row(y);
    const float* const d = step.frame.disparity.disparity_px.row(y);
    for (int x = 0; x < objects.labels.width(); ++x) {
      if (std::isnan(d[x]) || (labels[x] == ObjectId::none && ids[x] == TrackId::none)) continue;
      const auto row = std::ranges::lower_bound(overlay.rows, ids[x]);
      const bool has_row = ids[x] != TrackId::none && row != overlay.rows.end() && *row == ids[x];
      const auto at = static_cast<std::size_t>(row - overlay.rows.begin());
      if (has_row) ++overlay.expected[at];
      if (labels[x] == ObjectId::none) continue;
      const std::size_t column = slot(number(labels[x])) - 1;
      ++overlay.found[column];
      if (has_row) ++overlay.common[at * columns + column];
    }
  }
  return overlay;
}

/// IoU of the tracks predicted to be in view with the tracked objects, over the pixels that have a disparity.
std::optional<float> temporal_of(const TrackedFrame& step, const MaskPrediction& predicted) {
  if (step.index == 0 || step.is_lost) return std::nullopt;
  const Objects& objects = step.frame.objects;
  const Overlay overlay = overlay_of(step, predicted);
  const std::size_t columns = objects.list.size();
  struct Pair {
    double iou;
    std::size_t row, column;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < overlay.rows.size(); ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      const int both = overlay.common[i * columns + j];
      if (both > 0 && overlay.counts[j])
        pairs.push_back({static_cast<double>(both) / (overlay.expected[i] + overlay.found[j] - both), i, j});
    }
  }
  // Best pair first; ties by track, then by object.
  std::ranges::stable_sort(pairs, std::ranges::greater{}, &Pair::iou);
  std::vector<bool> row_taken(overlay.rows.size(), false);
  std::vector<bool> column_taken(columns, false);
  double agreed = 0;
  for (const Pair& pair : pairs) {
    if (row_taken[pair.row] || column_taken[pair.column]) continue;
    row_taken[pair.row] = column_taken[pair.column] = true;
    agreed +=
        pair.iou * std::min(overlay.sure_before[pair.row], double{objects.list[pair.column].confidence});
  }
  double before = 0;
  for (const double sure : overlay.sure_before) before += sure;
  double now = 0;
  for (std::size_t j = 0; j < columns; ++j)
    now += overlay.counts[j] ? double{objects.list[j].confidence} : 0.0;
  return known(agreed / std::max(before, now));
}

// ---- floor ----

std::optional<FloorInCamera> floor_of_frame(const TrackedFrame& step, const std::optional<StereoRig>& rig) {
  const auto floor = floor_frame(step.frame.ground, rig);
  if (!floor) return std::nullopt;
  return FloorInCamera{{double{floor->up.x}, double{floor->up.y}, double{floor->up.z}},
                       double{floor->camera_height_m}};
}

FloorInCamera moved(const FloorInCamera& floor, const Pose& now_from_before) {
  const Point3 place = inverse(now_from_before).translation_m;  // the camera now, in the previous frame
  return {now_from_before.rotated(floor.up), floor.height_m + dot(floor.up, place)};
}

/// nullopt until a floor was seen for the first time: there may be none.
std::optional<float> floor_agreement(const std::optional<FloorInCamera>& expected,
                                     const std::optional<FloorInCamera>& seen, const Ground& ground) {
  constexpr double kEnough = 0.2;  // floor share of the pixels under the horizon for full agreement
  constexpr double kAngle = 3 * kDegree;
  constexpr double kHeightM = 0.05;
  if (!expected && !seen) return std::nullopt;
  if (!seen) return 0.0F;
  double agreement = std::min(1.0, double{ground.support} / kEnough);
  if (expected) {
    const double angle = std::acos(std::clamp(dot(expected->up, seen->up), -1.0, 1.0)) / kAngle;
    const double height = (seen->height_m - expected->height_m) / kHeightM;
    agreement *= std::exp(-(angle * angle + height * height) / 2);
  }
  return known(agreement);
}

// ---- odometry ----

std::optional<float> odometry_of(const TrackedFrame& step) {
  const MotionRefusal refusal = step.motion.refusal;
  if (step.index == 0 || refusal == MotionRefusal::off || refusal == MotionRefusal::no_rig)
    return std::nullopt;
  if (refusal != MotionRefusal::none) return 0.0F;
  return known(double{step.motion.inlier_share});
}

// ---- scan ----

std::optional<float> scan_of(const TrackedFrame& step, const LaserScan& scan, const StereoRig& rig) {
  constexpr int kMinBeams = 10;
  constexpr float kAgreePx = 2;
  const Pose from_level = camera_from_level(step.map_from_camera);
  const View<const float> disparity = step.frame.disparity.disparity_px;
  int looked_at = 0;
  int agreeing = 0;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const auto range = double{scan.ranges_m[i]};
    if (!(range > 0) || !std::isfinite(range)) continue;
    const double angle = scan.first_rad + static_cast<double>(i) * scan.step_rad;
    const Point3 hit =
        from_level(scan.in_level_camera_m + Point3{-range * std::sin(angle), 0, range * std::cos(angle)});
    if (!(hit.z > 0)) continue;
    const double u = std::floor(double{rig.focal_px} * hit.x / hit.z + double{rig.cx_px} + 0.5);
    const double v = std::floor(double{rig.focal_px} * hit.y / hit.z + double{rig.cy_px} + 0.5);
    if (!(u >= 1 && v >= 1 && u < disparity.width() - 1 && v < disparity.height() - 1)) continue;
    const auto expected =
        static_cast<float>(double{rig.focal_px} * double{rig.baseline_m} / hit.z - double{rig.doffs_px});
    bool is_known = false;
    bool agrees = false;
    for (int y = static_cast<int>(v) - 1; y <= static_cast<int>(v) + 1; ++y) {
      for (int x = static_cast<int>(u) - 1; x <= static_cast<int>(u) + 1; ++x) {
        is_known = is_known || !std::isnan(disparity(x, y));
        agrees = agrees || std::abs(disparity(x, y) - expected) <= kAgreePx;
      }
    }
    looked_at += is_known ? 1 : 0;
    agreeing += agrees ? 1 : 0;
  }
  if (looked_at < kMinBeams) return std::nullopt;
  return known(static_cast<double>(agreeing) / looked_at);
}

// ---- walls ----

constexpr int kEveryPixel = 2;
constexpr float kFlatPx = 1.05F;  // three standard deviations of a disparity

/// The plane through an object's disparities; nullopt if they are few or collinear.
std::optional<GroundPlane> plane_of(const Frame& frame, const Object& object) {
  constexpr double kMin = 16;
  const Rect box = object.box_px;
  PlaneFit fit(box.x + box.width / 2.0, box.y + box.height / 2.0);
  for (int y = box.y; y < box.y + box.height; y += kEveryPixel) {
    for (int x = box.x; x < box.x + box.width; x += kEveryPixel) {
      const float d = frame.disparity.disparity_px(x, y);
      if (frame.objects.labels(x, y) == object.id && !std::isnan(d)) fit.add(x, y, double{d});
    }
  }
  return fit.count() < kMin ? std::nullopt : fit.solve();
}

bool is_wall(const Frame& frame, const Object& object) {
  constexpr double kWallShare = 0.05;
  constexpr double kFlatShare = 0.9;
  if (object.pixel_count <= kWallShare * static_cast<double>(frame.objects.labels.size().area()))
    return false;
  const auto plane = plane_of(frame, object);
  if (!plane) return false;
  int known = 0;
  int flat = 0;
  const Rect box = object.box_px;
  for (int y = box.y; y < box.y + box.height; y += kEveryPixel) {
    for (int x = box.x; x < box.x + box.width; x += kEveryPixel) {
      const float d = frame.disparity.disparity_px(x, y);
      if (frame.objects.labels(x, y) != object.id || std::isnan(d)) continue;
      ++known;
      const float expected = plane->disparity_px(static_cast<float>(x), static_cast<float>(y));
      flat += std::abs(d - expected) <= kFlatPx ? 1 : 0;
    }
  }
  return flat >= kFlatShare * known;
}

}  // namespace

float steadiness(const TrackedFrame& step, float temporal) {
  float sure = 0;
  for (const Track& track : step.tracks.list) {
    if (track.object == ObjectId::none || track.state == TrackState::tentative) continue;
    const Object& object = step.frame.objects.list[slot(number(track.object)) - 1];
    if (!is_wall(step.frame, object)) sure += object.confidence;
  }
  return temporal * sure;
}

Reliability assess_reliability(const TrackedFrame& step, const MaskPrediction& warped,
                               const ReliabilityInputs& evidence, const Reliability& before) {
  Reliability judged;
  Witnesses& seen = judged.witnesses;
  judge_pair(step.frame, evidence, seen);
  seen.temporal = temporal_of(step, warped);
  if (evidence.looks_for_floor) {
    std::optional<FloorInCamera> expected;
    if (before.floor && !step.is_lost) expected = moved(*before.floor, step.motion.now_from_before);
    const auto floor = floor_of_frame(step, evidence.rig);
    seen.floor = floor_agreement(expected, floor, step.frame.ground);
    judged.floor = floor ? floor : expected;
  }
  seen.odometry = odometry_of(step);
  if (evidence.scan != nullptr && evidence.rig && !step.is_lost)
    seen.scan = scan_of(step, *evidence.scan, *evidence.rig);

  int count = 0;
  double logarithms = 0;
  float least = 2;
  for (const WitnessName& witness : kWitnesses) {
    const std::optional<float> value = seen.*witness.value;
    if (!value) continue;
    ++count;
    logarithms += std::log(double{std::max(*value, kMinWitness)});
    if (*value < least) {
      least = *value;
      judged.weakest = std::string(witness.name);
    }
  }
  if (count > 0) judged.value = static_cast<float>(std::exp(logarithms / count));
  judged.weak_frames = judged.value && *judged.value < kUnreliable ? before.weak_frames + 1 : 0;
  judged.is_unreliable = judged.weak_frames >= kUnreliableFrames;
  judged.steadiness = steadiness(step, seen.temporal.value_or(0));
  return judged;
}

}  // namespace cairn
