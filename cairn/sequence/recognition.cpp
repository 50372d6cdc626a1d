// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <tuple>

#include <cairn/sequence/landmark_geometry.hpp>
#include <cairn/sequence/landmarks.hpp>

namespace cairn {

using landmarks::matrix;
using landmarks::Matrix3;
using landmarks::Matrix4;
using landmarks::Placement;
using landmarks::point;
using landmarks::Pull;
using landmarks::squared_distance;
using landmarks::vector;

namespace {

constexpr double kSizeRatio = 1.6;
constexpr double kHeightTolerance_m = 0.15;

/// A candidate and a landmark with compatible colours and sizes.
struct CompatiblePair {
  std::size_t candidate = 0;
  std::size_t landmark = 0;
  double score = 0;
};

constexpr std::size_t kMaxAllowed = 300;

/// A place is refused if chance would give more such places than this …
constexpr double kByChance = 1e-3;
/// … or than this where both sides have few objects: they seldom have four in common.
constexpr double kByChanceOfFew = 1e-2;
constexpr std::size_t kFew = 10;
/// How much sooner chance gives a place that is no rival of the best.
constexpr double kClearly = 20;

std::vector<CompatiblePair> allowed_pairs(const LandmarkMap& map, const std::vector<Candidate>& candidates,
                                          const LandmarksConfig& config) {
  std::vector<CompatiblePair> pairs;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    for (std::size_t l = 0; l < map.list.size(); ++l) {
      if (map.list[l].is_gone || !may_be(candidates[c], map.list[l])) continue;
      const double score = score_of(candidates[c], map.list[l]);
      if (score >= static_cast<double>(config.min_score)) pairs.push_back({c, l, score});
    }
  }
  if (pairs.size() > kMaxAllowed) {
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const CompatiblePair& a, const CompatiblePair& b) { return a.score > b.score; });
    pairs.resize(kMaxAllowed);
  }
  return pairs;
}

/// Pairs consistent with one pose.
struct Constellation {
  std::vector<std::size_t> pairs;
  Pose map_from_odom;
  double squares = 0;
  [[nodiscard]] std::size_t agreeing() const { return pairs.size() * (pairs.size() - 1) / 2; }
};

/// The rotation about z and the translation that align the candidates with the landmarks: weighted least
/// squares (Umeyama 1991, in the plane).
Pose fit(const std::vector<std::size_t>& chosen, const std::vector<CompatiblePair>& pairs,
         const std::vector<Candidate>& candidates, const LandmarkMap& map) {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
  double weights = 0;
  const auto weight_of = [&](const CompatiblePair& pair) {
    return 1.0 / (matrix(candidates[pair.candidate].covariance_m2).trace() +
                  matrix(map.list[pair.landmark].covariance_m2).trace());
  };
  for (const std::size_t i : chosen) {
    const double w = weight_of(pairs[i]);
    from += w * vector(candidates[pairs[i].candidate].position_m);
    to += w * vector(map.list[pairs[i].landmark].position_m);
    weights += w;
  }
  from /= weights;
  to /= weights;
  double sine = 0;
  double cosine = 0;
  for (const std::size_t i : chosen) {
    const Eigen::Vector3d a = vector(candidates[pairs[i].candidate].position_m) - from;
    const Eigen::Vector3d b = vector(map.list[pairs[i].landmark].position_m) - to;
    const double w = weight_of(pairs[i]);
    cosine += w * (a.x() * b.x() + a.y() * b.y());
    sine += w * (a.x() * b.y() - a.y() * b.x());
  }
  Pose pose = landmarks::turned(std::atan2(sine, cosine), {});
  pose.translation_m = point(to) - pose.rotated(point(from));
  return pose;
}

