// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/input/sequence_scores.hpp>
#include <cmath>
#include <set>

namespace cairn::input {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kSettles = 8;       // frames until a motion label counts
constexpr std::int64_t kOutOfView = 10;    // frames
constexpr std::int64_t kInViewAgain = 10;  // frames
constexpr double kMovesMetres = 1e-3;      // per frame; small, as the truth is exact

/// A result frame and its truth.
struct Pair {
  const output::TrackFrame* ours = nullptr;
  const TrueFrame* truth = nullptr;
  std::int64_t index = 0;  // index of the truth
};

struct Result {
  output::TrackFile file;
  fs::path path;
  fs::path changes;  // its events.jsonl
  bool is_numbered = false;
};

Result load_result(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) throw Error(path.string() + ": no such file or folder");
  Result result;
  result.path = path;
  if (fs::is_directory(path, ignored)) {
    result.path = path / "tracks.jsonl";
    if (!fs::exists(result.path, ignored))
      throw Error(path.string() + ": has no tracks.jsonl, expected what cairn follow -o wrote");
  }
  result.is_numbered = result.path.extension() == ".txt";
  result.file = result.is_numbered ? output::load_mots(result.path) : output::load_tracks(result.path);
  result.changes = result.path.parent_path() / "events.jsonl";
  return result;
}

std::vector<Pair> pairs_of(const Result& result, const TrueSequence& truth, SequenceScores& scores) {
  const bool by_number = result.is_numbered || truth.is_numbered;
  std::map<std::string, std::size_t> names;
  for (std::size_t k = 0; k < truth.frames.size(); ++k) names[truth.frames[k].name] = k;
  std::vector<Pair> pairs;
  std::set<std::size_t> used;
  for (const output::TrackFrame& frame : result.file.frames) {
    std::optional<std::size_t> at;
    if (by_number) {
      if (static_cast<std::size_t>(frame.index) < truth.frames.size())
        at = static_cast<std::size_t>(frame.index);
    } else if (const auto found = names.find(frame.name); found != names.end()) {
      at = found->second;
    }
    if (!at) {
      scores.without_truth.push_back(frame.name);
      continue;
    }
    used.insert(*at);
    pairs.push_back({&frame, &truth.frames[*at], static_cast<std::int64_t>(*at)});
  }
  if (pairs.empty()) {
    throw Error(result.path.string() + ": its first frame is " + result.file.frames.front().name +
                ", that of the truth " + truth.frames.front().name + "; expected the same names");
  }
  for (std::size_t k = 0; k < truth.frames.size(); ++k) {
    if (!used.contains(k)) scores.without_result.push_back(truth.frames[k].name);
  }
  return pairs;
}

std::vector<output::TrackRecord> counted(const output::TrackFrame& frame, const ScoreOptions& options) {
  std::vector<output::TrackRecord> tracks;
  for (const output::TrackRecord& track : frame.tracks) {
    const bool is_sure = options.tentative || track.state != TrackState::tentative;
    if (track.mask && is_sure && !track.is_dont_care) tracks.push_back(track);
  }
  return tracks;
}

/// Track ids of a frame as object ids, which are small numbers.
Image<ObjectId> object_labels(const Image<TrackId>& tracks) {
  std::map<TrackId, ObjectId> ids{{TrackId::none, ObjectId::none}};
  Image<ObjectId> labels(tracks.size());
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      const auto next = ObjectId{static_cast<std::int32_t>(ids.size())};
      labels(x, y) = ids.emplace(tracks(x, y), next).first->second;
    }
  }
  return labels;
}

/// The first track of each track's last landmark. Tracks that were seen together in a frame remain distinct.
/// Empty without landmarks.
std::map<std::int64_t, std::int64_t> first_tracks(const output::TrackFile& file) {
  std::map<std::int64_t, std::int64_t> landmarks;  // by track; later frames correct earlier ones
  std::map<std::int64_t, std::set<std::int64_t>> frames;
  for (const output::TrackFrame& frame : file.frames) {
    for (const output::TrackRecord& track : frame.tracks) {
      if (track.landmark) landmarks[number(track.id)] = *track.landmark;
      if (track.mask) frames[number(track.id)].insert(frame.index);
    }
  }
  std::map<std::int64_t, std::vector<std::int64_t>> objects;  // the tracks of each landmark; ids ascend
  for (const auto& [track, landmark] : landmarks) objects[landmark].push_back(track);
  std::map<std::int64_t, std::int64_t> first;
  for (const auto& [landmark, tracks] : objects) {
    std::set<std::int64_t> seen;
    for (const std::int64_t track : tracks) {
      const std::set<std::int64_t>& own = frames[track];
      const bool is_apart =
          std::none_of(own.begin(), own.end(), [&](std::int64_t frame) { return seen.contains(frame); });
      if (!is_apart) continue;
      first[track] = tracks.front();
      seen.insert(own.begin(), own.end());
    }
  }
  return first;
}

