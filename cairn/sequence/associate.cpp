// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <cairn/sequence/assign.hpp>
#include <cairn/sequence/kalman.hpp>
#include <cairn/sequence/tracks.hpp>

namespace cairn {
namespace {

constexpr double kPerUnit = 1024;     // costs are integers in units of 1 / kPerUnit
constexpr double kLookWeight = 10;    // at appearance_weight 1
constexpr double kSizeWeight = 2;     // per factor of e
constexpr double kOverlapWeight = 5;  // for disjoint masks
constexpr float kJoinedShare = 0.5F;  // of a predicted mask
constexpr float kHiddenShare = 0.5F;  // of a predicted mask; more behind the object: it is not joined
constexpr float kSameMask = 0.5F;     // intersection over union
constexpr float kPartShare = 0.7F;    // of a piece
constexpr int kPartsInARow = 5;       // frames; an object that comes in pieces for longer is several objects

bool is_confirmed(const Track& track) {
  return track.state != TrackState::tentative && track.state != TrackState::dead;
}

float share(int part, int whole) {
  return whole > 0 ? static_cast<float>(part) / static_cast<float>(whole) : 0.0F;
}

/// The ratio of the sizes, larger to smaller, ≥ 1.
double ratio(Vec3 a, Vec3 b) {
  constexpr double kMin = 0.02;  // m
  const auto size = [kMin](Vec3 v) { return std::max(std::hypot(double{v.x}, double{v.y}), kMin); };
  return std::max(size(a), size(b)) / std::min(size(a), size(b));
}

class Costs {
 public:
  Costs(const Tracks& tracks, const std::vector<Detection>& detections, const Overlaps& overlaps,
        const Pose& map_from_camera, const Covariance6& pose_covariance, Stamp now,
        const TrackingConfig& config)
      : tracks_(tracks),
        sightings_(detections),
        overlaps_(overlaps),
        config_(config),
        dt_s_(seconds_between(tracks.stamp, now)),
        camera_m_(map_from_camera.translation_m),
        joined_(joined_objects(tracks, overlaps)) {
    for (const Detection& seen : detections) {
      positions_m_.push_back(map_from_camera(seen.position_in_camera_m));
      covariances_m2_.push_back(
          in_map(seen.covariance_in_camera_m2, seen.position_in_camera_m, map_from_camera, pose_covariance));
      vagueness_.push_back(log_vagueness(covariances_m2_.back()));
    }
  }

  /// In units of 1 / kPerUnit, or CostTable::kForbidden.
  [[nodiscard]] std::int64_t operator()(std::size_t t, std::size_t s) const {
    const Track& track = tracks_.list[t];
    const Detection& seen = sightings_[s];
    const int common = overlaps_.at(t, seen.object);
    const float overlap = share(common, overlaps_.predicted[t] + seen.pixel_count - common);
    double cost = kOverlapWeight * (1 - double{overlap}) + kLookWeight * double{config_.appearance_weight} *
                                                               (1 - double{likeness(track.look, seen.look)});
    if (is_joined(seen.object)) {
      // Its centre is between the objects that it joins: the masks decide.
      if (!is_joined_with(overlaps_, t, seen.object)) return CostTable::kForbidden;
      cost += double{config_.gate};
    } else if (track.has_place && seen.has_place) {
      const Innovation found = nearest(track, s);
      // The centre jumps if a mask is clipped or gains a piece, but the masks still overlap.
      const bool is_same_mask = overlap >= kSameMask;
      if (found.d2 > double{config_.gate} && !is_same_mask) return CostTable::kForbidden;
      cost += std::min(found.d2, double{config_.gate}) + found.log_widening +
              (1 - double{overlap}) * vagueness_[s] +
              kSizeWeight * std::log(ratio(track.extent_m, seen.extent_m));
    } else if (common == 0) {
      return CostTable::kForbidden;
    }
    return static_cast<std::int64_t>(std::floor(cost * kPerUnit + 0.5));
  }

 private:
  [[nodiscard]] bool is_joined(ObjectId object) const { return std::ranges::binary_search(joined_, object); }
  /// The innovation of the likelier of the two filters, as the object may start or stop moving.
  [[nodiscard]] Innovation nearest(const Track& track, std::size_t s) const {
    const Filter3 stands = moved_viewpoint(predicted(track.as_static, dt_s_, double{config_.static_noise}),
                                           track.extent_m, track.seen_from_m, camera_m_);
    const Innovation a =
        innovation(stands.position_m, stands.covariance_m2, positions_m_[s], covariances_m2_[s]);
    const Filter6 moves = predicted(track.as_moving, dt_s_, double{config_.acceleration_noise});
    const Innovation b =
        innovation(moves.position_m, of_position(moves), positions_m_[s], covariances_m2_[s]);
    return a.d2 + a.log_widening <= b.d2 + b.log_widening ? a : b;
  }