/// All pairs consistent with the pose, each candidate and landmark at most once, nearest first.
Constellation explained(const Pose& pose, double slack, const std::vector<CompatiblePair>& pairs,
                        const std::vector<Candidate>& candidates, const LandmarkMap& map, double gate) {
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Candidate& candidate = candidates[pairs[i].candidate];
    const Landmark& landmark = map.list[pairs[i].landmark];
    const Eigen::Vector3d difference = vector(pose(candidate.position_m) - landmark.position_m);
    if (difference.squaredNorm() > 9) continue;  // a quick test: beyond any gate
    const double squared = squared_distance(
        difference,
        slack * Matrix3(matrix(rotated(pose, candidate.covariance_m2)) + matrix(landmark.covariance_m2)));
    if (squared <= gate) near.emplace_back(squared, i);
  }
  std::sort(near.begin(), near.end());
  Constellation found;
  found.map_from_odom = pose;
  for (const auto& [squared, nearest] : near) {
    const std::size_t i = nearest;
    const bool is_taken = std::any_of(found.pairs.begin(), found.pairs.end(), [&](std::size_t other) {
      return pairs[other].candidate == pairs[i].candidate || pairs[other].landmark == pairs[i].landmark;
    });
    if (is_taken) continue;
    found.pairs.push_back(i);
    found.squares += squared;
  }
  std::sort(found.pairs.begin(), found.pairs.end());
  return found;
}

bool agree(const CompatiblePair& a, const CompatiblePair& b, const std::vector<Candidate>& candidates,
           const LandmarkMap& map) {
  constexpr double kShortest_m = 0.3;  // a shorter baseline determines no direction
  constexpr double kSigmas = 3;
  if (a.candidate == b.candidate || a.landmark == b.landmark) return false;
  const auto& ca = candidates[a.candidate];
  const auto& cb = candidates[b.candidate];
  const auto& la = map.list[a.landmark];
  const auto& lb = map.list[b.landmark];
  const Eigen::Vector3d seen = vector(cb.position_m - ca.position_m);
  const Eigen::Vector3d known = vector(lb.position_m - la.position_m);
  const double seen_m = seen.head<2>().norm();
  const double known_m = known.head<2>().norm();
  if (seen_m < kShortest_m || known_m < kShortest_m) return false;
  const auto along = [](const Candidate& c, const Eigen::Vector3d& d) {
    const Eigen::Vector2d u = d.head<2>().normalized();
    return u.dot(matrix(c.covariance_m2).topLeftCorner<2, 2>() * u);
  };
  const auto along_known = [](const Landmark& l, const Eigen::Vector3d& d) {
    const Eigen::Vector2d u = d.head<2>().normalized();
    return u.dot(matrix(l.covariance_m2).topLeftCorner<2, 2>() * u);
  };
  const double variance = along(ca, seen) + along(cb, seen) + along_known(la, known) + along_known(lb, known);
  const double variance_up =
      ca.covariance_m2[8] + cb.covariance_m2[8] + la.covariance_m2[8] + lb.covariance_m2[8];
  return std::abs(seen_m - known_m) <= kSigmas * std::sqrt(variance) &&
         std::abs(seen.z() - known.z()) <= kSigmas * std::sqrt(variance_up);
}

bool is_same_place(const Pose& a, const Pose& b, Point3 where) {
  constexpr double kApart_m = 0.5;
  constexpr double kApart_rad = 20 * std::numbers::pi / 180;
  return length(a(where) - b(where)) < kApart_m && angle_of(inverse(a) * b) < kApart_rad;
}

/// Whether a pose in the map is within the 95 % region of a guess.
bool suits(const Pose& map_from_odom, const MapLocation& guess) {
  constexpr double kChi2Of4At95 = 9.488;
  const Pose apart = map_from_odom * inverse(guess.map_from_odom);
  Eigen::Vector4d off;
  off << vector(map_from_odom(guess.camera_in_odom_m) - guess.map_from_odom(guess.camera_in_odom_m)),
      yaw_of(apart);
  return off.dot(matrix(guess.covariance).ldlt().solve(off)) <= kChi2Of4At95;
}

}  // namespace

const Landmark* find(const LandmarkMap& map, LandmarkId id) {
  const auto at = std::lower_bound(map.list.begin(), map.list.end(), id,
                                   [](const Landmark& l, LandmarkId wanted) { return l.id < wanted; });
  return at != map.list.end() && at->id == id ? &*at : nullptr;
}

double score_of(const Candidate& candidate, const Landmark& landmark) {
  double best = 0;
  for (const LandmarkLook& look : landmark.looks)
    best = std::max(best, double{likeness(candidate.colours, look.colours)});
  return best;
}