std::vector<ScoredFrame> by_landmark(std::vector<ScoredFrame> frames,
                                     const std::map<std::int64_t, std::int64_t>& first) {
  for (ScoredFrame& frame : frames) {
    for (std::int64_t& id : frame.ours) {
      if (const auto found = first.find(id); found != first.end()) id = found->second;
    }
  }
  return frames;
}

void score_masks(const std::vector<Pair>& pairs, const Result& result, const ScoreOptions& options,
                 SequenceScores& scores) {
  ObjectErrorConfig config;
  config.min_area = options.min_area;
  std::vector<FrameObjects> objects;
  for (const Pair& pair : pairs) {
    const std::vector<output::TrackRecord> tracks = counted(*pair.ours, options);
    const std::string where = result.path.string() + ": frame " + pair.ours->name;
    Image<TruthId> truth = load_true_labels(*pair.truth);
    if (truth.empty() && !tracks.empty())
      truth = Image<TruthId>(tracks.front().mask->size, TruthId::none, {});
    const Image<TrackId> ours = output::track_labels(tracks, truth.size(), where);
    scores.scored.push_back(scored_frame(ours, truth, {options.min_area, pair.truth->is_partial}));
    if (truth.empty()) continue;
    const Image<ObjectId> labels = object_labels(ours);
    objects.push_back({object_errors(labels, truth, config), pair.truth->is_partial});
  }
  scores.tracks = track_errors(scores.scored);
  scores.oracle = track_errors(oracle_ids(scores.scored));
  if (const auto first = first_tracks(result.file); !first.empty())
    scores.by_landmark = track_errors(by_landmark(scores.scored, first));
  scores.steadiness = steadiness(scores.scored);
  scores.objects = summarise(objects);
}

const output::TrackRecord* record_of(const output::TrackFrame& frame, std::int64_t id) {
  const auto found = std::find_if(frame.tracks.begin(), frame.tracks.end(),
                                  [&](const output::TrackRecord& track) { return number(track.id) == id; });
  return found == frame.tracks.end() ? nullptr : &*found;
}

/// Calls visit(pair, true id, track, index of the pair) for each match.
template <class Visit>
void each_match(const std::vector<Pair>& pairs, const std::vector<ScoredFrame>& scored, const Visit& visit) {
  const std::vector<std::vector<int>> matches = clear_matches(scored);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    for (std::size_t i = 0; i < matches[k].size(); ++i) {
      if (matches[k][i] < 0) continue;
      const std::int64_t id = scored[k].ours[static_cast<std::size_t>(matches[k][i])];
      if (const output::TrackRecord* track = record_of(*pairs[k].ours, id))
        visit(pairs[k], scored[k].truth[i], *track);
    }
  }
}

/// Pose of the result's map in the truth's world, aligned at the first frame with both poses.
std::optional<Pose> world_from_map(const std::vector<Pair>& pairs) {
  for (const Pair& pair : pairs) {
    if (pair.ours->map_from_camera && pair.truth->world_from_camera)
      return *pair.truth->world_from_camera * inverse(*pair.ours->map_from_camera);
  }
  return std::nullopt;
}

PlaceErrors place_errors(const std::vector<Pair>& pairs, const SequenceScores& scores) {
  PlaceErrors errors;
  const std::optional<Pose> world = world_from_map(pairs);
  each_match(pairs, scores.scored, [&](const Pair& pair, std::int64_t id, const output::TrackRecord& track) {
    const auto place = pair.truth->places.find(id);
    if (place == pair.truth->places.end() || !place->second.visible_in_camera_m) return;
    if (track.state != TrackState::confirmed || !track.position_m || !pair.ours->map_from_camera) return;
    const Point3 visible = *place->second.visible_in_camera_m;
    errors.in_camera_m.push_back(length(inverse(*pair.ours->map_from_camera)(*track.position_m) - visible));
    if (!world || !pair.truth->world_from_camera) return;
    const Point3 error = *track.position_m - inverse(*world)((*pair.truth->world_from_camera)(visible));
    errors.in_map_m.push_back(length(error));
    if (!track.covariance_m2) return;
    ++errors.stated;
    errors.normalised.push_back(squared_mahalanobis(error, *track.covariance_m2));
    errors.inside += errors.normalised.back() <= kChi2Of3At95 ? 1 : 0;
  });
  return errors;
}

