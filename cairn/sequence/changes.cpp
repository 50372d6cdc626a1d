// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/changes.hpp>

#include <algorithm>
#include <optional>

namespace cairn {
namespace landmarks {
namespace {

constexpr double kSettled_s = 3;  // until then a new landmark may turn out to be a moved one
constexpr double kUnique = 0.05;  // of the score

bool was_seen_before(const Landmark& landmark, Stamp stamp, const LandmarksState& state) {
  return landmark.run != state.run || landmark.last < stamp;
}

/// Similarity of two landmarks over all their views.
double score_between(const Landmark& a, const Landmark& b) {
  double best = 0;
  for (const LandmarkLook& look : a.looks) best = std::max(best, score_of(candidate_of(a, look.colours), b));
  return best;
}

bool may_be_same(const Landmark& a, const Landmark& b) {
  return may_be(candidate_of(a, {}), b);
}

}  // namespace

std::vector<int> frames_of(const LandmarksState& state, LandmarkId id) {
  for (const LandmarksState::VanishedLandmark& vanished : state.vanished) {
    if (vanished.landmark == id) return vanished.frames;
  }
  return {};
}

Landmark* find_in(LandmarkMap& map, LandmarkId id) {
  return const_cast<Landmark*>(find(map, id));  // NOLINT: the map is ours to change
}

bool are_apart(const Eigen::Vector3d& way, const Matrix3& covariance, const LandmarksConfig& config) {
  constexpr double kSquaredSigmas = 9;
  return way.norm() > static_cast<double>(config.moved) && squared_distance(way, covariance) > kSquaredSigmas;
}

void forget_vanished(LandmarksState& state, LandmarkId id) {
  std::erase_if(state.vanished, [&](const LandmarksState::VanishedLandmark& v) { return v.landmark == id; });
}

namespace {

/// A found landmark that is one which is gone, elsewhere.
struct Move {
  LandmarkId old = LandmarkId::none;
  LandmarkId found = LandmarkId::none;
  double score = 0;
  Eigen::Vector3d way;
};

bool can_be(const Landmark& old, const Landmark& found, const LandmarksState& state) {
  return old.id != found.id && was_seen_before(old, found.first, state) && may_be_same(found, old);
}

/// Of the landmark found at `id`, if it is one that is gone: the best by far, and no other found one fits it.
std::optional<Move> move_of(LandmarkId id, const LandmarksState& state, const LandmarksConfig& config) {
  const Landmark* found = find(state.map, id);
  if (found == nullptr || found->is_gone) return std::nullopt;
  const Landmark* best = nullptr;
  double score = 0;
  double second = 0;
  for (const Landmark& old : state.map.list) {
    if (!can_be(old, *found, state)) continue;
    const double s = score_between(*found, old);
    if (s > score) {
      second = score;
      score = s;
      best = &old;
    } else {
      second = std::max(second, s);
    }
  }
  if (best == nullptr || !best->is_gone || score < static_cast<double>(config.min_score) ||
      score < second + kUnique)
    return std::nullopt;
  const bool is_only = std::none_of(state.found.begin(), state.found.end(), [&](LandmarkId rival) {
    const Landmark* other = find(state.map, rival);
    return other != nullptr && other != found && !other->is_gone && can_be(*best, *other, state) &&
           score_between(*other, *best) > score - kUnique;
  });
  const Eigen::Vector3d way = vector(found->position_m - best->position_m);
  const Matrix3 covariance = matrix(found->covariance_m2) + matrix(best->covariance_m2);
  if (!is_only || !are_apart(way, covariance, config)) return std::nullopt;
  return Move{best->id, id, score, way};
}

/// The old landmark takes the place of the found one, which is removed.
void apply(const Move& move, LandmarksState& state) {
  const Landmark place = *find(state.map, move.found);
  Landmark& same = *find_in(state.map, move.old);
  same.position_m = place.position_m;
  same.covariance_m2 = place.covariance_m2;
  same.log_odds = place.log_odds;
  same.is_gone = false;
  same.seen += place.seen;
  same.expected += place.expected;
  same.seen_through = 0;
  same.last = place.last;
  same.run = state.run;
  for (TrackEvidence& evidence : state.tracks) {
    if (evidence.landmark != place.id) continue;
    evidence.landmark = same.id;
    evidence.is_recognised = true;
    evidence.score = move.score;
    evidence.before.reset();
    evidence.frames_left.clear();
  }
  std::erase_if(state.map.list, [&](const Landmark& l) { return l.id == place.id; });
  std::erase(state.found, place.id);
  std::erase(state.unreported, place.id);
  forget_vanished(state, move.old);
}

}  // namespace

std::vector<LandmarkEvent> find_moved(LandmarksState& state, const LandmarkFrame& frame,
                                      const LandmarksConfig& config) {
  std::vector<LandmarkEvent> events;
  const auto next_move = [&]() -> std::optional<Move> {
    for (const LandmarkId id : state.found) {
      if (const auto move = move_of(id, state, config)) return move;
    }
    return std::nullopt;
  };
  while (const std::optional<Move> move = next_move()) {
    const Landmark& old = *find(state.map, move->old);
    events.push_back({LandmarkEventKind::moved, frame.stamp, old.id, find(state.map, move->found)->position_m,
                      point(move->way), probability_of(-old.log_odds) * move->score,
                      frames_of(state, old.id)});
    apply(*move, state);
  }
  return events;
}

std::vector<LandmarkEvent> report_new(LandmarksState& state, const LandmarkFrame& frame,
                                      const LandmarksConfig& config) {
  std::vector<LandmarkEvent> events;
  std::erase_if(state.unreported, [&](LandmarkId id) {
    const Landmark* found = find(state.map, id);
    if (found == nullptr || found->is_gone) return true;
    if (seconds_between(found->first, frame.stamp) < kSettled_s) return false;
    for (const Landmark& old : state.map.list) {
      if (old.id != id && was_seen_before(old, found->first, state) && may_be_same(*found, old) &&
          score_between(*found, old) >= static_cast<double>(config.min_score))
        return false;
    }
    events.push_back({LandmarkEventKind::found,
                      frame.stamp,
                      id,
                      found->position_m,
                      {},
                      probability_of(found->log_odds),
                      {}});
    return true;
  });
  return events;
}

}  // namespace landmarks

std::vector<LandmarkEvent> changes_of(const std::vector<LandmarkEvent>& events) {
  using enum LandmarkEventKind;
  struct Change {
    LandmarkId landmark = LandmarkId::none;
    bool is_new = false;
    std::optional<LandmarkEvent> present;  // the last one while it was there
    std::optional<LandmarkEvent> gone;
  };
  std::vector<Change> changes;
  for (const LandmarkEvent& event : events) {
    if (event.kind == relocated) continue;
    auto same = std::find_if(changes.begin(), changes.end(),
                             [&](const Change& c) { return c.landmark == event.landmark; });
    if (same == changes.end())
      same = changes.insert(changes.end(), {event.landmark, event.kind == found, {}, {}});
    if (event.kind == gone) {
      same->gone = event;
      continue;
    }
    const bool returns = event.kind == back && same->gone;
    same->gone.reset();
    if (returns) continue;
    const bool moved_again = event.kind == moved && same->present && same->present->kind == moved;
    const Point3 before = moved_again ? same->present->moved_by_m : Point3{};
    same->present = event;
    same->present->moved_by_m = event.moved_by_m + before;
  }
  std::vector<LandmarkEvent> last;
  for (const Change& change : changes) {
    if (!change.gone && change.present) last.push_back(*change.present);
    if (change.gone && !change.is_new) last.push_back(*change.gone);
  }
  return last;
}

}  // namespace cairn