bool may_be(const Candidate& candidate, const Landmark& landmark) {
  const SeenSize& a = candidate.size;
  const SeenSize& b = landmark.size;
  if (a.height_m > kSizeRatio * b.height_m || b.height_m > kSizeRatio * a.height_m) return false;
  if (a.narrowest_m > kSizeRatio * b.widest_m || b.narrowest_m > kSizeRatio * a.widest_m) return false;
  const bool heights_known = candidate.height_over_floor_m > 0 && landmark.height_over_floor_m > 0;
  return !heights_known ||
         std::abs(candidate.height_over_floor_m - landmark.height_over_floor_m) <= kHeightTolerance_m;
}

Recognition recognise(const LandmarkMap& map, const std::vector<Candidate>& candidates,
                      const MapLocation& located, const std::vector<LandmarkId>& taken,
                      const LandmarksConfig& config) {
  constexpr double kReach_m = 3;   // a quick test, and the largest distance that a gate should allow
  constexpr double kColours = 20;  // squared distance added for a colour similarity of 0
  Recognition result;
  if (candidates.empty()) {
    result.refusal = RecognitionRefusal::no_candidates;
    return result;
  }
  struct PairCost {
    double cost;
    std::size_t candidate;
    std::size_t landmark;
    double score;
  };
  std::vector<PairCost> offers;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const Placement seen = landmarks::place(candidates[c], located);
    for (std::size_t l = 0; l < map.list.size(); ++l) {
      const Landmark& landmark = map.list[l];
      const Eigen::Vector3d difference = seen.position_m - vector(landmark.position_m);
      if (difference.squaredNorm() > kReach_m * kReach_m) continue;
      if (std::find(taken.begin(), taken.end(), landmark.id) != taken.end()) continue;
      if (!may_be(candidates[c], landmark)) continue;
      const double squared =
          squared_distance(difference, Matrix3(seen.covariance_m2 + matrix(landmark.covariance_m2)));
      if (squared > static_cast<double>(config.gate)) continue;
      const double score = score_of(candidates[c], landmark);
      if (score >= static_cast<double>(config.min_score))
        offers.push_back({squared + kColours * (1 - score), c, l, score});
    }
  }
  const auto is_best = [&](const PairCost& offer) {
    return std::none_of(offers.begin(), offers.end(), [&](const PairCost& other) {
      if (other.candidate == offer.candidate && other.landmark == offer.landmark) return false;
      if (other.candidate != offer.candidate && other.landmark != offer.landmark) return false;
      return std::tie(other.cost, other.candidate, other.landmark) <
             std::tie(offer.cost, offer.candidate, offer.landmark);
    });
  };
  for (const PairCost& offer : offers) {
    if (is_best(offer))
      result.pairs.push_back({candidates[offer.candidate].track, map.list[offer.landmark].id, offer.score});
  }
  if (result.pairs.empty()) result.refusal = RecognitionRefusal::too_few_pairs;
  return result;
}

namespace {

/// The distinct places where the candidates may be, each with its best constellation. Each two pairs with consistent
/// distances give a pose, which all pairs consistent with it then refine.
std::vector<Constellation> constellations_of(const std::vector<CompatiblePair>& pairs,
                                             const std::vector<Candidate>& candidates, const LandmarkMap& map,
                                             double gate) {
  Point3 middle;
  for (const Candidate& candidate : candidates)
    middle = middle + (1.0 / static_cast<double>(candidates.size())) * candidate.position_m;
  constexpr double kSeedSlack = 2;    // for the position errors of the seeds
  std::vector<Constellation> places;  // distinct places, the best constellation of each
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = i + 1; j < pairs.size(); ++j) {
      if (!agree(pairs[i], pairs[j], candidates, map)) continue;
      const Pose seed = fit({i, j}, pairs, candidates, map);
      const Constellation rough = explained(seed, kSeedSlack, pairs, candidates, map, gate);
      if (rough.pairs.size() < 2) continue;
      const Pose pose = fit(rough.pairs, pairs, candidates, map);
      Constellation found = explained(pose, 1, pairs, candidates, map, gate);
      if (found.pairs.size() < 2) continue;
      found = explained(fit(found.pairs, pairs, candidates, map), 1, pairs, candidates, map, gate);
      if (found.pairs.size() < 2) continue;
      const auto same = std::find_if(places.begin(), places.end(), [&](const Constellation& other) {
        return is_same_place(other.map_from_odom, found.map_from_odom, middle);
      });
      if (same == places.end()) {
        places.push_back(found);
      } else if (std::make_tuple(same->pairs.size(), -same->squares) <
                 std::make_tuple(found.pairs.size(), -found.squares)) {
        *same = found;
      }
    }
  }
  return places;
}