/// Which true objects move in which true frames.
class TrueMotion {
 public:
  explicit TrueMotion(const TrueSequence& truth) {
    is_known_ = truth.has_events;
    for (const TrueEvent& event : truth.events) {
      for (std::int64_t k = event.first_frame; event.is_in_view && k <= event.last_frame; ++k) {
        if (k < static_cast<std::int64_t>(truth.frames.size())) moves_[event.id].insert(k);
      }
    }
    if (!is_known_) from_places(truth);
  }
  [[nodiscard]] bool is_known() const { return is_known_; }
  [[nodiscard]] bool moves(std::int64_t id, std::int64_t frame) const {
    const auto found = moves_.find(id);
    return found != moves_.end() && found->second.contains(frame);
  }
  [[nodiscard]] bool rests(std::int64_t id, std::int64_t frame) const {
    for (std::int64_t k = frame - kSettles; k <= frame; ++k) {
      if (moves(id, k)) return false;
    }
    return true;
  }

 private:
  void from_places(const TrueSequence& truth) {
    for (std::size_t k = 1; k < truth.frames.size(); ++k) {
      for (const auto& [id, place] : truth.frames[k].places) {
        const auto before = truth.frames[k - 1].places.find(id);
        if (!place.in_world_m || before == truth.frames[k - 1].places.end() || !before->second.in_world_m)
          continue;
        is_known_ = true;
        if (length(*place.in_world_m - *before->second.in_world_m) > kMovesMetres)
          moves_[id].insert(static_cast<std::int64_t>(k));
      }
    }
  }

  std::map<std::int64_t, std::set<std::int64_t>> moves_;
  bool is_known_ = false;
};

MovingErrors moving_errors(const std::vector<Pair>& pairs, const TrueSequence& truth,
                           const SequenceScores& scores) {
  MovingErrors errors;
  const TrueMotion motion(truth);
  errors.is_known = motion.is_known();
  if (!errors.is_known) return errors;
  std::map<std::int64_t, std::int64_t> began;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    for (const std::int64_t id : scores.scored[k].truth) {
      if (!motion.moves(id, pairs[k].index)) continue;
      began.emplace(id, pairs[k].index);
      errors.frames_to_detect.emplace(id, std::nullopt);
    }
  }
  each_match(pairs, scores.scored, [&](const Pair& pair, std::int64_t id, const output::TrackRecord& track) {
    if (motion.moves(id, pair.index)) {
      ++errors.moving;
      errors.labelled += track.is_moving ? 1 : 0;
      auto& detected = errors.frames_to_detect[id];
      if (track.is_moving && !detected) detected = pair.index - began.at(id);
    } else if (motion.rests(id, pair.index)) {
      ++errors.at_rest;
      errors.labelled_wrong += track.is_moving ? 1 : 0;
    }
  });
  return errors;
}

