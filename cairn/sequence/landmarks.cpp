// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/landmarks.hpp>

#include <algorithm>
#include <cairn/io/image_files.hpp>
#include <cmath>
#include <numbers>

#include <cairn/sequence/changes.hpp>
#include <cairn/sequence/landmark_geometry.hpp>

namespace cairn {
namespace {

using landmarks::are_apart;
using landmarks::find_in;
using landmarks::find_moved;
using landmarks::floor_frames_at;
using landmarks::forget_vanished;
using landmarks::frames_of;
using landmarks::kFloorFrames;
using landmarks::kPositionAndYaw;
using landmarks::matrix;
using landmarks::Matrix3;
using landmarks::Matrix4;
using landmarks::Matrix6;
using landmarks::Placement;
using landmarks::point;
using landmarks::position_and_yaw;
using landmarks::Pull;
using landmarks::report_new;
using landmarks::vector;

constexpr double kLargestOdds = 5;
constexpr double kSeen = 0.85;
constexpr double kMissed = -0.4;
constexpr double kSeenThrough = -1.5;
constexpr double kGone = -2;
constexpr std::size_t kGoneFrames = 5;
constexpr double kThroughShare = 0.6;
constexpr double kThroughMargin = 0.3;  // added to the share visible through the place of a present object
constexpr int kMinPixels = 200;
constexpr double kLongUnseen_s = 5;
constexpr double kClosure_s = 5;
constexpr int kSteadyFrames = 5;

constexpr double kSigmaUp = 0.1;  // of an object's centre, as a share of its height

struct VisibleArea {
  int pixels = 0;
  Rect box;
};

double horizontal(Point3 a, Point3 b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// On the floor, along the worse axis. Legs and leaves that a mask loses make heights much less certain.
double largest_sigma(const Covariance3& covariance) {
  const Eigen::Matrix2d on_floor = matrix(covariance).topLeftCorner<2, 2>();
  return std::sqrt(
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(on_floor, Eigen::EigenvaluesOnly).eigenvalues()[1]);
}

int octant_of(Point3 landmark, Point3 camera) {
  constexpr double kEighth = std::numbers::pi / 4;
  const double angle = std::atan2(camera.y - landmark.y, camera.x - landmark.x);
  return (static_cast<int>(std::floor((angle + 2 * std::numbers::pi) / kEighth + 0.5)) + 8) % 8;
}

/// An exponential envelope: fast towards a new extreme, slow back.
void follow(double& bound, double value, bool down) {
  constexpr double kQuickly = 0.3;
  constexpr double kSlowly = 0.02;
  const bool is_beyond = down ? value < bound : value > bound;
  bound += (is_beyond ? kQuickly : kSlowly) * (value - bound);
}

TrackEvidence* evidence_of(LandmarksState& state, TrackId id) {
  for (TrackEvidence& evidence : state.tracks) {
    if (evidence.track == id) return &evidence;
  }
  return nullptr;
}

const Track* track_of(const Tracks& tracks, TrackId id) {
  const auto at = std::lower_bound(tracks.list.begin(), tracks.list.end(), id,
                                   [](const Track& t, TrackId wanted) { return t.id < wanted; });
  return at != tracks.list.end() && at->id == id ? &*at : nullptr;
}

Candidate candidate_of(const TrackEvidence& evidence, const Track& track) {
  Matrix3 covariance = matrix(track.covariance_m2);
  const double across = std::pow(nearer_surface::kSigma * evidence.size.widest_m, 2);
  const double up = std::pow(kSigmaUp * evidence.size.height_m, 2);
  covariance.diagonal() += Eigen::Vector3d(across, across, up);
  return {track.id,
          evidence.centre_m,
          landmarks::rows_of(covariance),
          evidence.size,
          evidence.height_over_floor_m,
          track.look};
}

LandmarkOfTrack of_track(const TrackEvidence& evidence) {
  return {evidence.track, evidence.landmark,
          evidence.landmark == LandmarkId::none ? evidence.refusal : LandmarkRefusal::none,
          evidence.is_recognised, evidence.score};
}

/// The centre of an object whose visible surface is where the track is.
Point3 centre_behind(const Track& track, Point3 camera) {
  Point3 away = track.position_m - camera;
  away.z = 0;
  const double distance = std::max(1e-6, length(away));
  return track.position_m +
         (nearer_surface::kShare * static_cast<double>(track.extent_m.x) / distance) * away;
}

// ---- one frame, step by step ----

void gather(TrackEvidence& evidence, const Track& track, const LandmarkFrame& frame, bool is_cut,
            const LandmarksConfig& config) {
  const Point3 camera = frame.odom_from_camera.translation_m;
  // Slow rolling, or being carried while hidden, may never raise the moving state.
  const double least = std::max(static_cast<double>(config.moved), evidence.size.widest_m);
  const bool has_left =
      evidence.landmark != LandmarkId::none && horizontal(track.position_m, evidence.stood_m) > least;
  if (track.is_moving || has_left) {
    const LandmarkId landmark = evidence.landmark;
    const std::optional<Landmark> before = evidence.before;
    evidence = {};
    evidence.track = track.id;
    evidence.landmark = landmark;
    evidence.before = before;
    evidence.is_recognised = before.has_value();
    evidence.was_moving = true;
    evidence.first = frame.stamp;
    evidence.stood_m = track.position_m;
    return;
  }
  if (evidence.frames == 0) {
    evidence.first_camera_m = camera;
    if (evidence.was_moving) evidence.first = frame.stamp;
  }
  ++evidence.frames;
  evidence.cut_ago = is_cut ? 0 : evidence.cut_ago + 1;
  evidence.baseline_m = std::max(evidence.baseline_m, length(camera - evidence.first_camera_m));
  const Point3 a = evidence.first_camera_m - track.position_m;
  const Point3 b = camera - track.position_m;
  const double cosine = dot(a, b) / std::max(1e-12, length(a) * length(b));
  evidence.angle_rad = std::max(evidence.angle_rad, std::acos(std::clamp(cosine, -1.0, 1.0)));
  if (is_cut) return;

  const auto across = static_cast<double>(track.extent_m.x);
  const auto height = static_cast<double>(track.extent_m.y);
  if (evidence.centres == 0) evidence.size = {across, across, height};
  follow(evidence.size.narrowest_m, across, true);
  follow(evidence.size.widest_m, across, false);
  follow(evidence.size.height_m, height, false);
  const Point3 centre = centre_behind(track, camera);
  // The track's filter averages noise; this averages over viewing directions.
  constexpr int kMax = 20;
  evidence.centres = std::min(evidence.centres + 1, kMax);
  evidence.centre_m = evidence.centre_m + (1.0 / evidence.centres) * (centre - evidence.centre_m);
  const auto over_floor = static_cast<double>(track.height_over_floor_m);
  if (evidence.height_over_floor_m == 0) evidence.height_over_floor_m = over_floor;
  if (over_floor != 0)
    evidence.height_over_floor_m += (over_floor - evidence.height_over_floor_m) / evidence.centres;
}

LandmarkRefusal refusal_of(const TrackEvidence& evidence, const Track& track, const LandmarksConfig& config) {
  const double angle = static_cast<double>(config.min_angle) * std::numbers::pi / 180;
  if (track.state == TrackState::tentative) return LandmarkRefusal::tentative;
  if (track.is_moving) return LandmarkRefusal::moving;
  if (evidence.frames < config.min_frames)
    return evidence.was_moving ? LandmarkRefusal::moving : LandmarkRefusal::too_few_frames;
  if (evidence.baseline_m < static_cast<double>(config.min_baseline) && evidence.angle_rad < angle)
    return LandmarkRefusal::one_viewpoint;
  if (evidence.cut_ago < kSteadyFrames || evidence.centres == 0) return LandmarkRefusal::unsteady;
  if (largest_sigma(track.covariance_m2) > static_cast<double>(config.max_sigma))
    return LandmarkRefusal::uncertain;
  return LandmarkRefusal::none;
}

/// Requires less than creating a landmark, since the map is further evidence of the object.
bool may_be_recognised(const TrackEvidence& evidence, const Track& track, const LandmarksConfig& config) {
  return track.state == TrackState::confirmed && !track.is_moving && track.object != ObjectId::none &&
         evidence.frames >= std::max(2, config.min_frames / 2) && evidence.cut_ago > 0 &&
         evidence.centres >= 2;
}

/// For localisation: requires certain positions, but not that all objects are in view at once.
bool may_tell_place(const TrackEvidence& evidence, const Track& track, const LandmarksConfig& config) {
  return track.state != TrackState::tentative && !track.is_moving && evidence.frames >= config.min_frames &&
         evidence.cut_ago > 0 && evidence.centres >= 2;
}

/// Stores the colours of an octant, and the crop if the view is clearly larger than the stored one.
void show(Landmark& landmark, const Track& track, const VisibleArea& shown, int octant,
          const LandmarkFrame& frame) {
  LandmarkLook& at = landmarks::look_from(landmark, octant);
  if (shown.pixels > at.pixels) at.colours = track.look;
  int largest = 0;
  for (const LandmarkLook& look : landmark.looks) {
    if (!look.crop_png.empty()) largest = look.crop_pixels;
  }
  at.pixels = std::max(at.pixels, shown.pixels);
  constexpr double kWorth = 1.5;  // least gain in area; encoding takes longer than the rest of this function
  if (frame.left.empty() && frame.left_rgb.empty()) return;
  if (shown.pixels < kWorth * largest || shown.pixels == 0) return;
  constexpr int kSide_px = 72;
  const int step = 1 + (std::max(shown.box.width, shown.box.height) - 1) / kSide_px;
  Image<Rgb> crop(Size{(shown.box.width + step - 1) / step, (shown.box.height + step - 1) / step});
  for (int y = 0; y < crop.height(); ++y) {
    for (int x = 0; x < crop.width(); ++x) {
      const int px = shown.box.x + x * step;
      const int py = shown.box.y + y * step;
      if (!frame.left_rgb.empty()) {
        crop(x, y) = frame.left_rgb(px, py);
      } else {
        const Gray grey = frame.left(px, py);
        crop(x, y) = {grey, grey, grey};
      }
    }
  }
  std::string png = io::png_bytes(std::as_const(crop).view());
  constexpr std::size_t kLargestCrop = 16384;
  if (png.size() > kLargestCrop) return;
  for (LandmarkLook& look : landmark.looks) look.crop_png.clear();
  at.crop_png = std::move(png);
  at.crop_pixels = shown.pixels;
}

/// Updates the landmark with the track's current estimates.
void update(Landmark& landmark, const TrackEvidence& evidence, const Track& track,
            const LandmarksState& state, const LandmarkFrame& frame) {
  const Candidate candidate = candidate_of(evidence, track);
  const Placement seen = landmarks::place(candidate, state.located);
  landmark.position_m = point(seen.position_m);
  landmark.covariance_m2 = landmarks::rows_of(seen.covariance_m2);
  landmark.size = evidence.size;
  if (candidate.height_over_floor_m > 0) landmark.height_over_floor_m = candidate.height_over_floor_m;
  if (evidence.before && evidence.frames_left.empty()) {  // else its old place is doubtful
    const Landmark& before = *evidence.before;
    const Matrix3 a = matrix(before.covariance_m2).inverse();
    const Matrix3 b = seen.covariance_m2.inverse();
    const Matrix3 both = (a + b).inverse();
    landmark.position_m = point(both * (a * vector(before.position_m) + b * seen.position_m));
    landmark.covariance_m2 = landmarks::rows_of(both);
    landmark.size.narrowest_m = std::min(landmark.size.narrowest_m, before.size.narrowest_m);
    landmark.size.widest_m = std::max(landmark.size.widest_m, before.size.widest_m);
    landmark.size.height_m = std::max(landmark.size.height_m, before.size.height_m);
  }
  landmark.last = frame.stamp;
  landmark.run = state.run;
}

void learn_floor(LandmarkMap& map, const LandmarkFrame& frame, const Pose& map_from_camera) {
  constexpr int kStep = 8;
  constexpr double kFlat_m = 0.04;
  constexpr float kReach = 25;  // baselines
  std::vector<FloorCell> cells;
  for (int y = kStep / 2; y < frame.disparity_px.height(); y += kStep) {
    for (int x = kStep / 2; x < frame.disparity_px.width(); x += kStep) {
      if (frame.ids(x, y) != TrackId::none) continue;
      const auto seen =
          frame.rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), frame.disparity_px(x, y));
      if (!seen || seen->z > kReach * frame.rig.baseline_m) continue;
      const Point3 at = map_from_camera(
          {static_cast<double>(seen->x), static_cast<double>(seen->y), static_cast<double>(seen->z)});
      if (std::abs(frame.height_m(*seen, at)) > kFlat_m) continue;
      cells.push_back(landmarks::cell_at(at));
    }
  }
  std::sort(cells.begin(), cells.end(), landmarks::is_before);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  for (FloorCell& cell : cells) cell.frames = 1;
  landmarks::add_floor(map, cells);
}

/// Adds the uncertainty that odometry gained since the anchor to that of the anchor. As a difference of
/// covariances, not a sum of increments, since odometry's covariance drops again when a keyframe is seen
/// again after a few dark frames.
void place_camera(LandmarksState& state, const LandmarkFrame& frame) {
  state.located.camera_in_odom_m = frame.odom_from_camera.translation_m;
  const Point3 way = state.located.camera_in_odom_m - state.anchor.camera_in_odom_m;
  // The difference may have negative eigenvalues, by rounding or if the pose at the anchor was less certain.
  const Matrix4 grown = landmarks::with_clamped_eigenvalues(
      Matrix4(position_and_yaw(frame.pose_covariance) -
              landmarks::carried(position_and_yaw(state.anchor_pose_covariance), way)),
      0);
  // The frames of odometry and map differ by a rotation about the vertical only.
  Matrix4 turn = Matrix4::Identity();
  turn.topLeftCorner<3, 3>() = Eigen::Map<const Matrix3>(state.located.map_from_odom.rotation.data());
  state.located.covariance = landmarks::rows_of(
      Matrix4(landmarks::carried(matrix(state.anchor.covariance), state.located.map_from_odom.rotated(way)) +
              turn * grown * turn.transpose()));
}

/// Requires that `state.located` comes from more than odometry.
void anchor_here(LandmarksState& state, const LandmarkFrame& frame) {
  state.anchor = state.located;
  state.anchor_pose_covariance = frame.pose_covariance;
}

/// Starts a segment that is tied to the map only by a guessed pose.
void begin_segment(LandmarksState& state, const LandmarkFrame& frame, const LandmarksConfig& config) {
  state.segment_began = frame.stamp;
  state.tracks.clear();
  state.closure.reset();
  if (!state.is_located) return;
  int present = 0;
  bool is_of_this_run = true;
  for (const Landmark& landmark : state.map.list) {
    present += landmark.is_gone ? 0 : 1;
    is_of_this_run &= std::binary_search(state.found.begin(), state.found.end(), landmark.id);
  }
  if (present >= std::min(config.relocation_pairs, std::max(2, config.min_pairs)) || !is_of_this_run) {
    state.is_located = false;
    state.has_guess = true;
    return;
  }
  // Too few landmarks to localise by: discard the map and start again with this segment.
  const std::int64_t next = state.map.next;
  state.map = {};
  state.map.next = next;
  state.found.clear();
  state.unreported.clear();
  state.vanished.clear();
  state.located.covariance = {};
  anchor_here(state, frame);
}

/// Corrects the pose by landmarks that were recognised together after a while.
void correct(LandmarksState& state, const LandmarkFrame& frame, const LandmarksConfig& config) {
  if (!state.closure || state.closure->last != frame.stamp) return;
  std::vector<Pull> pulls;
  MapLocation before = state.closure->before;
  before.camera_in_odom_m = state.located.camera_in_odom_m;
  MapLocation exact = before;
  exact.covariance = {};  // the pose's covariance is the prior, not part of the measurement
  for (const TrackId id : state.closure->tracks) {
    const TrackEvidence* evidence = evidence_of(state, id);
    const Track* track = track_of(*frame.tracks, id);
    if (evidence == nullptr || track == nullptr || !evidence->before) continue;
    pulls.push_back({landmarks::place(candidate_of(*evidence, *track), exact),
                     {vector(evidence->before->position_m), matrix(evidence->before->covariance_m2)}});
  }
  if (pulls.size() < static_cast<std::size_t>(config.min_pairs)) return;
  state.located = landmarks::corrected(before, pulls);
  anchor_here(state, frame);
}

void bind(LandmarksState& state, const LandmarkPair& pair, const LandmarkFrame& frame,
          std::vector<LandmarkEvent>& events) {
  TrackEvidence& evidence = *evidence_of(state, pair.track);
  Landmark& landmark = *find_in(state.map, pair.landmark);
  const bool is_long_unseen = landmark.run != state.run || landmark.last < state.segment_began ||
                              seconds_between(landmark.last, evidence.first) >= kLongUnseen_s;
  evidence.landmark = pair.landmark;
  evidence.is_recognised = true;
  evidence.score = pair.score;
  evidence.before = landmark;
  evidence.stood_m = track_of(*frame.tracks, pair.track)->position_m;
  if (landmark.is_gone) {
    landmark.is_gone = false;
    landmark.log_odds = 0;
    evidence.frames_left = frames_of(state, landmark.id);  // if it is back elsewhere, it was carried
    forget_vanished(state, landmark.id);
    events.push_back({LandmarkEventKind::back,
                      frame.stamp,
                      landmark.id,
                      landmark.position_m,
                      {},
                      pair.score,
                      {frame.index}});
  }
  if (!is_long_unseen) return;
  if (!state.closure || seconds_between(state.closure->last, frame.stamp) > kClosure_s)
    state.closure = LandmarksState::Closure{state.located, frame.stamp, {}};
  state.closure->last = frame.stamp;
  state.closure->tracks.push_back(pair.track);
}

/// Whether most places of landmarks that should be visible show what is behind them instead.
bool is_contradicted(const LandmarksState& state, const Recognition& found, const LandmarkFrame& frame) {
  std::size_t against = 0;
  for (const Landmark& landmark : state.map.list) {
    if (landmark.is_gone) continue;
    const Expectation there = expect(landmark, frame, *found.map_from_odom);
    if (there.in_view >= kMinPixels && there.farther > kThroughShare * there.samples()) ++against;
  }
  return against >= found.pairs.size();
}

/// The tracks of a frame that does not change the map.
std::vector<LandmarkOfTrack> unchanged_tracks(LandmarksState& state, const LandmarkFrame& frame) {
  std::vector<LandmarkOfTrack> all;
  for (const Track& track : frame.tracks->list) {
    const TrackEvidence* evidence = evidence_of(state, track.id);
    if (evidence == nullptr) {
      all.push_back({track.id, LandmarkId::none,
                     frame.is_lost ? LandmarkRefusal::not_located : LandmarkRefusal::tentative});
    } else if (frame.is_lost) {
      all.push_back({track.id, evidence->landmark, LandmarkRefusal::not_located});
    } else {
      all.push_back(of_track(*evidence));
    }
  }
  return all;
}

/// The frames in which free floor was seen at a new track and all around it: an object that stood there before, but was
/// not found, would have hidden the floor behind it.
int free_floor_before(const LandmarksState& state, const Track& track, const LandmarkFrame& frame) {
  constexpr int kAround = 8;
  const Point3 centre = centre_behind(track, frame.odom_from_camera.translation_m);
  const auto frames_at = [&](Point3 in_odom) {
    return floor_frames_at(state.map, landmarks::cell_at(state.located.map_from_odom(in_odom)));
  };
  const double radius_m = static_cast<double>(track.extent_m.x) / 2 + kFloorCell_m;
  int least = frames_at(centre);
  for (int k = 0; k < kAround; ++k) {
    const double angle = 2 * std::numbers::pi * k / kAround;
    least = std::min(least,
                     frames_at(centre + Point3{radius_m * std::cos(angle), radius_m * std::sin(angle), 0}));
  }
  return least;
}

/// Updates the evidence of each track.
void gather_all(LandmarksState& state, const LandmarkFrame& frame, const LandmarksConfig& config) {
  const Tracks& tracks = *frame.tracks;
  std::erase_if(state.tracks, [&](const TrackEvidence& e) { return track_of(tracks, e.track) == nullptr; });
  for (const Track& track : tracks.list) {
    auto at = std::lower_bound(state.tracks.begin(), state.tracks.end(), track.id,
                               [](const TrackEvidence& e, TrackId wanted) { return e.track < wanted; });
    if (at == state.tracks.end() || at->track != track.id) {
      TrackEvidence fresh;
      fresh.track = track.id;
      fresh.first = std::max(track.first, state.segment_began);
      if (state.is_located) fresh.floor_before = free_floor_before(state, track, frame);
      at = state.tracks.insert(at, fresh);
    }
    if (track.object == ObjectId::none) continue;
    const bool is_cut = std::find(frame.cut.begin(), frame.cut.end(), track.id) != frame.cut.end();
    gather(*at, track, frame, is_cut, config);
  }
}

/// Searches for the camera's place in the map.
void find_place(LandmarksState& state, const std::vector<Candidate>& candidates, const LandmarkFrame& frame,
                const LandmarksConfig& config, std::vector<LandmarkEvent>& events) {
  ++state.frames_not_located;
  const std::optional<MapLocation> guess = state.has_guess ? std::optional(state.located) : std::nullopt;
  const Recognition found = relocate(state.map, candidates, config, guess);
  if (!found.map_from_odom || is_contradicted(state, found, frame)) return;
  const Point3 guessed = (state.located.map_from_odom * frame.odom_from_camera).translation_m;
  state.is_located = true;
  state.has_guess = false;
  state.located.map_from_odom = *found.map_from_odom;
  // The pose was unknown and now comes from the landmarks alone.
  state.located.covariance = {};
  for (const std::size_t i : {0U, 5U, 10U}) state.located.covariance[i] = 1;
  state.located.covariance[15] = 0.1;
  anchor_here(state, frame);
  LandmarkEvent event;
  event.kind = LandmarkEventKind::relocated;
  event.stamp = frame.stamp;
  event.frames = {frame.index};
  double product = 1;
  for (const LandmarkPair& pair : found.pairs) product *= 1 - pair.score;
  event.probability = 1 - product;
  const std::size_t first = events.size();
  for (const LandmarkPair& pair : found.pairs) bind(state, pair, frame, events);
  correct(state, frame, config);
  event.position_m = (state.located.map_from_odom * frame.odom_from_camera).translation_m;
  event.moved_by_m = event.position_m - guessed;
  events.insert(events.begin() + static_cast<std::ptrdiff_t>(first), event);
}

/// Matches tracks with the map. Returns whether a landmark was recognised in a known place.
bool match(LandmarksState& state, const LandmarkFrame& frame, const LandmarksConfig& config,
           std::vector<LandmarkEvent>& events) {
  std::vector<Candidate> candidates;
  std::vector<LandmarkId> taken;
  for (const TrackEvidence& evidence : state.tracks) {
    const Track& track = *track_of(*frame.tracks, evidence.track);
    if (evidence.landmark != LandmarkId::none) {
      if (track.object != ObjectId::none) taken.push_back(evidence.landmark);
    } else if (state.is_located ? may_be_recognised(evidence, track, config)
                                : may_tell_place(evidence, track, config)) {
      candidates.push_back(candidate_of(evidence, track));
    }
  }
  if (!state.is_located) {
    find_place(state, candidates, frame, config, events);
    return false;
  }
  const Recognition found = recognise(state.map, candidates, state.located, taken, config);
  for (const LandmarkPair& pair : found.pairs) bind(state, pair, frame, events);
  correct(state, frame, config);
  return !found.pairs.empty();
}

/// The visible area of each track, in their order.
std::vector<VisibleArea> visible_areas(const LandmarkFrame& frame) {
  const Tracks& tracks = *frame.tracks;
  std::vector<VisibleArea> shown(tracks.list.size());
  for (int y = 0; y < frame.ids.height(); ++y) {
    const TrackId* row = frame.ids.row(y);
    std::size_t at = 0;
    for (int x = 0; x < frame.ids.width(); ++x) {
      if (row[x] == TrackId::none) continue;
      if (tracks.list[at].id != row[x]) {
        const Track* track = track_of(tracks, row[x]);
        if (track == nullptr) continue;
        at = static_cast<std::size_t>(track - tracks.list.data());
      }
      ++shown[at].pixels;
      shown[at].box = united(shown[at].box, {x, y, 1, 1});
    }
  }
  return shown;
}

/// Makes a landmark of a track that may be one, unless its place is taken or the map is full. Returns whether
/// it did.
bool add_landmark(LandmarksState& state, TrackEvidence& evidence, const Track& track,
                  const LandmarksConfig& config) {
  const Point3 here = point(landmarks::place(candidate_of(evidence, track), state.located).position_m);
  const bool is_beside =
      std::any_of(state.map.list.begin(), state.map.list.end(), [&](const Landmark& other) {
        return !other.is_gone &&
               horizontal(other.position_m, here) < std::max(other.size.widest_m, evidence.size.widest_m) / 2;
      });
  if (is_beside) {
    evidence.refusal = LandmarkRefusal::beside_known;
    return false;
  }
  if (state.map.list.size() >= static_cast<std::size_t>(config.max_known)) {
    evidence.refusal = LandmarkRefusal::map_full;
    return false;
  }
  Landmark fresh;
  fresh.id = LandmarkId{state.map.next++};
  fresh.first = evidence.first;
  state.map.list.push_back(fresh);
  state.found.push_back(fresh.id);
  if (evidence.floor_before >= kFloorFrames) state.unreported.push_back(fresh.id);
  evidence.landmark = fresh.id;
  evidence.stood_m = track.position_m;
  return true;
}

/// Ends the carrying of a landmark in view, by which its track shows that it is the same object.
void set_down(const LandmarksState& state, TrackEvidence& evidence, const Landmark& landmark,
              const Track& track, const LandmarkFrame& frame, const LandmarksConfig& config,
              std::vector<LandmarkEvent>& events) {
  evidence.was_moving = false;
  const Candidate candidate = candidate_of(evidence, track);
  const Placement here = landmarks::place(candidate, state.located);
  const Eigen::Vector3d way = here.position_m - vector(landmark.position_m);
  const Matrix3 covariance = here.covariance_m2 + matrix(landmark.covariance_m2);
  const bool is_same = score_of(candidate, landmark) >= static_cast<double>(config.min_score);
  if (!is_same || !are_apart(way, covariance, config)) return;
  events.push_back({LandmarkEventKind::moved,
                    frame.stamp,
                    landmark.id,
                    point(here.position_m),
                    point(way),
                    probability_of(landmark.log_odds),
                    {frame.index}});
  evidence.before.reset();
}

struct LandmarkRefresh {
  std::vector<LandmarkId> seen;
  bool has_added = false;
};

/// Whether a frame shows what is behind a landmark in its place.
bool is_seen_through(const Landmark& landmark, const Expectation& there) {
  const int samples = std::max(1, there.samples());
  const double farther = static_cast<double>(there.farther) / samples;
  return there.in_view >= kMinPixels && 2 * there.nearer <= samples &&
         farther >= std::max(kThroughShare, landmark.open_share + kThroughMargin);
}

/// A landmark that was recognised near its place, but apart from it by more than both uncertainties allow, was carried if
/// five frames show its own place empty.
void look_at_old_place(LandmarksState& state, TrackEvidence& evidence, const Track& track,
                       const LandmarkFrame& frame, const LandmarksConfig& config,
                       std::vector<LandmarkEvent>& events) {
  if (!evidence.before) return;
  const Landmark& before = *evidence.before;
  const Candidate candidate = candidate_of(evidence, track);
  const Placement here = landmarks::place(candidate, state.located);
  const Eigen::Vector3d way = here.position_m - vector(before.position_m);
  const double score = score_of(candidate, before);
  if (!are_apart(way, here.covariance_m2 + matrix(before.covariance_m2), config) ||
      score < static_cast<double>(config.min_score)) {
    evidence.frames_left.clear();
    return;
  }
  const Expectation there = expect(before, frame, state.located.map_from_odom);
  if (is_seen_through(before, there)) {
    evidence.frames_left.push_back(frame.index);
  } else if (2 * there.agree > there.samples()) {
    evidence.frames_left.clear();
  }
  if (evidence.frames_left.size() < kGoneFrames) return;
  const double was_there = before.is_gone ? 1 : probability_of(before.log_odds);
  events.push_back({LandmarkEventKind::moved, frame.stamp, before.id, point(here.position_m), point(way),
                    was_there * score, evidence.frames_left});
  evidence.before.reset();
  evidence.frames_left.clear();
  if (state.closure) std::erase(state.closure->tracks, evidence.track);
}

/// Creates landmarks, and updates those in view.
LandmarkRefresh update_seen(LandmarksState& state, const LandmarkFrame& frame, const LandmarksConfig& config,
                            std::vector<LandmarkEvent>& events) {
  LandmarkRefresh result;
  const std::vector<VisibleArea> shown = visible_areas(frame);
  for (TrackEvidence& evidence : state.tracks) {
    const Track& track = *track_of(*frame.tracks, evidence.track);
    const bool is_seen = track.object != ObjectId::none;
    evidence.refusal = refusal_of(evidence, track, config);
    if (evidence.refusal == LandmarkRefusal::none && !state.is_located)
      evidence.refusal = LandmarkRefusal::not_located;
    if (evidence.landmark == LandmarkId::none && evidence.refusal == LandmarkRefusal::none && is_seen)
      result.has_added |= add_landmark(state, evidence, track, config);
    if (evidence.landmark == LandmarkId::none || !is_seen || !state.is_located) continue;
    Landmark* landmark = find_in(state.map, evidence.landmark);
    if (landmark == nullptr) continue;
    result.seen.push_back(landmark->id);
    landmark->last = frame.stamp;
    landmark->run = state.run;
    if (track.is_moving || evidence.centres == 0) continue;
    if (evidence.was_moving) {
      if (evidence.refusal != LandmarkRefusal::none) continue;
      set_down(state, evidence, *landmark, track, frame, config, events);
    }
    look_at_old_place(state, evidence, track, frame, config, events);
    update(*landmark, evidence, track, state, frame);
    if (evidence.cut_ago > 0) {
      const Point3 camera = (state.located.map_from_odom * frame.odom_from_camera).translation_m;
      const auto at = static_cast<std::size_t>(&track - frame.tracks->list.data());
      show(*landmark, track, shown[at], octant_of(landmark->position_m, camera), frame);
    }
  }
  return result;
}

/// Weighs what a frame shows of a landmark that is not seen in it. Returns whether it became gone.
bool look_for(LandmarksState& state, Landmark& landmark, const Expectation& there, const LandmarkFrame& frame,
              std::vector<LandmarkEvent>& events) {
  const int samples = there.samples();
  if (landmark.is_gone || there.in_view < kMinPixels || 2 * there.nearer > samples) return false;
  ++landmark.expected;
  if (!is_seen_through(landmark, there)) {
    // Another object, or holes: weak evidence against it.
    if (2 * there.agree < samples) landmark.log_odds = std::max(landmark.log_odds + kMissed, -kLargestOdds);
    return false;
  }
  landmark.log_odds = std::max(landmark.log_odds + kSeenThrough, -kLargestOdds);
  ++landmark.seen_through;
  auto vanished = std::find_if(state.vanished.begin(), state.vanished.end(),
                               [&](const auto& v) { return v.landmark == landmark.id; });
  if (vanished == state.vanished.end()) vanished = state.vanished.insert(vanished, {landmark.id, {}});
  vanished->frames.push_back(frame.index);
  if (landmark.log_odds >= kGone || landmark.seen_through < static_cast<int>(kGoneFrames)) return false;
  landmark.is_gone = true;
  events.push_back({LandmarkEventKind::gone,
                    frame.stamp,
                    landmark.id,
                    landmark.position_m,
                    {},
                    probability_of(-landmark.log_odds),
                    vanished->frames});
  return true;
}

/// Updates which landmarks are present. Returns whether one became gone.
bool update_presence(LandmarksState& state, const std::vector<LandmarkId>& seen, const LandmarkFrame& frame,
                     std::vector<LandmarkEvent>& events) {
  bool has_gone = false;
  for (Landmark& landmark : state.map.list) {
    const Expectation there = expect(landmark, frame, state.located.map_from_odom);
    if (std::find(seen.begin(), seen.end(), landmark.id) == seen.end()) {
      has_gone |= look_for(state, landmark, there, frame, events);
      continue;
    }
    ++landmark.seen;
    ++landmark.expected;
    landmark.log_odds = std::min(landmark.log_odds + kSeen, kLargestOdds);
    landmark.seen_through = 0;
    forget_vanished(state, landmark.id);
    constexpr double kNew = 0.2;
    const double farther = static_cast<double>(there.farther) / std::max(1, there.samples());
    if (there.in_view > 0) landmark.open_share += kNew * (farther - landmark.open_share);
  }
  return has_gone;
}

}  // namespace