/// The landmarks that may be there.
std::vector<std::size_t> present_in(const LandmarkMap& map) {
  std::vector<std::size_t> present;
  for (std::size_t l = 0; l < map.list.size(); ++l) {
    if (!map.list[l].is_gone) present.push_back(l);
  }
  return present;
}

/// The probability that the distances of two candidates and of two landmarks agree, whatever these look like: of
/// couples of each, drawn by a fixed rule.
double chance_of_agreement(const std::vector<Candidate>& candidates, const LandmarkMap& map,
                           const std::vector<std::size_t>& present) {
  constexpr int kDraws = 2000;
  std::minstd_rand draw;
  const auto below = [&](std::size_t count) { return std::size_t{draw()} % count; };
  int agreed = 0;
  for (int k = 0; k < kDraws; ++k) {
    const CompatiblePair a{below(candidates.size()), present[below(present.size())], 0};
    const CompatiblePair b{below(candidates.size()), present[below(present.size())], 0};
    agreed += agree(a, b, candidates, map) ? 1 : 0;
  }
  return (agreed + 1.0) / kDraws;
}

/// The area on which so many landmarks stand as densely as they do: rooms count, what is between them does not.
double area_of(const LandmarkMap& map, const std::vector<std::size_t>& present) {
  constexpr double kNear_m = 1.5;
  double near = 0;
  for (const std::size_t a : present) {
    for (const std::size_t b : present) {
      const Eigen::Vector3d off = vector(map.list[a].position_m - map.list[b].position_m);
      near += off.head<2>().norm() < kNear_m ? 1 : 0;  // itself, too
    }
  }
  const auto count = static_cast<double>(present.size());
  return count * std::numbers::pi * kNear_m * kNear_m / (near / count);
}

/// What chance alone gives where nothing is common to both: each of the compatible pairs is a chance meeting of two
/// looks. Two of them whose distances agree give a pose; there, each other one is within its gate with the probability
/// of the gate's area in the map's, so the number of further ones has a Poisson distribution.
class Chance {
 public:
  Chance(const std::vector<CompatiblePair>& pairs, const std::vector<Candidate>& candidates,
         const LandmarkMap& map, double gate) {
    const std::vector<std::size_t> present = present_in(map);
    double gates_m2 = 0;
    for (const CompatiblePair& pair : pairs) {
      const Matrix3 both =
          matrix(candidates[pair.candidate].covariance_m2) + matrix(map.list[pair.landmark].covariance_m2);
      gates_m2 += std::numbers::pi * gate * std::sqrt(both.topLeftCorner<2, 2>().determinant());
    }
    const auto count = static_cast<double>(pairs.size());
    further_ = gates_m2 / area_of(map, present);
    seeds_ = count * (count - 1) / 2 * chance_of_agreement(candidates, map, present);
  }

  /// The expected number of constellations of at least so many pairs.
  [[nodiscard]] double expected(std::size_t pairs) const {
    double term = std::exp(-further_);
    double tail = 1;
    for (std::size_t more = 1; more + 2 <= pairs; ++more) {
      tail -= term;
      term *= further_ / static_cast<double>(more);
    }
    // Each two of its pairs are a seed of the same constellation.
    const auto all = static_cast<double>(pairs);
    return seeds_ * std::max(tail, 0.0) / (all * (all - 1) / 2);
  }

 private:
  double seeds_ = 0;
  double further_ = 0;
};