  const Tracks& tracks_;
  const std::vector<Detection>& sightings_;
  const Overlaps& overlaps_;
  const TrackingConfig& config_;
  double dt_s_;
  Point3 camera_m_;
  std::vector<ObjectId> joined_;
  std::vector<Point3> positions_m_;
  std::vector<Covariance3> covariances_m2_;
  std::vector<double> vagueness_;
};

/// Matches tracks and sightings that are unmatched so far.
void match(const Costs& cost, const std::vector<std::size_t>& detections, std::int64_t alone,
           std::vector<int>& sighting_of, std::vector<bool>& is_taken) {
  std::vector<std::size_t> rows;
  for (std::size_t t = 0; t < sighting_of.size(); ++t) {
    if (sighting_of[t] < 0) rows.push_back(t);
  }
  CostTable table{static_cast<int>(rows.size()), static_cast<int>(detections.size()), {}, alone};
  for (const std::size_t t : rows) {
    for (const std::size_t s : detections) table.costs.push_back(cost(t, s));
  }
  const std::vector<int> found = assign(table);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (found[i] < 0) continue;
    const std::size_t s = detections[static_cast<std::size_t>(found[i])];
    sighting_of[rows[i]] = static_cast<int>(s);
    is_taken[s] = true;
  }
}

bool touch(const Rect& a, const Rect& b) {
  const Size gap = gap_between(a, b);
  return gap.width <= 2 && gap.height <= 2;
}

}  // namespace

bool is_joined_with(const Overlaps& overlaps, std::size_t track, ObjectId object) {
  const int predicted = overlaps.predicted[track];
  return share(overlaps.at(track, object), predicted) >= kJoinedShare &&
         share(overlaps.nearer[track], predicted) < kHiddenShare;
}

std::vector<ObjectId> joined_objects(const Tracks& tracks, const Overlaps& overlaps) {
  std::vector<ObjectId> joined;
  for (std::int32_t j = 1; j <= overlaps.objects; ++j) {
    int covered = 0;
    for (std::size_t t = 0; t < tracks.list.size(); ++t) {
      if (is_confirmed(tracks.list[t]) && is_joined_with(overlaps, t, ObjectId{j})) ++covered;
    }
    if (covered >= 2) joined.push_back(ObjectId{j});
  }
  return joined;
}

std::vector<Assignment> associate(const Tracks& tracks, const std::vector<Detection>& detections,
                                  const Overlaps& overlaps, const CameraAt& camera,
                                  const TrackingConfig& config) {
  const Costs cost(tracks, detections, overlaps, camera.map_from_camera, camera.pose_covariance, camera.now,
                   config);
  std::vector<int> sighting_of(tracks.list.size(), -1);
  std::vector<bool> is_taken(detections.size(), false);
  std::vector<std::size_t> sure;
  std::vector<std::size_t> unsure;
  for (std::size_t s = 0; s < detections.size(); ++s)
    (detections[s].confidence >= config.high_confidence ? sure : unsure).push_back(s);
  // Pairs above twice the gate are not matched, even without an alternative.
  const std::int64_t alone = 2 * std::llround(double{config.gate} * kPerUnit);
  match(cost, sure, alone, sighting_of, is_taken);
  match(cost, unsure, alone, sighting_of, is_taken);

  std::vector<Assignment> matches;
  for (std::size_t t = 0; t < tracks.list.size(); ++t) {
    const Track& track = tracks.list[t];
    if (sighting_of[t] < 0) continue;
    const Detection& main = detections[static_cast<std::size_t>(sighting_of[t])];
    matches.push_back({track.id, main.object});
    const auto is_part = [&](const Detection& seen) {
      return share(overlaps.at(t, seen.object), seen.pixel_count) >= kPartShare;
    };
    if (!is_confirmed(track) || track.in_parts >= kPartsInARow || !is_part(main)) continue;
    for (std::size_t s = 0; s < detections.size(); ++s) {
      if (is_taken[s] || !is_part(detections[s]) || !touch(detections[s].box_px, main.box_px)) continue;
      is_taken[s] = true;
      matches.push_back({track.id, detections[s].object});
    }
  }
  return matches;
}

}  // namespace cairn
