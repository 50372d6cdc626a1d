// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/stereo_pair.hpp>
#include <optional>
#include <string>
#include <vector>

#include "../tracking/follower.hpp"
#include "../tracking/landmarks_config.hpp"
#include "../tracking/tracks.hpp"

namespace cairn {

/// A landmark of a map, never used twice; none = no landmark.
enum class LandmarkId : std::int64_t { none = 0 };
constexpr std::int64_t number(LandmarkId id) {
  return static_cast<std::int64_t>(id);
}

/// Why a track is no landmark.
enum class LandmarkRefusal : std::uint8_t {
  none,
  tentative,       // not confirmed
  moving,          // or was a moment ago
  too_few_frames,  // < min_frames
  one_viewpoint,   // neither min_baseline nor min_angle
  uncertain,       // standard deviation > max_sigma
  unsteady,        // cut by the image's border within its last five frames
  beside_known,    // its place is taken by a landmark that it is not
  not_located,     // a loaded map, in which the camera's place is not known
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

/// A thing's size as seen, without a claim about the side that was not: viewpoints differ in what is across.
struct SeenSize {
  double narrowest_m = 0;  // across the line of sight, over all viewpoints
  double widest_m = 0;
  double height_m = 0;
};

/// What a landmark looks like from one side.
struct LandmarkLook {
  int octant = 0;  // 0 … 7: direction from the landmark to the camera, 45° each, from the map's x on
  ColourHistogram colours{};
  int pixels = 0;        // of the largest view
  std::string crop_png;  // of the largest view over all octants, ≤ 16 kB; "" in the others
};

/// A static object that is remembered from run to run. Position and covariance are those of its centre, in
/// the frame of the map (z up).
struct Landmark {
  LandmarkId id = LandmarkId::none;
  std::string name;  // by hand
  bool is_gone = false;
  Point3 position_m;
  Covariance3 covariance_m2{};
  SeenSize size;
  double height_over_floor_m = 0;   // of its centre; 0 without a floor
  std::vector<LandmarkLook> looks;  // by octant, rising
  double log_odds = 0;              // that it is still there, −5 … 5
  int seen = 0;                     // frames
  int expected = 0;                 // frames in which it was in view, and nothing nearer hid it
  int seen_through = 0;             // frames since it was last seen that showed what lies behind it
  double open_share = 0;            // 0 … 1: of its silhouette, what shows farther things while it is there
  Stamp first;
  Stamp last;            // seen
  std::int64_t run = 0;  // in which it was seen last: stamps are compared within a run only
};

/// What Landmark::log_odds says, 0 … 1.
double probability_of(double log_odds);

/// A square of the floor, kFloorCell wide, on which nothing stood.
struct FloorCell {
  int x = 0;  // floor(x_m / kFloorCell)
  int y = 0;
  int frames = 0;
  friend constexpr bool operator==(FloorCell, FloorCell) = default;
};
inline constexpr double kFloorCell_m = 0.25;

/// What is known of a place.
struct LandmarkMap {
  std::vector<Landmark> list;    // by id, rising
  std::int64_t next = 1;         // id
  std::vector<FloorCell> floor;  // by x, then y
};
/// nullptr where there is none.
const Landmark* find(const LandmarkMap& map, LandmarkId id);

/// A thing now in view that may be a landmark: centre in the odometry's frame.
struct Candidate {
  TrackId track = TrackId::none;
  Point3 position_m;
  Covariance3 covariance_m2{};
  SeenSize size;
  double height_over_floor_m = 0;  // 0: not known
  ColourHistogram colours{};
};

/// Colours' likeness to the view of the landmark that is most alike, 0 … 1.
double score_of(const Candidate& candidate, const Landmark& landmark);
/// Whether sizes and heights allow the two to be the same thing. (The position is not asked.)
bool may_be(const Candidate& candidate, const Landmark& landmark);

struct LandmarkPair {
  TrackId track = TrackId::none;
  LandmarkId landmark = LandmarkId::none;
  double score = 0;
};

/// Why nothing was recognised.
enum class RecognitionRefusal : std::uint8_t { none, no_candidates, too_few_pairs, ambiguous, contradicted };
inline constexpr std::array kRecognitionRefusals{Choice{"none", RecognitionRefusal::none},
                                                 Choice{"no_candidates", RecognitionRefusal::no_candidates},
                                                 Choice{"too_few_pairs", RecognitionRefusal::too_few_pairs},
                                                 Choice{"ambiguous", RecognitionRefusal::ambiguous},
                                                 Choice{"contradicted", RecognitionRefusal::contradicted}};

struct Recognition {
  std::vector<LandmarkPair> pairs;    // by track
  std::optional<Pose> map_from_odom;  // of a relocation
  RecognitionRefusal refusal = RecognitionRefusal::none;
};

/// Where the odometry's frame lies in the map, as far as known.
struct Located {
  Pose map_from_odom;
  /// Of x, y, z (m) and yaw (rad) of the camera in the map, row by row.
  std::array<double, 16> covariance{};
  Point3 camera_in_odom_m;
};

/// Of a camera's pose in the map, both halves along the map's axes: x, y, z and yaw as `located` has them,
/// which holds all that odometry added and recognition took away; roll and pitch from odometry, whose
/// `pose_covariance` lies along the axes of its own frame.
Covariance6 camera_covariance(const Located& located, const Covariance6& pose_covariance);

/// Which candidate is which landmark where the pose is known: position, size and height veto, colours decide.
/// A candidate and a landmark are paired where each is the other's best. Landmarks in `taken` are left out.
Recognition recognise(const LandmarkMap& map, const std::vector<Candidate>& candidates,
                      const Located& located, const std::vector<LandmarkId>& taken,
                      const LandmarksConfig& config);

/// The same where the pose is not known: the largest constellation of pairs whose mutual distances agree, at
/// least `relocation_pairs`, with twice the agreeing distances of any other place. The pose is that of a
/// rotation about z and a translation. Else a refusal: not known where.
Recognition relocate(const LandmarkMap& map, const std::vector<Candidate>& candidates,
                     const LandmarksConfig& config);

/// A frame as landmarks see it. Views are borrowed for the call.
struct LandmarkFrame {
  int index = 0;
  Stamp stamp;
  Pose odom_from_camera;
  Covariance6 pose_covariance{};
  bool is_lost = false;
  MotionRefusal motion_refusal = MotionRefusal::none;
  bool odometry_suspect = false;  // most tracks were not where the motion would have them
  bool is_keyframe = false;
  const Tracks* tracks = nullptr;
  std::vector<TrackId> cut;  // touch the image's border
  View<const TrackId> ids;
  View<const float> disparity_px;
  View<const Gray> left;     // for crops; may be empty
  View<const Rgb> left_rgb;  // may be empty
  StereoRig rig;
};
/// Whether the frame's own motion was refused or is in doubt: its pose is then a guess, also where the wheels
/// made it, and what it shows says nothing of the map. `off` is no refusal: poses are known, or none is
/// asked.
bool is_guessed(const LandmarkFrame& frame);
/// Borrows from `step` and the pictures.
LandmarkFrame landmark_frame(const Step& step, const StereoRig& rig, View<const Gray> left,
                             View<const Rgb> left_rgb);

/// Pixels of a landmark's silhouette by what the frame shows there.
struct Expectation {
  int in_view = 0;  // px at the picture's scale; 0: out of view
  int agree = 0;    // samples
  int nearer = 0;
  int farther = 0;
  int unknown = 0;
  [[nodiscard]] int samples() const { return agree + nearer + farther + unknown; }
};
/// The landmark as an upright ellipsoid, seen by the frame. An empty one where less than most of it is in
/// view.
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
  Point3 position_m;                       // in the map: now
  Point3 moved_by_m;                       // of `moved` and `relocated`
  double probability = 0;
  std::vector<int> frames;  // that show it
};

/// What is gathered about a track on its way to a landmark.
struct TrackEvidence {
  TrackId track = TrackId::none;
  int frames = 0;
  Stamp first;
  Point3 first_camera_m;
  double baseline_m = 0;
  double angle_rad = 0;
  int cut_ago = 1000;  // frames
  int centres = 0;
  Point3 centre_m;  // in the odometry's frame; mean
  SeenSize size;
  double height_over_floor_m = 0;  // mean; 0: no floor
  LandmarkId landmark = LandmarkId::none;
  LandmarkRefusal refusal = LandmarkRefusal::none;
  bool is_recognised = false;  // an earlier landmark, not its own
  bool was_moving = false;
  Point3 stood_m;                  // where the track was when it began to stand, in the odometry's frame
  int floor_before = 0;            // frames that had seen bare floor at its place before
  std::optional<Landmark> before;  // the landmark as it was before this track, for a recognised one
  double score = 0;
};

/// All that landmarks remember between frames: a value.
struct LandmarksState {
  LandmarkMap map;
  std::int64_t run = 0;
  bool is_located = true;
  Located located;
  std::array<double, 16> pose_covariance_before{};
  std::vector<TrackEvidence> tracks;  // by id, rising
  struct Closure {                    // landmarks recognised together
    Located before;
    Stamp last;
    std::vector<TrackId> tracks;
  };
  std::optional<Closure> closure;
  struct Vanished {
    LandmarkId landmark = LandmarkId::none;
    std::vector<int> frames;
  };
  std::vector<Vanished> vanished;      // gone in this run, or on the way
  std::vector<LandmarkId> found;       // in this run, rising
  std::vector<LandmarkId> unreported;  // of these: where floor had been seen
  int frames_not_located = 0;
};

/// An empty map is its own frame. In one with landmarks the camera's place is known only where
/// `map_from_odom` says it; else it is looked for.
LandmarksState begin_landmarks(LandmarkMap map, std::int64_t run,
                               const std::optional<Pose>& map_from_odom = std::nullopt);

struct LandmarkOfTrack {
  TrackId track = TrackId::none;
  LandmarkId landmark = LandmarkId::none;
  LandmarkRefusal refusal = LandmarkRefusal::none;
  bool is_recognised = false;  // it was in the map before the track began
  double score = 0;            // of the recognition
};

struct Landmarked {
  LandmarksState state;
  std::vector<LandmarkOfTrack> tracks;  // as frame.tracks
  std::vector<LandmarkEvent> events;    // of this frame
};

/// What the map is after this frame; as before where the frame is lost or is_guessed().
/// (docs/stages/landmarks.md)
Landmarked advance_landmarks(LandmarksState state, const LandmarkFrame& frame, const LandmarksConfig& config);

/// The changes that stand at the end of a run: the last word about each landmark, without those that went and
/// came back.
std::vector<LandmarkEvent> changes_of(const std::vector<LandmarkEvent>& events);

/// `other` brought into `map`'s frame by relocation, recognised landmarks united, the others added.
/// `map_from_other`: where the frames lie; looked for where not given.
struct Merged {
  LandmarkMap map;
  std::vector<LandmarkPair> pairs;  // landmark of `other` (as track number), landmark of `map`
  std::optional<Pose> map_from_other;
  RecognitionRefusal refusal = RecognitionRefusal::none;
};
Merged merge(LandmarkMap map, const LandmarkMap& other, const std::optional<Pose>& map_from_other,
             const LandmarksConfig& config);
/// The same for two copies of one map: landmarks of both that the copying found there are paired by id, and
/// the newer record of the two is kept (by run, then by when it was last seen); what either learned since is
/// recognised or added.
Merged merge_copies(LandmarkMap map, const LandmarkMap& other, const LandmarksConfig& config);

}  // namespace cairn