/// What a map knows of its floor.
class KnownFloor {
 public:
  explicit KnownFloor(const LandmarkMap& map) : map_(map) {
    std::vector<FloorCell> around;
    for (const FloorCell& cell : map.floor) {
      if (cell.frames < landmarks::kFloorFrames ||
          std::abs(static_cast<double>(cell.x)) > landmarks::kFarthestCell ||
          std::abs(static_cast<double>(cell.y)) > landmarks::kFarthestCell)
        continue;
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) around.push_back({cell.x + x, cell.y + y, 0});
      }
    }
    std::sort(around.begin(), around.end(), landmarks::is_before);
    int seen = 0;
    int free = 0;
    for (std::size_t i = 0; i < around.size();) {
      std::size_t next = i;
      while (next < around.size() && around[next] == around[i]) ++next;
      if (next - i >= kSeenAround) {
        ++seen;
        free += is_free(around[i]) ? 1 : 0;
      }
      i = next;
    }
    if (seen == 0) return;
    double own = 0.5;
    double present = 1;
    for (const std::size_t l : present_in(map)) {
      own += is_free(landmarks::cell_at(map.list[l].position_m)) ? 1 : 0;
      ++present;
    }
    right_ = std::clamp(own / present, kLeast, kMost);
    wrong_ = std::clamp(static_cast<double>(free) / seen, right_, kMost);
  }

  /// How much likelier a wrong place is than the right one, with unknown objects at these positions. At the right one,
  /// some stand on free floor, too: what came since, and what does not fill its cell; as many as of the map's own
  /// landmarks. Floor that was not seen says nothing.
  [[nodiscard]] double odds(const std::vector<Point3>& objects) const {
    constexpr double kMostGain = 0.01;  // objects that one pose moves together are not independent
    double odds = 1;
    for (const Point3 at : objects) {
      const FloorCell cell = landmarks::cell_at(at);
      if (is_free(cell)) {
        odds *= wrong_ / right_;
      } else if (is_seen(cell)) {
        odds *= (1 - wrong_) / (1 - right_);
      }
    }
    return std::max(odds, kMostGain);
  }

 private:
  static constexpr double kLeast = 0.2;
  static constexpr double kMost = 0.9;
  static constexpr std::size_t kSeenAround = 4;  // free cells of 3 × 3

  [[nodiscard]] bool is_free(FloorCell cell) const {
    return landmarks::floor_frames_at(map_, cell) >= landmarks::kFloorFrames;
  }
  [[nodiscard]] bool is_seen(FloorCell cell) const {
    std::size_t free = 0;
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) free += is_free({cell.x + x, cell.y + y, 0}) ? 1 : 0;
    }
    return free >= kSeenAround;
  }

  const LandmarkMap& map_;
  double right_ = 1;  // share of objects that stand on free floor at the right place
  double wrong_ = 1;  // and at a wrong one
};

/// The same for a constellation: candidates that it does not pair on the floor of the map, and landmarks that it does
/// not pair on that of the map from which the candidates come, if there is one.
double odds_by_floor(const Constellation& place, const std::vector<CompatiblePair>& pairs,
                     const std::vector<Candidate>& candidates, const LandmarkMap& map,
                     const LandmarkMap* other) {
  const auto is_paired = [&](std::size_t CompatiblePair::*of, std::size_t which) {
    return std::any_of(place.pairs.begin(), place.pairs.end(),
                       [&](std::size_t i) { return pairs[i].*of == which; });
  };
  std::vector<Point3> objects;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (!is_paired(&CompatiblePair::candidate, c))
      objects.push_back(place.map_from_odom(candidates[c].position_m));
  }
  const double odds = KnownFloor(map).odds(objects);
  if (other == nullptr) return odds;
  objects.clear();
  const Pose other_from_map = inverse(place.map_from_odom);
  for (const std::size_t l : present_in(map)) {
    if (!is_paired(&CompatiblePair::landmark, l)) objects.push_back(other_from_map(map.list[l].position_m));
  }
  return odds * KnownFloor(*other).odds(objects);
}