Covariance6 camera_covariance(const MapLocation& located, const Covariance6& pose_covariance) {
  // Roll and pitch come from odometry. Their correlations with the other components are dropped: they may be
  // inconsistent with the covariance from recognition.
  const Matrix3 attitude = matrix(pose_covariance).bottomRightCorner<3, 3>();
  Covariance6 all{};
  Eigen::Map<Matrix6> rows(all.data());
  rows.block<2, 2>(3, 3) =
      matrix(rotated(located.map_from_odom, landmarks::rows_of(attitude))).topLeftCorner<2, 2>();
  rows(kPositionAndYaw, kPositionAndYaw) = matrix(located.covariance);
  return all;
}

double probability_of(double log_odds) {
  return 1 / (1 + std::exp(-log_odds));
}

bool is_guessed(const LandmarkFrame& frame) {
  const bool is_refused =
      frame.motion_refusal != MotionRefusal::none && frame.motion_refusal != MotionRefusal::off;
  return is_refused || frame.odometry_suspect;
}

LandmarkFrame landmark_frame(const TrackedFrame& step, const StereoRig& rig, View<const Gray> left,
                             View<const Rgb> left_rgb) {
  LandmarkFrame frame;
  frame.index = step.index;
  frame.stamp = step.stamp;
  frame.odom_from_camera = step.map_from_camera;
  frame.pose_covariance = step.pose_covariance;
  frame.is_lost = step.is_lost;
  frame.motion_refusal = step.motion.refusal;
  frame.odometry_suspect = step.tracks.odometry_suspect;
  frame.is_keyframe = step.motion.is_new_keyframe;
  frame.is_new_segment = step.motion.is_new_segment;
  frame.tracks = &step.tracks;
  frame.ids = step.ids.view();
  frame.disparity_px = step.frame.disparity.disparity_px.view();
  frame.left = left;
  frame.left_rgb = left_rgb;
  frame.rig = rig;
  // Another plane than the floor of the map, such as a table or a ramp, tells no heights over it.
  constexpr double kSameFloor_m = 0.1, kUpright = 0.995;  // 6°
  frame.floor = floor_frame(step.frame.ground, rig);
  if (frame.floor) {
    const Vec3& up = frame.floor->up;
    const double height_m = step.map_from_camera.translation_m.z;
    if (std::abs(double{frame.floor->camera_height_m} - height_m) > kSameFloor_m ||
        step.map_from_camera.rotated({up.x, up.y, up.z}).z < kUpright)
      frame.floor.reset();
  }
  for (const Track& track : step.tracks.list) {
    if (track.object == ObjectId::none) continue;
    const auto at = static_cast<std::size_t>(track.object) - 1;
    if (at < step.frame.objects.list.size() && step.frame.objects.list[at].cut_share > 0)
      frame.cut.push_back(track.id);
  }
  return frame;
}