std::int64_t most_frequent(const std::map<std::int64_t, int>& counts) {
  return std::max_element(counts.begin(), counts.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

/// A stay of an object in view, with no gap of kOutOfView frames.
struct Stretch {
  std::int64_t last = 0;
  std::int64_t frames = 0;
  std::map<std::int64_t, int> landmarks;  // number of frames for each landmark that its track has
};
using Stays = std::map<std::int64_t, std::vector<Stretch>>;  // of each object

Stays stays_of(const std::vector<Pair>& pairs, const SequenceScores& scores) {
  Stays objects;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    for (const std::int64_t id : scores.scored[k].truth) {
      std::vector<Stretch>& stretches = objects[id];
      if (stretches.empty() || pairs[k].index - stretches.back().last > kOutOfView) stretches.emplace_back();
      stretches.back().last = pairs[k].index;
      ++stretches.back().frames;
    }
  }
  return objects;
}

/// The object of each landmark: that which had it for the most frames of its first stay with landmarks.
std::map<std::int64_t, std::pair<std::int64_t, int>> owners_of(const Stays& objects) {
  std::map<std::int64_t, std::pair<std::int64_t, int>> owner;
  for (const auto& [id, stretches] : objects) {
    for (const Stretch& stretch : stretches) {
      if (stretch.landmarks.empty()) continue;
      for (const auto& [landmark, count] : stretch.landmarks) {
        auto& [best, frames] = owner[landmark];
        if (count > frames) best = id, frames = count;
      }
      break;
    }
  }
  return owner;
}

LandmarkErrors landmark_errors(const std::vector<Pair>& pairs, const SequenceScores& scores) {
  Stays objects = stays_of(pairs, scores);
  LandmarkErrors errors;
  each_match(pairs, scores.scored, [&](const Pair& pair, std::int64_t id, const output::TrackRecord& track) {
    if (!track.landmark) return;
    errors.is_known = true;
    for (Stretch& stretch : objects.at(id)) {
      if (pair.index <= stretch.last) {
        ++stretch.landmarks[*track.landmark];
        return;
      }
    }
  });
  const auto owner = owners_of(objects);
  for (const auto& [id, stretches] : objects) {
    std::optional<std::int64_t> known;
    for (const Stretch& stretch : stretches) {
      if (known && stretch.frames >= kInViewAgain) {
        ++errors.again;
        if (!stretch.landmarks.empty()) {
          const std::int64_t now = most_frequent(stretch.landmarks);
          errors.re_identified += stretch.landmarks.contains(*known) ? 1 : 0;
          const auto whose = owner.find(now);
          errors.wrong += whose != owner.end() && whose->second.first != id ? 1 : 0;
        }
      }
      if (!known && !stretch.landmarks.empty()) known = most_frequent(stretch.landmarks);
    }
  }
  return errors;
}

ChangeErrors change_errors(const Result& result, const std::vector<Pair>& pairs, const TrueSequence& truth,
                           const SequenceScores& scores) {
  ChangeErrors errors;
  std::error_code ignored;
  errors.is_known = truth.has_events && fs::exists(result.changes, ignored);
  if (!errors.is_known) return errors;
  // A change names a track or a landmark; it belongs to the object matched with it most often.
  std::map<std::int64_t, std::map<std::int64_t, int>> by_track;
  std::map<std::int64_t, std::map<std::int64_t, int>> by_landmark;
  each_match(pairs, scores.scored, [&](const Pair&, std::int64_t id, const output::TrackRecord& track) {
    ++by_track[number(track.id)][id];
    if (track.landmark) ++by_landmark[*track.landmark][id];
  });
  const auto object_of = [](const auto& counts, std::int64_t key) -> std::optional<std::int64_t> {
    const auto found = counts.find(key);
    return found == counts.end() ? std::nullopt : std::optional(most_frequent(found->second));
  };
  std::set<std::int64_t> found;
  const std::optional<Pose> world = world_from_map(pairs);
  const auto event_of = [&](std::int64_t id, bool is_in_view) -> const TrueEvent* {
    for (const TrueEvent& event : truth.events) {
      if (event.id == id && event.is_in_view == is_in_view) return &event;
    }
    return nullptr;
  };
  for (const TrueEvent& event : truth.events) errors.expected += event.is_in_view ? 0 : 1;
  for (const output::ChangeRecord& change : output::load_changes(result.changes)) {
    if (change.kind != "moved" && change.kind != "gone" && change.kind != "new") continue;
    std::optional<std::int64_t> id;
    if (change.track && number(*change.track) > 0) id = object_of(by_track, number(*change.track));
    if (!id && change.landmark) id = object_of(by_landmark, *change.landmark);
    if (id && event_of(*id, true) != nullptr) continue;
    ++errors.reported;
    const TrueEvent* event = id ? event_of(*id, false) : nullptr;
    if (event == nullptr) {
      ++errors.wrong;
      continue;
    }
    if (change.kind != "moved" || !found.insert(*id).second) continue;
    ++errors.found;
    if (!world || !change.from_m || !change.to_m || !event->from_m || !event->to_m) continue;
    const Point3 way = world->rotated(*change.to_m - *change.from_m);
    errors.errors_m.push_back(std::hypot(way.x - ((*event->to_m)[0] - (*event->from_m)[0]),
                                         way.y - ((*event->to_m)[1] - (*event->from_m)[1])));
  }
  return errors;
}

std::optional<TrajectoryError> trajectory(const std::vector<Pair>& pairs) {
  std::vector<TimedPose> ours;
  std::vector<TimedPose> truth;
  for (const Pair& pair : pairs) {
    if (!pair.truth->world_from_camera) continue;
    truth.push_back({pair.ours->stamp, *pair.truth->world_from_camera});
    if (pair.ours->map_from_camera) ours.push_back({pair.ours->stamp, *pair.ours->map_from_camera});
  }
  if (ours.size() < 2) return std::nullopt;
  return trajectory_error(ours, truth);
}

}  // namespace

SequenceScores score_sequence(const fs::path& path, const TrueSequence& truth, const ScoreOptions& options) {
  const Result result = load_result(path);
  SequenceScores scores;
  scores.name = path.string();
  scores.is_cut_off = result.file.is_cut_off;
  const std::vector<Pair> pairs = pairs_of(result, truth, scores);
  scores.frames = static_cast<int>(pairs.size());
  score_masks(pairs, result, options, scores);
  scores.places = place_errors(pairs, scores);
  scores.moving = moving_errors(pairs, truth, scores);
  scores.landmarks = landmark_errors(pairs, scores);
  scores.changes = change_errors(result, pairs, truth, scores);
  scores.trajectory = trajectory(pairs);
  return scores;
}

}  // namespace cairn::input