/// relocate(); `other`: the map from which the candidates come, nullptr if they are objects in view.
Recognition placed(const LandmarkMap& map, const std::vector<Candidate>& candidates,
                   const LandmarksConfig& config, const std::optional<MapLocation>& guess,
                   const LandmarkMap* other) {
  Recognition result;
  const auto enough = static_cast<std::size_t>(config.relocation_pairs);
  // Two at least: one determines no direction.
  const std::size_t enough_near =
      guess ? std::min(enough, static_cast<std::size_t>(std::max(2, config.min_pairs))) : enough;
  if (candidates.size() < enough_near) {
    result.refusal = RecognitionRefusal::no_candidates;
    return result;
  }
  const std::vector<CompatiblePair> pairs = allowed_pairs(map, candidates, config);
  // χ² with 3 degrees of freedom, 0.95. Losing a correct pair costs little; a moved object distorts the pose.
  constexpr double kTight = 7.81;
  const double gate = std::min(static_cast<double>(config.gate), kTight);
  std::vector<Constellation> places = constellations_of(pairs, candidates, map, gate);
  const auto is_near = [&](const Constellation& place) {
    return guess && suits(place.map_from_odom, *guess);
  };
  std::erase_if(places, [&](const Constellation& place) {
    return place.pairs.size() < (is_near(place) ? enough_near : enough);
  });
  std::stable_sort(places.begin(), places.end(), [](const Constellation& a, const Constellation& b) {
    return std::make_tuple(a.pairs.size(), -a.squares) > std::make_tuple(b.pairs.size(), -b.squares);
  });
  if (places.empty()) {
    result.refusal = RecognitionRefusal::too_few_pairs;
    return result;
  }
  const Chance chance(pairs, candidates, map, gate);
  const auto by_chance = [&](const Constellation& place) {
    return chance.expected(place.pairs.size()) * odds_by_floor(place, pairs, candidates, map, other);
  };
  // Another place is no rival if it has few of the pairs, or if chance gives the like of it much sooner and its pairs
  // fit worse.
  const auto is_rival = [&](const Constellation& place) {
    return places[0].agreeing() < 2 * place.agreeing() &&
           by_chance(place) * std::exp(place.squares / 2) <
               kClearly * by_chance(places[0]) * std::exp(places[0].squares / 2);
  };
  if (places.size() > 1 && is_rival(places[1])) {
    result.refusal = RecognitionRefusal::ambiguous;
    return result;
  }
  const bool are_few = std::max(candidates.size(), map.list.size()) <= kFew;
  if (!is_near(places[0]) && by_chance(places[0]) > (are_few ? kByChanceOfFew : kByChance)) {
    result.refusal = RecognitionRefusal::too_few_pairs;
    return result;
  }
  result.map_from_odom = places[0].map_from_odom;
  for (const std::size_t i : places[0].pairs) {
    result.pairs.push_back(
        {candidates[pairs[i].candidate].track, map.list[pairs[i].landmark].id, pairs[i].score});
  }
  return result;
}

}  // namespace

Recognition relocate(const LandmarkMap& map, const std::vector<Candidate>& candidates,
                     const LandmarksConfig& config, const std::optional<MapLocation>& guess) {
  return placed(map, candidates, config, guess, nullptr);
}