LandmarksState begin_landmarks(LandmarkMap map, std::int64_t run, const std::optional<Pose>& map_from_odom) {
  LandmarksState state;
  const bool is_empty = std::none_of(map.list.begin(), map.list.end(),
                                     [](const Landmark& landmark) { return !landmark.is_gone; });
  state.is_located = map_from_odom.has_value() || is_empty;
  if (map_from_odom) state.located.map_from_odom = *map_from_odom;
  state.map = std::move(map);
  state.run = run;
  return state;
}

LandmarkUpdate advance_landmarks(LandmarksState state, const LandmarkFrame& frame,
                                 const LandmarksConfig& config) {
  LandmarkUpdate result;
  if (!frame.is_lost) {
    place_camera(state, frame);
    if (frame.is_new_segment) begin_segment(state, frame, config);
  }
  // A dark image shows neither an object nor the background, and from a guessed pose everything seems moved.
  if (frame.is_lost || is_guessed(frame)) {
    result.tracks = unchanged_tracks(state, frame);
    result.state = std::move(state);
    return result;
  }

  gather_all(state, frame, config);
  const bool has_recognised = match(state, frame, config, result.events);
  const LandmarkRefresh updated = update_seen(state, frame, config, result.events);
  if (state.is_located) {
    const bool has_gone = update_presence(state, updated.seen, frame, result.events);
    learn_floor(state.map, frame, state.located.map_from_odom * frame.odom_from_camera);
    constexpr int kSometimes = 10;
    if (has_recognised || updated.has_added || has_gone || frame.index % kSometimes == 0) {
      for (LandmarkEvent& event : find_moved(state, frame, config)) result.events.push_back(std::move(event));
      for (LandmarkEvent& event : report_new(state, frame, config)) result.events.push_back(std::move(event));
    }
  }
  for (const TrackEvidence& evidence : state.tracks) result.tracks.push_back(of_track(evidence));
  result.state = std::move(state);
  return result;
}

}  // namespace cairn
