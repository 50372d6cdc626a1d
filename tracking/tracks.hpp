// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>
#include <cairn/pipeline/segment.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "pose.hpp"

namespace cairn {

/// A thing over time: an id is never used twice in a run; none = no track.
enum class TrackId : std::int64_t { none = 0 };
constexpr std::int64_t number(TrackId id) {
  return static_cast<std::int64_t>(id);
}

struct TrackingConfig {
  float gate = 11.34F;       // χ² of 3 degrees of freedom, 0.99
  int min_hits = 3;          // frames
  int max_age = 15;          // frames
  float max_hidden = 30.0F;  // s
  float high_confidence = 0.4F;
  float low_confidence = 0.1F;
  float static_noise = 0.02F;       // m/√s
  float acceleration_noise = 1.0F;  // m/s²
  float min_speed = 0.05F;          // m/s
  float appearance_weight = 1.0F;
};
template <class V>
void fields(TrackingConfig& c, V&& v) {
  v("gate", c.gate, "χ²", "an object that is farther from where a track is expected is not that track's",
    range(1.0F, 100.0F));
  v("min_hits", c.min_hits, "frames",
    "of five in a row in which a thing must be seen before its track counts", range(1, 30));
  v("max_age", c.max_age, "frames", "in which a track may be missed, though in view, before it ends",
    range(1, 300));
  v("max_hidden", c.max_hidden, "s", "that a track may be hidden or out of view before it ends",
    range(0.0F, 3600.0F));
  v("high_confidence", c.high_confidence, "", "objects at least this sure are matched first and found tracks",
    range(0.0F, 1.0F));
  v("low_confidence", c.low_confidence, "", "objects less sure than this are not looked at",
    range(0.0F, 1.0F));
  v("static_noise", c.static_noise, "m/√s", "how far a thing that stands may seem to wander",
    range(0.0F, 1.0F));
  v("acceleration_noise", c.acceleration_noise, "m/s²", "how quickly a moving thing may change its speed",
    range(0.01F, 20.0F));
  v("min_speed", c.min_speed, "m/s", "slower things stand still", range(0.0F, 5.0F));
  v("appearance_weight", c.appearance_weight, "", "how much colours count beside place and size",
    range(0.0F, 10.0F));
}

/// Colours in CIE L*a*b*: 8 bins of lightness, then 8×8 of a and b; each part sums up to 1. Of a grey picture
/// the second part is one bin.
using ColourHistogram = std::array<float, 72>;
/// Bhattacharyya's coefficient, mean of both parts, 0 … 1: 1 = alike.
float likeness(const ColourHistogram& a, const ColourHistogram& b);

/// One object of one frame as tracking sees it.
struct Sighting {
  ObjectId object = ObjectId::none;
  bool has_place = false;  // in metres: position, covariance, extent and height are known
  Point3 position_in_camera_m;
  Covariance3 covariance_in_camera_m2{};
  Vec3 extent_m;                  // see Object::extent_in_camera_m
  float height_over_floor_m = 0;  // of its position; 0 without a floor
  ColourHistogram look{};
  float confidence = 0;
  int pixel_count = 0;
  Rect box_px;
  bool is_cut = false;  // touches the picture's border
};

/// The objects of a frame that are at least low_confidence sure, by ObjectId. Without a rig, none has a
/// place. (docs/stages/tracking.md)
std::vector<Sighting> sight(const Frame& frame, View<const Gray> left, View<const Rgb> left_rgb,
                            const std::optional<StereoRig>& rig, const TrackingConfig& config);

enum class TrackState : std::uint8_t { tentative, confirmed, occluded, out_of_view, lost, dead };
inline constexpr std::array kTrackStates{
    Choice{"tentative", TrackState::tentative}, Choice{"confirmed", TrackState::confirmed},
    Choice{"occluded", TrackState::occluded},   Choice{"out_of_view", TrackState::out_of_view},
    Choice{"lost", TrackState::lost},           Choice{"dead", TrackState::dead}};

/// A Kalman filter's estimate: of a position, or of a position and a velocity.
struct Filter3 {
  Point3 position_m;
  Covariance3 covariance_m2{};
};
struct Filter6 {
  Point3 position_m;
  Point3 velocity_m_s;
  Covariance6 covariance{};  // position before velocity
};

/// Where and when a thing was measured.
struct Place {
  Stamp stamp;
  Point3 position_m;
  Covariance3 covariance_m2{};
};

struct Track {
  TrackId id = TrackId::none;
  TrackState state = TrackState::tentative;
  bool is_moving = false;
  ObjectId object = ObjectId::none;  // in this frame; none: not seen
  std::vector<ObjectId> parts;       // further objects of this frame that are pieces of the same thing
  bool is_joined = false;            // this frame shows it as one object with another track: no position
  bool has_place = false;            // in metres
  // In the map's frame; of the filter that its label chooses.
  Point3 position_m;
  Covariance3 covariance_m2{};
  Point3 velocity_m_s;
  Vec3 extent_m;
  float height_over_floor_m = 0;
  ColourHistogram look{};
  float confidence = 0;  // 0 … 1: smoothed
  int hits = 0;          // frames in which it was seen
  int misses = 0;        // since it was seen last: frames in which it should have been
  Stamp first;
  Stamp last;        // seen
  float doubt = 1;   // 0 … 1: that all who sighted it were wrong, were they independent
  int in_parts = 0;  // frames in a row in which it was seen in pieces
  // What the two labels are decided by.
  Filter3 as_static;
  Filter6 as_moving;
  // Page's sum (1954) of how much likelier each sighting is under the other label; 0 while it is not.
  float against_label = 0;
  std::vector<Place> places;  // of the sightings since that sum was 0, oldest first
  std::uint32_t recent = 0;   // bit k: seen k frames ago
  bool is_cut = false;        // by the picture's border, when it was seen last
  Covariance3 measured_m2{};  // of the last sighting
  Point3 seen_from_m;         // where the camera was then
};

struct Tracks {
  std::vector<Track> list;  // by id, rising
  std::int64_t next = 1;
  Stamp stamp;  // of the frame that they are as of
  // More than half of the confirmed tracks, and two at least, began to move at once: rather the camera's
  // motion is wrong. No label was changed.
  bool odometry_suspect = false;
};

/// Which object covers which track's predicted mask, counted in pixels.
struct Overlaps {
  std::vector<TrackId> tracks;  // the rows, as Tracks::list
  std::vector<float> in_view;   // 0 … 1: share of each track's remembered points that lie in the picture
  std::vector<int> area;        // px that they cover there, if nothing hid them
  std::vector<int> predicted;   // px of each track's predicted mask: not hidden by another's
  std::vector<int> nearer;      // of these: hidden by something nearer than predicted, by 3 σ
  std::vector<int> common;      // tracks × objects, row by row; column 0 is ObjectId 1
  int objects = 0;
  [[nodiscard]] int at(std::size_t track, ObjectId object) const {
    return common[track * static_cast<std::size_t>(objects) + static_cast<std::size_t>(object) - 1];
  }
};

/// The objects that cover at least half of the predicted masks of two or more confirmed tracks, rising.
std::vector<ObjectId> joined_objects(const Tracks& tracks, const Overlaps& overlaps);

struct Match {
  TrackId track = TrackId::none;
  ObjectId object = ObjectId::none;
};

/// Which sighting is which track: minimum cost (Kuhn 1955) over place, size, look and overlap, in two rounds,
/// the surer objects first (Zhang et al. 2022, "ByteTrack"). Ties: the lower track, then the lower object.
/// A track that is seen in pieces has several matches, the one that counts first. By track, rising.
/// (docs/stages/tracking.md)
std::vector<Match> associate(const Tracks& tracks, const std::vector<Sighting>& sightings,
                             const Overlaps& overlaps, const Pose& map_from_camera,
                             const Covariance6& pose_covariance, Stamp now, const TrackingConfig& config);

/// What the tracks are after this frame: matched ones updated, others predicted and aged, new ones founded,
/// dead ones gone. `is_lost`: the camera's place is not known, all are predicted and none is updated.
Tracks advance_tracks(Tracks tracks, const std::vector<Sighting>& sightings,
                      const std::vector<Match>& matches, const Overlaps& overlaps,
                      const Pose& map_from_camera, const Covariance6& pose_covariance, bool is_lost,
                      Stamp now, const TrackingConfig& config);

}  // namespace cairn
