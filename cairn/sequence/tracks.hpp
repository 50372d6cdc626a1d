// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>
#include <cairn/pipeline/segment.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include <cairn/sequence/pose.hpp>

namespace cairn {

/// An object over time: an id is never reused in a run; none = no track.
enum class TrackId : std::int64_t { none = 0 };
constexpr std::int64_t number(TrackId id) {
  return static_cast<std::int64_t>(id);
}

struct TrackingConfig {
  int min_hits = 3;  // frames
  int max_age = 15;  // frames
  float low_confidence = 0.1F;
  float min_speed = 0.05F;  // m/s
  // Constants, not options.
  float gate = 11.34F;              // χ² of 3 degrees of freedom, 0.99
  float max_hidden = 30.0F;         // s out of view or occluded before a track ends
  float high_confidence = 0.4F;     // of objects that are matched first and start tracks
  float static_noise = 0.02F;       // m/√s; random walk of the position of a static object
  float acceleration_noise = 1.0F;  // m/s²; of a moving object
  float appearance_weight = 1.0F;   // of colours relative to position and size
};
template <class V>
void fields(TrackingConfig& c, V&& v) {
  v("min_hits", c.min_hits, "frames", "detections within five frames that confirm a track", range(1, 30));
  v("max_age", c.max_age, "frames", "largest number of misses in view before a track ends", range(1, 300));
  v("low_confidence", c.low_confidence, "", "smallest confidence of objects used for tracking",
    range(0.0F, c.high_confidence));
  v("min_speed", c.min_speed, "m/s", "smallest speed of a moving object", range(0.0F, 5.0F));
}

/// The centre of an object's visible surface is nearer to the camera than its own centre, by this share of its
/// width. Measured on 301 objects of the rendered rooms of the fit set: median 0.25, 16th and 84th percentile
/// 0.14 and 0.37; sideways 0.07 at the 84th.
namespace nearer_surface {
inline constexpr double kShare = 0.25;
inline constexpr double kSigma = 0.12;
}  // namespace nearer_surface

/// Colours in CIE L*a*b*: 8 bins of lightness, then 8×8 of a and b; each part sums to 1. For a grey image the
/// second part is one bin.
using ColourHistogram = std::array<float, 72>;
/// Bhattacharyya coefficient, mean of both parts, 0 … 1: 1 = equal.
float likeness(const ColourHistogram& a, const ColourHistogram& b);

/// One object of one frame, as input of tracking.
struct Detection {
  ObjectId object = ObjectId::none;
  bool has_place = false;  // whether position, covariance, extent and height are known, in metres
  Point3 position_in_camera_m;
  Covariance3 covariance_in_camera_m2{};  // of a change from frame to frame, for filters and matching
  Covariance3 steady_in_camera_m2{};      // of the error that persists while the same is seen
  Vec3 extent_m;                          // see Object::extent_in_camera_m
  float height_over_floor_m = 0;          // of the position; 0 without a floor
  ColourHistogram look{};
  float confidence = 0;
  int pixel_count = 0;
  Rect box_px;
  bool is_cut = false;  // touches the image border
};

/// The objects of a frame with at least low_confidence, by ObjectId. Without a rig, none has a position.
/// (docs/stages/tracking.md)
std::vector<Detection> detect(const Frame& frame, const LeftImage& left, const std::optional<StereoRig>& rig,
                              const TrackingConfig& config);

enum class TrackState : std::uint8_t { tentative, confirmed, occluded, out_of_view, lost, dead };
inline constexpr std::array kTrackStates{
    Choice{"tentative", TrackState::tentative}, Choice{"confirmed", TrackState::confirmed},
    Choice{"occluded", TrackState::occluded},   Choice{"out_of_view", TrackState::out_of_view},
    Choice{"lost", TrackState::lost},           Choice{"dead", TrackState::dead}};

/// The state of a Kalman filter: of a position, or of a position and a velocity.
struct Filter3 {
  Point3 position_m;
  Covariance3 covariance_m2{};
};
struct Filter6 {
  Point3 position_m;
  Point3 velocity_m_s;
  Covariance6 covariance{};  // position before velocity
};

/// A measured position and its stamp.
struct Place {
  Stamp stamp;
  Point3 position_m;
  Covariance3 covariance_m2{};
};

struct Track {
  TrackId id = TrackId::none;
  TrackState state = TrackState::tentative;
  bool is_moving = false;
  ObjectId object = ObjectId::none;  // in this frame; none = not seen
  std::vector<ObjectId> parts;       // further objects of this frame that are parts of the same object
  bool is_joined = false;            // merged with another track in this frame: no position
  bool has_place = false;            // whether it has a position, in metres
  // In the map frame; from the filter selected by the label. The covariance is relative to the camera's path;
  // covariance_in_map() adds the uncertainty of the path.
  Point3 position_m;
  Covariance3 covariance_m2{};
  Point3 velocity_m_s;
  Vec3 extent_m;
  float height_over_floor_m = 0;
  ColourHistogram look{};
  float confidence = 0;  // 0 … 1: smoothed
  int hits = 0;          // frames with a detection
  int misses = 0;        // frames since the last detection in which it should have been visible
  Stamp first;
  Stamp last;        // seen
  float doubt = 1;   // 0 … 1: probability that all detections were false, if independent
  int in_parts = 0;  // consecutive frames in which it was detected in parts
  // The data that decides between the two labels.
  Filter3 as_static;
  Filter6 as_moving;
  // Page's sum (1954) of the log-likelihood ratios in favour of the other label; never below 0.
  float against_label = 0;
  std::vector<Place> places;  // of the detections since that sum was 0, oldest first
  std::uint32_t recent = 0;   // bit k: detected k frames ago
  bool is_cut = false;        // by the image border, at the last detection
  Covariance3 measured_m2{};  // of the last detection: Sighting::steady_in_camera_m2, in the map
  Point3 seen_from_m;         // camera position at the last detection
};

/// Track::covariance_m2 with what the camera's pose leaves uncertain. `pose_covariance`: see Step.
Covariance3 covariance_in_map(const Track& track, const Pose& map_from_camera,
                              const Covariance6& pose_covariance);

struct Tracks {
  std::vector<Track> list;  // by id, rising
  std::int64_t next = 1;
  Stamp stamp;  // of the last frame
  // More than half of the confirmed tracks, at least two, began to move at once, so the camera motion is
  // probably wrong. No label was changed.
  bool odometry_suspect = false;
};

/// Overlaps of objects with the predicted masks of tracks, in pixels.
struct Overlaps {
  std::vector<TrackId> tracks;  // the rows, in the order of Tracks::list
  std::vector<float> in_view;   // 0 … 1: share of the remembered points of each track inside the image
  std::vector<int> area;        // px covered by them, ignoring occlusion
  std::vector<int>
      predicted;            // px of the predicted mask of each track, without parts occluded by other tracks
  std::vector<int> nearer;  // of these: occluded by something nearer than predicted, by 3 σ
  std::vector<int> common;  // tracks × objects, row-major; column 0 is ObjectId 1
  int objects = 0;
  [[nodiscard]] int at(std::size_t track, ObjectId object) const {
    return common[track * static_cast<std::size_t>(objects) + static_cast<std::size_t>(object) - 1];
  }
};

/// Whether an object covers at least half of the predicted mask of a track, by its index, and is not in front of it.
bool is_joined_with(const Overlaps& overlaps, std::size_t track, ObjectId object);
/// The objects that are joined with two or more confirmed tracks, ascending.
std::vector<ObjectId> joined_objects(const Tracks& tracks, const Overlaps& overlaps);

struct Assignment {
  TrackId track = TrackId::none;
  ObjectId object = ObjectId::none;
};

/// The tracks relative to a new keyframe, which has `key_covariance` relative to the one before (0 while it is
/// the same). In a new segment, earlier sightings are no evidence of movement.
Tracks rebased_to_keyframe(Tracks tracks, const Pose& map_from_camera, const Covariance6& key_covariance,
                           bool is_new_segment);

/// When and where the camera takes a frame.
struct CameraAt {
  Stamp now;
  Pose map_from_camera;
  Covariance6 pose_covariance{};  // since the keyframe
  bool is_lost = false;           // the pose is unknown
};

/// Assigns objects to tracks: minimum cost (Kuhn 1955) over position, size, appearance and overlap, in two
/// rounds, objects of high confidence first (Zhang et al. 2022, "ByteTrack"). Ties: the lower track, then the
/// lower object. A track detected in parts has several matches, the main one first. By track, ascending.
/// `pose_covariance`: of the pose relative to the keyframe, along the map's axes.
/// (docs/stages/tracking.md)
std::vector<Assignment> associate(const Tracks& tracks, const std::vector<Detection>& detections,
                                  const Overlaps& overlaps, const CameraAt& camera,
                                  const TrackingConfig& config);

/// The tracks after this frame: matched ones updated, others predicted and aged, new ones started, dead ones
/// removed. While the camera is lost, all tracks are predicted and none is updated.
Tracks advance_tracks(Tracks tracks, const std::vector<Detection>& detections,
                      const std::vector<Assignment>& matches, const Overlaps& overlaps,
                      const CameraAt& camera, const TrackingConfig& config);

}  // namespace cairn
