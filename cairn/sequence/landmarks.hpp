// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <cairn/sequence/follower.hpp>
#include <cairn/sequence/landmarks_config.hpp>
#include <cairn/sequence/tracks.hpp>

namespace cairn {

/// A landmark of a map; ids are never reused; none = no landmark.
enum class LandmarkId : std::int64_t { none = 0 };
constexpr std::int64_t number(LandmarkId id) {
  return static_cast<std::int64_t>(id);
}

/// Why a track is not a landmark.
enum class LandmarkRefusal : std::uint8_t {
  none,
  tentative,       // not confirmed
  moving,          // or recently was
  too_few_frames,  // < min_frames
  one_viewpoint,   // neither min_baseline nor min_angle
  uncertain,       // standard deviation > max_sigma
  unsteady,        // cut by the image's border within its last five frames
  beside_known,    // its position is taken by another landmark
  not_located,     // unknown camera pose in the map: a loaded one, or after a new segment of odometry
  map_full         // max_known
};
inline constexpr std::array kLandmarkRefusals{Choice{"none", LandmarkRefusal::none},
                                              Choice{"tentative", LandmarkRefusal::tentative},
                                              Choice{"moving", LandmarkRefusal::moving},
                                              Choice{"too_few_frames", LandmarkRefusal::too_few_frames},
                                              Choice{"one_viewpoint", LandmarkRefusal::one_viewpoint},
                                              Choice{"uncertain", LandmarkRefusal::uncertain},
                                              Choice{"unsteady", LandmarkRefusal::unsteady},
                                              Choice{"beside_known", LandmarkRefusal::beside_known},
                                              Choice{"not_located", LandmarkRefusal::not_located},
                                              Choice{"map_full", LandmarkRefusal::map_full}};

/// The visible size of an object, excluding its unseen depth: viewpoints differ in the width they see.
struct SeenSize {
  double narrowest_m = 0;  // across the line of sight, over all viewpoints
  double widest_m = 0;
  double height_m = 0;
};

/// The appearance of a landmark from one side.
struct LandmarkLook {
  int octant = 0;  // 0 … 7: direction from the landmark to the camera, 45° each, from x of the map on
  ColourHistogram colours{};
  int pixels = 0;        // of the largest view
  std::string crop_png;  // of about the largest view of all octants, ≤ 16 kB; "" in the others
  int crop_pixels = 0;   // of the view in crop_png; not in the file: `pixels` after loading
};

/// A static object that is kept between runs. Position and covariance are those of its centre, in the map
/// frame (z up).
struct Landmark {
  LandmarkId id = LandmarkId::none;
  std::string name;  // set by the user
  bool is_gone = false;
  Point3 position_m;
  Covariance3 covariance_m2{};
  SeenSize size;
  double height_over_floor_m = 0;   // of the centre; 0 without a floor
  std::vector<LandmarkLook> looks;  // by octant, ascending
  double log_odds = 0;              // log-odds that it is still there, −5 … 5
  int seen = 0;                     // frames with a detection
  int expected = 0;                 // frames in which it was in view and not occluded
  int seen_through = 0;             // frames since the last detection that showed what is behind it
  double open_share = 0;  // 0 … 1: share of the silhouette that shows the background while it is present
  Stamp first;
  Stamp last;            // last detection
  std::int64_t run = 0;  // run of the last detection: stamps are comparable within a run only
};

/// The probability for a Landmark::log_odds, 0 … 1.
double probability_of(double log_odds);

/// A square of free floor, kFloorCell wide.
struct FloorCell {
  int x = 0;  // floor(x_m / kFloorCell)
  int y = 0;
  int frames = 0;
  friend constexpr bool operator==(FloorCell, FloorCell) = default;
};
inline constexpr double kFloorCell_m = 0.25;

/// The knowledge of a place.
struct LandmarkMap {
  std::vector<Landmark> list;    // by id, ascending
  std::int64_t next = 1;         // next id
  std::vector<FloorCell> floor;  // by x, then y
};
/// nullptr if there is none.
const Landmark* find(const LandmarkMap& map, LandmarkId id);

/// An object in view that may be a known landmark: centre in the odometry frame.
struct Candidate {
  TrackId track = TrackId::none;
  Point3 position_m;
  Covariance3 covariance_m2{};
  SeenSize size;
  double height_over_floor_m = 0;  // 0: unknown
  ColourHistogram colours{};
};

/// The colour similarity to the most similar view of the landmark, 0 … 1.
double score_of(const Candidate& candidate, const Landmark& landmark);
/// Whether sizes and heights are compatible. (Ignores the position.)
bool may_be(const Candidate& candidate, const Landmark& landmark);

struct LandmarkPair {
  TrackId track = TrackId::none;
  LandmarkId landmark = LandmarkId::none;
  double score = 0;
};

/// Why no landmark was recognised.
enum class RecognitionRefusal : std::uint8_t { none, no_candidates, too_few_pairs, ambiguous, contradicted };
inline constexpr std::array kRecognitionRefusals{Choice{"none", RecognitionRefusal::none},
                                                 Choice{"no_candidates", RecognitionRefusal::no_candidates},
                                                 Choice{"too_few_pairs", RecognitionRefusal::too_few_pairs},
                                                 Choice{"ambiguous", RecognitionRefusal::ambiguous},
                                                 Choice{"contradicted", RecognitionRefusal::contradicted}};

struct Recognition {
  std::vector<LandmarkPair> pairs;    // by track
  std::optional<Pose> map_from_odom;  // after a relocation
  RecognitionRefusal refusal = RecognitionRefusal::none;
};

/// The pose of the odometry frame in the map, if known.
struct MapLocation {
  Pose map_from_odom;
  /// Covariance of x, y, z (m) and yaw (rad) of the camera in the map, row-major.
  std::array<double, 16> covariance{};
  Point3 camera_in_odom_m;
};

/// The covariance of the camera pose in the map, along the axes of the map: x, y, z and yaw from `located`,
/// which includes odometry and recognition; roll and pitch from odometry, whose `pose_covariance` is along
/// the axes of its own frame.
Covariance6 camera_covariance(const MapLocation& located, const Covariance6& pose_covariance);

/// Matches candidates to landmarks with a known pose: position, size and height exclude, colours decide. A
/// candidate and a landmark are paired if each is the best match of the other. Landmarks in `taken` are left
/// out.
Recognition recognise(const LandmarkMap& map, const std::vector<Candidate>& candidates,
                      const MapLocation& located, const std::vector<LandmarkId>& taken,
                      const LandmarksConfig& config);

/// The same with an unknown pose: the largest constellation of pairs with consistent mutual distances. It has at least
/// `relocation_pairs`, twice as many consistent distances as any other place, and so many pairs that chance hardly
/// gives them, given what is known of free floor. `guess`: a probable pose; a place within its 95 % needs only
/// `min_pairs`. The pose is a rotation about z and a translation. Otherwise a refusal.
Recognition relocate(const LandmarkMap& map, const std::vector<Candidate>& candidates,
                     const LandmarksConfig& config, const std::optional<MapLocation>& guess = std::nullopt);

/// The input of landmarks for one frame. Views are borrowed for the call.
struct LandmarkFrame {
  int index = 0;
  Stamp stamp;
  Pose odom_from_camera;
  Covariance6 pose_covariance{};
  bool is_lost = false;
  MotionRefusal motion_refusal = MotionRefusal::none;
  bool odometry_suspect = false;  // most tracks contradict the motion
  bool is_keyframe = false;
  bool is_new_segment = false;  // see Motion
  const Tracks* tracks = nullptr;
  std::vector<TrackId> cut;  // touch the image border
  View<const TrackId> ids;
  View<const float> disparity_px;
  View<const Gray> left;     // for crops; may be empty
  View<const Rgb> left_rgb;  // may be empty
  StereoRig rig;
  std::optional<FloorFrame> floor;  // as this frame shows it; the map's pitch drifts

