// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include <cairn/sequence/kalman.hpp>
#include <cairn/sequence/tracks.hpp>

namespace cairn {
namespace {

constexpr float kOtherLabel = 6;   // of the accumulated log-likelihood ratio
constexpr float kMaxOfOne = 2.5F;  // per sighting: no two decide alone, since outlines jump
constexpr std::size_t kPlaces = 30;
constexpr double kSpeedSigmas = 3;
constexpr double kFirstSpeed = 1;  // m/s, standard deviation, of an object seen once
constexpr int kOfFrames = 5;       // frames in which min_hits are required
constexpr float kHidden = 0.5F;    // share of the mask
constexpr float kInView = 0.5F;
constexpr double kSteadyShare = 0.5;  // of a measurement's variance: errors that persist

/// The sighting of a track in the map frame: one object, or the pieces of one.
struct Observation {
  const Detection* main = nullptr;
  std::vector<const Detection*> all;
  Point3 position_m;
  Covariance3 covariance_m2{};
  Covariance3 steady_m2{};
  Point3 camera_m;
  bool has_place = false;
  bool is_cut = false;
};

Covariance3 sum(const Covariance3& a, const Covariance3& b, double times) {
  Covariance3 c = a;
  for (std::size_t i = 0; i < c.size(); ++i) c.at(i) += times * b.at(i);
  return c;
}

Covariance3 scaled(Covariance3 c, double times) {
  for (double& entry : c) entry *= times;
  return c;
}

Observation seen_by(std::vector<const Detection*> detections, const Pose& map_from_camera,
                    const Covariance6& pose_covariance) {
  Observation seen;
  seen.main = detections.front();
  seen.all = std::move(detections);
  seen.has_place = std::ranges::all_of(seen.all, [](const Detection* s) { return s->has_place; });
  seen.is_cut = std::ranges::any_of(seen.all, [](const Detection* s) { return s->is_cut; });
  if (!seen.has_place) return seen;
  int pixels = 0;
  for (const Detection* s : seen.all) pixels += s->pixel_count;
  Point3 in_camera_m;
  for (const Detection* s : seen.all)
    in_camera_m = in_camera_m + (double{1} * s->pixel_count / std::max(pixels, 1)) * s->position_in_camera_m;
  seen.position_m = map_from_camera(in_camera_m);
  seen.camera_m = map_from_camera.translation_m;
  seen.covariance_m2 =
      in_map(seen.main->covariance_in_camera_m2, in_camera_m, map_from_camera, pose_covariance);
  seen.steady_m2 = rotated(map_from_camera, seen.main->steady_in_camera_m2);
  return seen;
}

// Factor on a track's confidence for each frame that should show it and does not.
constexpr float kDoubt = 0.8F;

Filter6 moving_from(Point3 position_m, const Covariance3& covariance_m2) {
  Filter6 filter{position_m, {}, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) filter.covariance.at(i * 6 + j) = covariance_m2.at(i * 3 + j);
    filter.covariance.at((i + 3) * 7) = kFirstSpeed * kFirstSpeed;
  }
  return filter;
}

/// Page's test (CUSUM): evidence for the current label is not accumulated, so an object that was static for
/// long is found to move as quickly as a new one.
void weigh_label(Track& track, float moving_against_static, const Place& place) {
  const float ratio = std::clamp(moving_against_static, -kMaxOfOne, kMaxOfOne);
  track.against_label = std::max(track.against_label + (track.is_moving ? -ratio : ratio), 0.0F);
  if (track.against_label == 0) track.places.clear();
  if (track.places.size() == kPlaces) track.places.erase(track.places.begin());
  track.places.push_back(place);
}

/// Updates the filters with a sighting, and the evidence for the label.
void update_place(Track& track, const Observation& seen, bool was_cut, Stamp now,
                  const TrackingConfig& config) {
  if (!track.has_place) {
    track.as_static = {seen.position_m, seen.covariance_m2};
    track.as_moving = moving_from(seen.position_m, seen.covariance_m2);
    track.has_place = true;
    return;
  }
  track.as_static = moved_viewpoint(track.as_static, track.extent_m, track.seen_from_m, seen.camera_m);
  const Innovation stands = innovation(track.as_static.position_m, track.as_static.covariance_m2,
                                       seen.position_m, seen.covariance_m2);
  const Innovation moves = innovation(track.as_moving.position_m, of_position(track.as_moving),
                                      seen.position_m, seen.covariance_m2);
  // Clipping by the image border moves the centre of the visible part, though nothing moves.
  if (seen.is_cut || was_cut || seen.all.size() > 1) {
    track.places.clear();
  } else if (seen.main->confidence >= config.high_confidence) {
    weigh_label(track, static_cast<float>(moves.log_likelihood - stands.log_likelihood),
                {now, seen.position_m, seen.covariance_m2});
  }
  // A jumping mask, see associate(), has no more influence than one at the gate.
  const auto trusted = [&](const Innovation& off) {
    return scaled(seen.covariance_m2, std::max(off.d2 / double{config.gate}, 1.0));
  };
  track.as_static = updated(track.as_static, seen.position_m, trusted(stands));
  track.as_moving = updated(track.as_moving, seen.position_m, trusted(moves));
}

template <class T>
void blend(T& old, T fresh, float weight) {
  old += weight * (fresh - old);
}

void update_looks(Track& track, const Observation& seen) {
  // The mean of the first five, then an exponential average over about five.
  const float weight = 1.0F / static_cast<float>(std::min(track.hits, 5));
  for (std::size_t i = 0; i < track.look.size(); ++i) blend(track.look.at(i), seen.main->look.at(i), weight);
  blend(track.confidence, seen.main->confidence, weight);
  if (!seen.has_place || seen.all.size() > 1) return;
  blend(track.extent_m.x, seen.main->extent_m.x, weight);
  blend(track.extent_m.y, seen.main->extent_m.y, weight);
  blend(track.extent_m.z, seen.main->extent_m.z, weight);
  blend(track.height_over_floor_m, seen.main->height_over_floor_m, weight);
}

void update(Track& track, const Observation& seen, bool is_joined, Stamp now, const TrackingConfig& config) {
  const bool was_cut = track.is_cut;
  track.object = seen.main->object;
  for (std::size_t i = 1; i < seen.all.size(); ++i) track.parts.push_back(seen.all[i]->object);
  track.in_parts = seen.all.size() > 1 ? track.in_parts + 1 : 0;
  track.is_joined = is_joined;
  track.is_cut = seen.is_cut;
  ++track.hits;
  track.doubt *= 1 - seen.main->confidence;
  track.misses = 0;
  track.last = now;
  track.recent |= 1U;
  if (is_joined) return;
  if (seen.has_place) {
    update_place(track, seen, was_cut, now, config);
    track.measured_m2 = seen.steady_m2;
    track.seen_from_m = seen.camera_m;
  }
  update_looks(track, seen);
}

/// Whether the accumulated confidence equals that of min_hits sightings that each just start a track; a
/// single confident sighting may suffice.
bool is_beyond_doubt(const Track& track, const TrackingConfig& config) {
  return double{track.doubt} <= std::pow(1 - double{config.high_confidence}, config.min_hits);
}

int hits_of(const Track& track, int frames) {
  const std::uint32_t mask = frames >= 32 ? ~0U : (1U << static_cast<unsigned>(frames)) - 1U;
  return std::popcount(track.recent & mask);
}

/// For a track that this frame does not show.
void miss(Track& track, std::size_t t, const Overlaps& overlaps, Stamp now, const TrackingConfig& config) {
  if (track.state == TrackState::tentative) {
    ++track.misses;
    if (track.misses > std::max(kOfFrames - config.min_hits, 0)) track.state = TrackState::dead;
    return;
  }
  const int area = overlaps.area[t];
  // What is covered by another track's prediction counts as hidden, too.
  const int hidden = overlaps.nearer[t] + std::max(area - overlaps.predicted[t], 0);
  if (overlaps.in_view[t] < kInView) {
    track.state = TrackState::out_of_view;
  } else if (static_cast<float>(hidden) > kHidden * static_cast<float>(area)) {
    track.state = TrackState::occluded;
  } else {
    ++track.misses;
    track.state = TrackState::lost;
    track.confidence *= kDoubt;
  }
  if (track.misses > config.max_age || seconds_between(track.last, now) > double{config.max_hidden})
    track.state = TrackState::dead;
}

/// Whether a joined object that carries another track's id also shows this track.
bool is_in_joined(const Track& track, std::size_t t, const std::vector<ObjectId>& joined,
                  const Overlaps& overlaps) {
  return track.state != TrackState::tentative &&
         std::ranges::any_of(joined, [&](ObjectId object) { return is_joined_with(overlaps, t, object); });
}

bool wants_to_move(const Track& track, const TrackingConfig& config) {
  if (track.is_moving || track.object == ObjectId::none || !(track.against_label > kOtherLabel) ||
      track.places.size() < 3)
    return false;
  const Drift drift = drift_of(track.places);
  // Constant errors shift all positions alike.
  const double sigma_m_s = drift.sigma_m_s * std::sqrt(1 - kSteadyShare);
  return length(drift.velocity_m_s) - kSpeedSigmas * sigma_m_s > double{config.min_speed};
}

void label(Tracks& tracks, const TrackingConfig& config) {
  int confirmed = 0;
  int wanting = 0;
  for (const Track& track : tracks.list) {
    if (track.state != TrackState::confirmed || track.object == ObjectId::none) continue;
    ++confirmed;
    if (wants_to_move(track, config)) ++wanting;
  }
  tracks.odometry_suspect = wanting >= 2 && 2 * wanting > confirmed;
  for (Track& track : tracks.list) {
    const bool changes = track.is_moving ? track.against_label > kOtherLabel : wants_to_move(track, config);
    if (changes && !tracks.odometry_suspect) track.is_moving = !track.is_moving;
    if (!changes && !tracks.odometry_suspect) continue;
    track.against_label = 0;
    track.places.clear();
  }
}

/// Sets the reported state from the filter that the label selects.
void report(Track& track) {
  if (!track.has_place) return;
  const Covariance3 known = track.is_moving ? of_position(track.as_moving) : track.as_static.covariance_m2;
  track.position_m = track.is_moving ? track.as_moving.position_m : track.as_static.position_m;
  track.velocity_m_s = track.is_moving ? track.as_moving.velocity_m_s : Point3{};
  // Errors of a mask persist from frame to frame, so they do not average out.
  track.covariance_m2 = sum(known, track.measured_m2, 1);
}

Track new_track(TrackId id, const Detection& detection, const Pose& map_from_camera,
                const Covariance6& pose_covariance, Stamp now, const TrackingConfig& config) {
  Track track;
  track.id = id;
  track.first = now;
  update(track, seen_by({&detection}, map_from_camera, pose_covariance), false, now, config);
  if (is_beyond_doubt(track, config)) track.state = TrackState::confirmed;
  return track;
}

}  // namespace