namespace {

std::vector<Candidate> candidates_of(const LandmarkMap& other) {
  std::vector<Candidate> candidates;
  for (const Landmark& landmark : other.list) {
    if (landmark.is_gone || landmark.looks.empty()) continue;
    const auto largest =
        std::max_element(landmark.looks.begin(), landmark.looks.end(),
                         [](const LandmarkLook& a, const LandmarkLook& b) { return a.pixels < b.pixels; });
    candidates.push_back(landmarks::candidate_of(landmark, largest->colours));
  }
  return candidates;
}

/// Whether two copies of a map use the id for the same object: after copying, each assigns its own ids.
bool is_shared(const Landmark& a, const Landmark& b, const LandmarksConfig& config) {
  if (a.id != b.id || a.first != b.first || !may_be(landmarks::candidate_of(a, {}), b)) return false;
  if (a.looks.empty() || b.looks.empty()) return true;
  return std::any_of(a.looks.begin(), a.looks.end(), [&](const LandmarkLook& look) {
    return score_of(landmarks::candidate_of(a, look.colours), b) >= static_cast<double>(config.min_score);
  });
}

/// The looks as seen from the axes of the map that `pose` leads to.
std::vector<LandmarkLook> turned(std::vector<LandmarkLook> looks, const Pose& pose) {
  const double yaw = yaw_of(pose);
  const int turn = static_cast<int>(std::lround(yaw / (std::numbers::pi / 4)));
  for (LandmarkLook& look : looks) look.octant = (look.octant + turn + 8) % 8;
  std::sort(looks.begin(), looks.end(),
            [](const LandmarkLook& a, const LandmarkLook& b) { return a.octant < b.octant; });
  return looks;
}

/// For each octant the larger view; the crop remains that of `known`, if it has one.
void add_looks(Landmark& known, const std::vector<LandmarkLook>& others) {
  const bool has_crop = std::any_of(known.looks.begin(), known.looks.end(),
                                    [](const LandmarkLook& look) { return !look.crop_png.empty(); });
  for (const LandmarkLook& other : others) {
    LandmarkLook& look = landmarks::look_from(known, other.octant);
    if (other.pixels > look.pixels) {
      look.colours = other.colours;
      look.pixels = other.pixels;
    }
    if (has_crop || other.crop_png.empty()) continue;
    look.crop_png = other.crop_png;
    look.crop_pixels = other.crop_pixels;
  }
}

/// The floor of a map as seen from the frame that `pose` leads to: for each cell there, the one that its middle is in.
std::vector<FloorCell> moved(const LandmarkMap& from, const Pose& pose) {
  const Pose back = inverse(pose);
  std::vector<FloorCell> cells;
  for (const FloorCell& cell : from.floor) {
    for (const double x : {0.1, 0.5, 0.9}) {
      for (const double y : {0.1, 0.5, 0.9}) {
        cells.push_back(
            landmarks::cell_at(pose({(cell.x + x) * kFloorCell_m, (cell.y + y) * kFloorCell_m, 0})));
      }
    }
  }
  std::sort(cells.begin(), cells.end(), landmarks::is_before);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  for (FloorCell& cell : cells) {
    const Point3 at = back({(cell.x + 0.5) * kFloorCell_m, (cell.y + 0.5) * kFloorCell_m, 0});
    cell.frames = landmarks::floor_frames_at(from, landmarks::cell_at(at));
  }
  std::erase_if(cells, [](FloorCell cell) { return cell.frames == 0; });
  return cells;
}

MapMerge unite(LandmarkMap map, const LandmarkMap& other, const Recognition& found, const Pose& pose) {
  MapMerge merged;
  merged.map_from_other = pose;
  merged.pairs = found.pairs;
  merged.map = std::move(map);
  for (const Landmark& landmark : other.list) {
    const auto pair = std::find_if(found.pairs.begin(), found.pairs.end(), [&](const LandmarkPair& p) {
      return number(p.track) == number(landmark.id);
    });
    Landmark here = landmark;
    here.position_m = pose(landmark.position_m);
    here.covariance_m2 = rotated(pose, landmark.covariance_m2);
    here.looks = turned(landmark.looks, pose);
    const LandmarkId id = pair == found.pairs.end() ? LandmarkId{merged.map.next++} : pair->landmark;
    merged.landmarks.push_back({TrackId{number(landmark.id)}, id, 0});
    if (pair == found.pairs.end()) {
      here.id = id;
      here.run = 0;
      merged.map.list.push_back(std::move(here));
      continue;
    }
    Landmark& known = *std::find_if(merged.map.list.begin(), merged.map.list.end(),
                                    [&](const Landmark& l) { return l.id == id; });
    const Matrix3 a = matrix(known.covariance_m2).inverse();
    const Matrix3 b = matrix(here.covariance_m2).inverse();
    const Matrix3 both = (a + b).inverse();
    known.position_m = point(both * (a * vector(known.position_m) + b * vector(here.position_m)));
    known.covariance_m2 = landmarks::rows_of(both);
    known.size.narrowest_m = std::min(known.size.narrowest_m, here.size.narrowest_m);
    known.size.widest_m = std::max(known.size.widest_m, here.size.widest_m);
    known.size.height_m = std::max(known.size.height_m, here.size.height_m);
    add_looks(known, here.looks);
    const auto sum = [](int ours, int theirs) {
      return ours + std::min(theirs, std::numeric_limits<int>::max() - ours);
    };
    known.seen = sum(known.seen, here.seen);
    known.expected = sum(known.expected, here.expected);
    known.log_odds = std::clamp(known.log_odds + here.log_odds, -5.0, 5.0);
    known.is_gone = known.is_gone && known.log_odds < 0;
    // Stamps of different runs are not comparable: first, last and run remain those of this map.
    if (known.name.empty()) known.name = here.name;
  }
  landmarks::add_floor(merged.map, moved(other, pose));
  return merged;
}

}  // namespace

