// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cmath>
#include <numbers>
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

namespace landmarks {

Pose turned(double yaw, Point3 translation) {
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  return {{c, -s, 0, s, c, 0, 0, 0, 1}, translation};
}

Placement place(const Candidate& candidate, const MapLocation& located) {
  const Eigen::Vector3d p = vector(located.map_from_odom(candidate.position_m));
  const Eigen::Vector3d camera = vector(located.map_from_odom(located.camera_in_odom_m));
  Eigen::Matrix<double, 3, 4> j = Eigen::Matrix<double, 3, 4>::Zero();
  j.leftCols<3>().setIdentity();
  j(0, 3) = -(p.y() - camera.y());
  j(1, 3) = p.x() - camera.x();
  return {p, matrix(rotated(located.map_from_odom, candidate.covariance_m2)) +
                 j * matrix(located.covariance) * j.transpose()};
}

MapLocation corrected(const MapLocation& located, const std::vector<Pull>& pulls) {
  constexpr int kIterations = 6;
  constexpr double kHuber = 2;
  const Eigen::Vector3d camera = vector(located.map_from_odom(located.camera_in_odom_m));
  // Keeps the covariance of an exactly known pose invertible.
  const Matrix4 prior = (matrix(located.covariance) + 1e-9 * Matrix4::Identity()).inverse();
  Eigen::Vector4d x = Eigen::Vector4d::Zero();
  Matrix4 normal = prior;
  for (int i = 0; i < kIterations; ++i) {
    normal = prior;
    Eigen::Vector4d right = -prior * x;
    for (const Pull& pull : pulls) {
      const Eigen::Vector3d arm =
          Eigen::AngleAxisd(x[3], Eigen::Vector3d::UnitZ()) * (pull.seen.position_m - camera);
      const Eigen::Vector3d residual = pull.known.position_m - (camera + arm + x.head<3>());
      Eigen::Matrix<double, 3, 4> j = Eigen::Matrix<double, 3, 4>::Zero();
      j.leftCols<3>().setIdentity();
      j(0, 3) = -arm.y();
      j(1, 3) = arm.x();
      const Matrix3 information = (pull.seen.covariance_m2 + pull.known.covariance_m2).inverse();
      const double distance = std::sqrt(residual.dot(information * residual));
      const double weight = distance > kHuber ? kHuber / distance : 1.0;
      normal += weight * j.transpose() * information * j;
      right += weight * j.transpose() * information * residual;
    }
    const Eigen::Vector4d step = normal.ldlt().solve(right);
    x += step;
    if (step.norm() < 1e-9) break;
  }
  Pose turn = turned(x[3], {});
  turn.translation_m = point(camera + x.head<3>()) - turn.rotated(point(camera));
  return {turn * located.map_from_odom, rows_of(Matrix4(normal.inverse())), located.camera_in_odom_m};
}

Candidate candidate_of(const Landmark& landmark, const ColourHistogram& colours) {
  return {TrackId{number(landmark.id)}, landmark.position_m,
          landmark.covariance_m2,       landmark.size,
          landmark.height_over_floor_m, colours};
}

LandmarkLook& look_from(Landmark& landmark, int octant) {
  auto at = std::lower_bound(landmark.looks.begin(), landmark.looks.end(), octant,
                             [](const LandmarkLook& look, int wanted) { return look.octant < wanted; });
  if (at == landmark.looks.end() || at->octant != octant)
    at = landmark.looks.insert(at, {octant, {}, -1, {}, 0});
  return *at;
}

}  // namespace landmarks

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
      std::atan2(apart.rotation[3], apart.rotation[0]);
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

}  // namespace

Recognition relocate(const LandmarkMap& map, const std::vector<Candidate>& candidates,
                     const LandmarksConfig& config, const std::optional<MapLocation>& guess) {
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
  std::erase_if(places, [&](const Constellation& place) {
    const bool is_near = guess && suits(place.map_from_odom, *guess);
    return place.pairs.size() < (is_near ? enough_near : enough);
  });
  std::stable_sort(places.begin(), places.end(), [](const Constellation& a, const Constellation& b) {
    return std::make_tuple(a.pairs.size(), -a.squares) > std::make_tuple(b.pairs.size(), -b.squares);
  });
  if (places.empty()) {
    result.refusal = RecognitionRefusal::too_few_pairs;
    return result;
  }
  if (places.size() > 1 && places[0].agreeing() < 2 * places[1].agreeing()) {
    result.refusal = RecognitionRefusal::ambiguous;
    return result;
  }
  result.map_from_odom = places[0].map_from_odom;
  for (const std::size_t i : places[0].pairs) {
    result.pairs.push_back(
        {candidates[pairs[i].candidate].track, map.list[pairs[i].landmark].id, pairs[i].score});
  }
  return result;
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
  const double yaw = std::atan2(pose.rotation[3], pose.rotation[0]);
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
    if (pair == found.pairs.end()) {
      here.id = LandmarkId{merged.map.next++};
      here.run = 0;
      merged.map.list.push_back(std::move(here));
      continue;
    }
    Landmark& known = *std::find_if(merged.map.list.begin(), merged.map.list.end(),
                                    [&](const Landmark& l) { return l.id == pair->landmark; });
    const Matrix3 a = matrix(known.covariance_m2).inverse();
    const Matrix3 b = matrix(here.covariance_m2).inverse();
    const Matrix3 both = (a + b).inverse();
    known.position_m = point(both * (a * vector(known.position_m) + b * vector(here.position_m)));
    known.covariance_m2 = landmarks::rows_of(both);
    known.size.narrowest_m = std::min(known.size.narrowest_m, here.size.narrowest_m);
    known.size.widest_m = std::max(known.size.widest_m, here.size.widest_m);
    known.size.height_m = std::max(known.size.height_m, here.size.height_m);
    add_looks(known, here.looks);
    known.seen += here.seen;
    known.expected += here.expected;
    known.log_odds = std::clamp(known.log_odds + here.log_odds, -5.0, 5.0);
    known.is_gone = known.is_gone && known.log_odds < 0;
    // Stamps of different runs are not comparable: first, last and run remain those of this map.
    if (known.name.empty()) known.name = here.name;
  }
  return merged;
}

}  // namespace

MapMerge merge(LandmarkMap map, const LandmarkMap& other, const std::optional<Pose>& map_from_other,
               const LandmarksConfig& config) {
  const std::vector<Candidate> candidates = candidates_of(other);
  const Recognition found = map_from_other ? recognise(map, candidates, {*map_from_other, {}, {}}, {}, config)
                                           : relocate(map, candidates, config);
  const std::optional<Pose> pose = map_from_other ? map_from_other : found.map_from_odom;
  if (pose) return unite(std::move(map), other, found, *pose);
  return {std::move(map), found.pairs, std::nullopt, found.refusal};
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
  const Recognition found = recognise(map, candidates_of(fresh), {Pose{}, {}, {}}, shared, config);
  MapMerge merged = unite(std::move(map), fresh, found, Pose{});
  merged.pairs.insert(merged.pairs.begin(), pairs.begin(), pairs.end());
  return merged;
}

}  // namespace cairn