  /// The height of a point over the floor of this frame, or else over that of the map.
  [[nodiscard]] double height_m(Vec3 in_camera_m, Point3 in_map_m) const {
    return floor ? double{floor->to_floor(in_camera_m).z} : in_map_m.z;
  }
};
/// Whether the motion of the frame was refused or is doubtful: its pose is then a guess, even with wheel
/// odometry, and the frame is not used to judge the map. `off` is not a refusal: poses are known, or not
/// needed.
bool is_guessed(const LandmarkFrame& frame);
/// Borrows from `step` and the images.
LandmarkFrame landmark_frame(const TrackedFrame& step, const StereoRig& rig, View<const Gray> left,
                             View<const Rgb> left_rgb);

/// Pixels of the silhouette of a landmark, by their content in the frame.
struct Expectation {
  int in_view = 0;  // px at image scale; 0: out of view
  int agree = 0;    // samples
  int nearer = 0;
  int farther = 0;
  int unknown = 0;
  [[nodiscard]] int samples() const { return agree + nearer + farther + unknown; }
};
/// The landmark as an upright ellipsoid, projected into the frame. Empty unless most of it is in view.
Expectation expect(const Landmark& landmark, const LandmarkFrame& frame, const Pose& map_from_odom);

enum class LandmarkEventKind : std::uint8_t { found, moved, gone, back, relocated };
inline constexpr std::array kLandmarkEventKinds{
    Choice{"new", LandmarkEventKind::found}, Choice{"moved", LandmarkEventKind::moved},
    Choice{"gone", LandmarkEventKind::gone}, Choice{"back", LandmarkEventKind::back},
    Choice{"relocated", LandmarkEventKind::relocated}};

struct LandmarkEvent {
  LandmarkEventKind kind = LandmarkEventKind::found;
  Stamp stamp;
  LandmarkId landmark = LandmarkId::none;  // none for `relocated`
  Point3 position_m;                       // present position in the map
  Point3 moved_by_m;                       // of `moved` and `relocated`
  double probability = 0;
  std::vector<int> frames;  // the frames with this event
};

/// The data gathered about a track until it becomes a landmark.
struct TrackEvidence {
  TrackId track = TrackId::none;
  int frames = 0;
  Stamp first;
  Point3 first_camera_m;
  double baseline_m = 0;
  double angle_rad = 0;
  int cut_ago = 1000;  // frames
  int centres = 0;
  Point3 centre_m;  // in the odometry frame; mean
  SeenSize size;
  double height_over_floor_m = 0;  // mean; 0: no floor
  LandmarkId landmark = LandmarkId::none;
  LandmarkRefusal refusal = LandmarkRefusal::none;
  bool is_recognised = false;  // matched to an earlier landmark
  bool was_moving = false;
  Point3 stood_m;                  // position of the track when it became static, in the odometry frame
  int floor_before = 0;            // earlier frames with free floor all over its place
  std::optional<Landmark> before;  // the landmark as it was before this track, for a recognised one
  std::vector<int> frames_left;    // in which its place was seen empty, though it is elsewhere
  double score = 0;
};

/// The state of landmarks between frames, a value.
struct LandmarksState {
  LandmarkMap map;
  std::int64_t run = 0;
  bool is_located = true;
  MapLocation located;
  // The last pose known from more than odometry, and odometry's own covariance of its pose then.
  MapLocation anchor;
  Covariance6 anchor_pose_covariance{};
  Stamp segment_began{std::numeric_limits<std::int64_t>::min()};
  bool has_guess = false;             // not located, but `located` is a guess: a new segment of odometry
  std::vector<TrackEvidence> tracks;  // by id, ascending
  struct Closure {                    // landmarks recognised together
    MapLocation before;
    Stamp last;
    std::vector<TrackId> tracks;
  };
  std::optional<Closure> closure;
  struct VanishedLandmark {
    LandmarkId landmark = LandmarkId::none;
    std::vector<int> frames;
  };
  std::vector<VanishedLandmark> vanished;  // gone in this run, or about to be
  std::vector<LandmarkId> found;           // in this run, ascending
  std::vector<LandmarkId> unreported;      // of these: on previously free floor
  int frames_not_located = 0;