namespace {

/// A place that was right a little while ago.
std::optional<MapLocation> around(const std::optional<Pose>& pose) {
  if (!pose) return std::nullopt;
  constexpr double kSigma_m = 0.15;
  constexpr double kSigma_rad = 0.05;
  MapLocation location;
  location.map_from_odom = *pose;
  for (const std::size_t i : {0U, 5U, 10U}) location.covariance[i] = kSigma_m * kSigma_m;
  location.covariance[15] = kSigma_rad * kSigma_rad;
  return location;
}

}  // namespace

MapMerge merge(LandmarkMap map, const LandmarkMap& other, const std::optional<Pose>& map_from_other,
               const LandmarksConfig& config, const std::optional<Pose>& guess) {
  const std::vector<Candidate> candidates = candidates_of(other);
  const Recognition found = map_from_other ? recognise(map, candidates, {*map_from_other, {}, {}}, {}, config)
                                           : placed(map, candidates, config, around(guess), &other);
  const std::optional<Pose> pose = map_from_other ? map_from_other : found.map_from_odom;
  if (pose) return unite(std::move(map), other, found, *pose);
  return {{std::nullopt, found.pairs, found.refusal}, std::move(map)};
}

MapMerge merge_copies(LandmarkMap map, const LandmarkMap& other, const LandmarksConfig& config) {
  std::int64_t latest = 0;
  for (const Landmark& ours : map.list) latest = std::max(latest, ours.run);
  LandmarkMap fresh;
  std::vector<LandmarkPair> pairs;
  std::vector<LandmarkId> shared;
  for (const Landmark& theirs : other.list) {
    const auto ours = std::find_if(map.list.begin(), map.list.end(),
                                   [&](const Landmark& l) { return is_shared(l, theirs, config); });
    if (ours == map.list.end()) {
      fresh.list.push_back(theirs);
      continue;
    }
    pairs.push_back({TrackId{number(theirs.id)}, ours->id, 1});
    shared.push_back(ours->id);
    const std::string name = ours->name.empty() ? theirs.name : ours->name;
    // A missing landmark was expected later than it was last seen.
    if (std::tie(theirs.run, theirs.last, theirs.expected) >
        std::tie(ours->run, ours->last, ours->expected)) {
      *ours = theirs;
      ours->run = std::min(theirs.run, latest);  // runs of the other map after the copy are not ours
    }
    ours->name = name;
  }
  // The later of two copies has seen what the other had, and more: what it knows of a cell does not add up.
  for (FloorCell cell : other.floor) {
    cell.frames -= std::min(cell.frames, landmarks::floor_frames_at(map, cell));
    if (cell.frames > 0) fresh.floor.push_back(cell);
  }
  const Recognition found = recognise(map, candidates_of(fresh), {Pose{}, {}, {}}, shared, config);
  MapMerge merged = unite(std::move(map), fresh, found, Pose{});
  merged.pairs.insert(merged.pairs.begin(), pairs.begin(), pairs.end());
  merged.landmarks.insert(merged.landmarks.begin(), pairs.begin(), pairs.end());
  return merged;
}

MapsMerge merge_all(LandmarkMap map, const std::vector<MapToMerge>& others, const LandmarksConfig& config) {
  MapsMerge all{std::move(map), std::vector<PlacedMap>(others.size())};
  const auto add = [&](std::size_t i, MapMerge merged) {
    all.map = std::move(merged.map);
    all.placed[i] = static_cast<PlacedMap&&>(merged);
  };
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (others[i].is_copy) add(i, merge_copies(std::move(all.map), others[i].map, config));
  }
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (!others[i].is_copy && others[i].map_from_other)
      add(i, merge(std::move(all.map), others[i].map, others[i].map_from_other, config));
  }
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (!all.placed[i].map_from_other) left.push_back(i);
  }
  std::stable_sort(left.begin(), left.end(), [&](std::size_t a, std::size_t b) {
    return others[a].map.list.size() > others[b].map.list.size();
  });
  // One that finds no place may find one once others are there.
  for (std::size_t i = 0; i < left.size();) {
    add(left[i], merge(std::move(all.map), others[left[i]].map, std::nullopt, config, others[left[i]].guess));
    if (!all.placed[left[i]].map_from_other) {
      ++i;
      continue;
    }
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
    i = 0;
  }
  return all;
}

}  // namespace cairn