Covariance3 covariance_in_map(const Track& track, const Pose& map_from_camera,
                              const Covariance6& pose_covariance) {
  const Covariance3 of_pose =
      in_map({}, inverse(map_from_camera)(track.position_m), map_from_camera, pose_covariance);
  return sum(track.covariance_m2, of_pose, 1);
}

Tracks rebased_to_keyframe(Tracks tracks, const Pose& map_from_camera, const Covariance6& key_covariance,
                           bool is_new_segment) {
  const Pose camera_from_map = inverse(map_from_camera);
  const auto tie = [&](Point3 position_m) {
    return in_map({}, camera_from_map(position_m), map_from_camera, key_covariance);
  };
  for (Track& track : tracks.list) {
    if (is_new_segment) {
      track.against_label = 0;
      track.places.clear();
    }
    if (!track.has_place) continue;
    track.as_static.covariance_m2 = sum(track.as_static.covariance_m2, tie(track.as_static.position_m), 1);
    const Covariance3 grown = tie(track.as_moving.position_m);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) track.as_moving.covariance.at(i * 6 + j) += grown.at(i * 3 + j);
    }
  }
  return tracks;
}

Tracks advance_tracks(Tracks tracks, const std::vector<Detection>& detections,
                      const std::vector<Assignment>& matches, const Overlaps& overlaps,
                      const CameraAt& camera, const TrackingConfig& config) {
  const auto& [now, map_from_camera, pose_covariance, is_lost] = camera;
  const double dt_s = seconds_between(tracks.stamp, now);
  tracks.stamp = now;
  tracks.odometry_suspect = false;
  for (Track& track : tracks.list) {
    track.object = ObjectId::none;
    track.parts.clear();
    track.is_joined = false;
    track.recent <<= 1U;
  }
  if (is_lost) {
    for (Track& track : tracks.list) {
      // Predict moving tracks, and count the time out of sight.
      track.as_static = predicted(track.as_static, dt_s, double{config.static_noise});
      track.as_moving = predicted(track.as_moving, dt_s, double{config.acceleration_noise});
      const bool ends = track.state == TrackState::tentative ||
                        seconds_between(track.last, now) > double{config.max_hidden};
      track.state = ends ? TrackState::dead : TrackState::lost;
      report(track);
    }
    std::erase_if(tracks.list, [](const Track& track) { return track.state == TrackState::dead; });
    return tracks;
  }

  std::vector<const Detection*> by_object(static_cast<std::size_t>(overlaps.objects) + 1, nullptr);
  for (const Detection& seen : detections) by_object[slot(number(seen.object))] = &seen;
  std::vector<bool> is_matched(by_object.size(), false);
  const std::vector<ObjectId> joined = joined_objects(tracks, overlaps);
  auto match = matches.begin();
  for (std::size_t t = 0; t < tracks.list.size(); ++t) {
    Track& track = tracks.list[t];
    track.as_static = predicted(track.as_static, dt_s, double{config.static_noise});
    track.as_moving = predicted(track.as_moving, dt_s, double{config.acceleration_noise});
    std::vector<const Detection*> mine;
    for (; match != matches.end() && match->track == track.id; ++match) {
      mine.push_back(by_object[slot(number(match->object))]);
      is_matched[slot(number(match->object))] = true;
    }
    if (!mine.empty()) {
      const bool is_joined = std::ranges::binary_search(joined, mine.front()->object);
      update(track, seen_by(std::move(mine), map_from_camera, pose_covariance), is_joined, now, config);
      if (track.state != TrackState::tentative ||
          hits_of(track, std::max(kOfFrames, config.min_hits)) >= config.min_hits ||
          is_beyond_doubt(track, config))
        track.state = TrackState::confirmed;
    } else if (is_in_joined(track, t, joined, overlaps)) {
      track.is_joined = true;
      track.last = now;
    } else {
      miss(track, t, overlaps, now, config);
    }
  }
  std::erase_if(tracks.list, [](const Track& track) { return track.state == TrackState::dead; });
  label(tracks, config);
  for (const Detection& seen : detections) {
    if (is_matched[slot(number(seen.object))] || seen.confidence < config.high_confidence ||
        std::ranges::binary_search(joined, seen.object))
      continue;
    tracks.list.push_back(
        new_track(TrackId{tracks.next++}, seen, map_from_camera, pose_covariance, now, config));
  }
  for (Track& track : tracks.list) report(track);
  return tracks;
}

}  // namespace cairn