  /// The odometry frame in the map; nullopt if unknown.
  [[nodiscard]] std::optional<Pose> map_from_odom() const {
    return is_located ? std::optional(located.map_from_odom) : std::nullopt;
  }
};

/// An empty map gets its own frame. In a map with landmarks the camera pose is known only from
/// `map_from_odom`; otherwise it is searched for.
LandmarksState begin_landmarks(LandmarkMap map, std::int64_t run,
                               const std::optional<Pose>& map_from_odom = std::nullopt);

struct LandmarkOfTrack {
  TrackId track = TrackId::none;
  LandmarkId landmark = LandmarkId::none;
  LandmarkRefusal refusal = LandmarkRefusal::none;
  bool is_recognised = false;  // it was in the map before the track started
  double score = 0;            // of the recognition
};

struct LandmarkUpdate {
  LandmarksState state;
  std::vector<LandmarkOfTrack> tracks;  // in the order of frame.tracks
  std::vector<LandmarkEvent> events;    // of this frame
};

/// The map after this frame; unchanged if the frame is lost or is_guessed(). After a new segment of odometry,
/// tracks belong to the map again once enough landmarks locate the segment in it; a map that is too small to
/// do so, if it is entirely of this run, starts again.
/// (docs/stages/landmarks.md)
LandmarkUpdate advance_landmarks(LandmarksState state, const LandmarkFrame& frame,
                                 const LandmarksConfig& config);

/// The changes at the end of a run: the last event of each landmark, without those that went and came back.
std::vector<LandmarkEvent> changes_of(const std::vector<LandmarkEvent>& events);

/// Where a map was placed in another one; nowhere without `map_from_other`.
struct PlacedMap {
  std::optional<Pose> map_from_other;
  std::vector<LandmarkPair> pairs;  // landmark of the other map (as track number), landmark of the merged one
  RecognitionRefusal refusal = RecognitionRefusal::none;
  std::vector<LandmarkPair> landmarks = {};  // the same of every landmark of the other map, paired or added
};
/// `other` transformed into the frame of `map` by relocation, recognised landmarks merged, the others added.
/// `map_from_other`: the transform, if known. `guess`: a probable one, see relocate().
struct MapMerge : PlacedMap {
  LandmarkMap map;
};
MapMerge merge(LandmarkMap map, const LandmarkMap& other, const std::optional<Pose>& map_from_other,
               const LandmarksConfig& config, const std::optional<Pose>& guess = std::nullopt);
/// The same for two copies of one map: landmarks that existed when it was copied are paired by id, and the
/// newer record is kept (by run, then by last detection); landmarks added since are recognised or added.
MapMerge merge_copies(LandmarkMap map, const LandmarkMap& other, const LandmarksConfig& config);

struct MapToMerge {
  LandmarkMap map;
  bool is_copy = false;                     // of the map that it is merged into: then its pose is that map's
  std::optional<Pose> map_from_other = {};  // if known
  std::optional<Pose> guess = {};           // where it was before: fewer landmarks confirm it
};
struct MapsMerge {
  LandmarkMap map;
  std::vector<PlacedMap> placed;  // in the order of `others`
};
/// merge() and merge_copies() of several maps, in the frame of `map`: first copies, then those with a known pose, then
/// the others, those with the most landmarks first. Each is compared with all that is there already, so two that have
/// nothing in common may be joined by a third. A map without a place is left out.
MapsMerge merge_all(LandmarkMap map, const std::vector<MapToMerge>& others, const LandmarksConfig& config);

}  // namespace cairn
