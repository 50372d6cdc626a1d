// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/image/local_contrast.hpp>
#include <cairn/regions/label_kernels.hpp>
#include <cairn/scene/floor_search.hpp>
#include <cairn/scene/plane_fit.hpp>
#include <cairn/scene/plane_kernels.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

namespace cairn {
namespace {

// Properties of a floor. Distances are in px of disparity for any image size, like a matcher's errors.
constexpr float kTolerance = 1.0F;  // px; correct matches are rarely farther from the floor
constexpr float kSteepestPitch =
    77.0F;  // degrees below the horizon; planes that face the camera more directly are walls
constexpr float kLeastPitch = -30.0F;  // degrees; a camera that looks up more sees no floor
constexpr float kMostRoll = 20.0F;     // degrees
constexpr float kParallel = 5.0F;      // degrees; fits to parallel surfaces differ by less

// The conditions for accepting a floor.
constexpr double kLeastMatches = 0.005;  // share of the image
constexpr std::int64_t kFewestMatches = 64;
constexpr double kLeastScore = 0.05;    // share of the matches under the plane's horizon
constexpr double kLeastRise = 0.5;      // share of its slope that the matches certainly show from row to row
constexpr int kFewestPairs = 8;         // of matches, to judge the slope
constexpr double kAlike = 4;            // number of neighbouring matches with the same error
constexpr double kLeastLikeness = 7.5;  // standard deviations: similarity of mirror images to their originals
constexpr float kNearest = 1.25F;  // times the nearest match: the nearest a floor may be at the lower border
constexpr float kApart = 4;        // px; least distance from an original
constexpr int kLowerSurface = 3;   // a plane below the best counts with a third of its score

// The effort of the search: one to three milliseconds, four more if the left image is used.
constexpr std::size_t kSamples = 4096;
constexpr std::size_t kRefining = 1024;  // of them, for least squares
constexpr std::size_t kScreening = 512;  // of them, to score a candidate
constexpr std::size_t kMirrorScreening = 256;
constexpr int kDraws = 8192;
constexpr std::size_t kGuesses = 1024;
constexpr std::size_t kFinalists = 24;

/// Matches, one array per coordinate, so that several are judged at once.
struct Points {
  std::vector<float> x, y, d;

  [[nodiscard]] std::size_t size() const { return d.size(); }
  void add(float at_x, float at_y, float disparity) {
    x.push_back(at_x);
    y.push_back(at_y);
    d.push_back(disparity);
  }
  [[nodiscard]] kernels::PointArrays arrays() const {
    return {x.data(), y.data(), d.data(), nullptr, static_cast<int>(size())};
  }
  [[nodiscard]] float above(const GroundPlane& plane, std::size_t i) const {
    return d[i] - plane.disparity_px(x[i], y[i]);
  }
  [[nodiscard]] bool on(const GroundPlane& plane, std::size_t i) const {
    return std::abs(above(plane, i)) <= kTolerance;
  }
};

/// The kernels that the search calls.
struct Kernels {
  const kernels::PlaneKernels& planes;
  const kernels::LabelKernels& lists;
  explicit Kernels(const Exec& exec)
      : planes(kernels::plane_kernels(exec)), lists(kernels::label_kernels(exec)) {}
};

/// The indices of the points whose distance above the plane is within least … most, in their order.
std::vector<std::uint32_t> between(const Points& points, const GroundPlane& plane, float least, float most,
                                   const Kernels& run) {
  std::vector<std::uint8_t> marks(points.size());
  run.planes.mark_between(points.arrays(), plane, least, most, marks.data());
  std::vector<std::uint32_t> found(points.size() + kernels::kListSlack);
  found.resize(run.lists.find_marked(marks.data(), marks.size(), found.data()));
  return found;
}

Points about(std::size_t count, const Points& points) {
  const std::size_t step = std::max<std::size_t>(1, points.size() / count);
  Points some;
  for (std::size_t i = step / 2; i < points.size(); i += step)
    some.add(points.x[i], points.y[i], points.d[i]);
  return some;
}

std::int64_t count_valid(View<const float> disparity_px, const Exec& exec) {
  std::vector<int> per_row(static_cast<std::size_t>(disparity_px.height()));
  parallel_for(exec, disparity_px.height(), 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const float* const d = disparity_px.row(y);
      int count = 0;
      for (int x = 0; x < disparity_px.width(); ++x) count += std::isnan(d[x]) ? 0 : 1;
      per_row[static_cast<std::size_t>(y)] = count;
    }
  });
  std::int64_t sum = 0;
  for (const int count : per_row) sum += count;
  return sum;
}

/// The spacing in px of the finest grid with at most about kSamples matches at its nodes.
int grid_step(std::int64_t valid) {
  return static_cast<int>(std::ceil(std::sqrt(static_cast<double>(valid) / kSamples)));
}

/// The matches at the nodes of a grid.
Points sample(View<const float> disparity_px, int step) {
  Points points;
  for (int y = 0; y < disparity_px.height(); y += step) {
    for (int x = 0; x < disparity_px.width(); x += step) {
      const float d = disparity_px(x, y);
      if (!std::isnan(d)) points.add(static_cast<float>(x), static_cast<float>(y), d);
    }
  }
  return points;
}

/// The positions of the matches below a plane's horizon relative to the plane.
struct Tally {
  int on = 0;        // within the tolerance
  int near = 0;      // else within twice the tolerance
  int below = 0;     // else farther away from the camera
  int mirrored = 0;  // those of near and below that are mirror images in the plane
  int all = 0;

  /// A surface that intersects the plane has as many matches next to it as on it, and so does noise; only the
  /// surplus on the plane is support. Matches below a floor are wrong or mirror images; known mirror images
  /// do not count.
  [[nodiscard]] int score() const { return on - near - below + mirrored; }
  /// The criterion for comparing planes: the score, and its share of the matches below the horizon. By the score
  /// alone, a plane that spans the image would beat a road that fills its lower half.
  [[nodiscard]] double rank() const {
    return score() <= 0 ? 0.0 : static_cast<double>(score()) * score() / all;
  }
  [[nodiscard]] bool convincing() const { return score() > 0 && score() >= kLeastScore * all; }
};

Tally tally(const GroundPlane& plane, const Points& points, float infinity, const Kernels& run) {
  const kernels::PlaneCounts counts = run.planes.count_about(points.arrays(), plane, infinity, kTolerance);
  return {counts.on, counts.near - counts.on, counts.below, 0, counts.all};
}

float radians(float degrees) {
  return degrees * std::numbers::pi_v<float> / 180;
}

/// The known parameters of the camera, else assumed ones.
struct Camera {
  float cx_px;
  float cy_px;
  float focal_px;
  float infinity;  // a point at infinity has disparity −infinity

  Camera(Size image, const std::optional<StereoRig>& rig)
      : cx_px(rig ? rig->cx_px : static_cast<float>(image.width - 1) / 2),
        cy_px(rig ? rig->cy_px : static_cast<float>(image.height - 1) / 2),
        focal_px(rig ? rig->focal_px : static_cast<float>(image.width)),  // 53 degrees from left to right
        infinity(rig ? rig->doffs_px : 0.0F) {}

  /// The plane's normal in the camera's frame, towards the ground, not normalised.
  [[nodiscard]] Vec3 normal(const GroundPlane& plane) const {
    return {focal_px * plane.a, focal_px * plane.b, plane.disparity_px(cx_px, cy_px) + infinity};
  }

  /// Whether the pitch and roll of a camera that sees this plane as a floor are plausible.
  [[nodiscard]] bool may_stand_on(const GroundPlane& plane) const {
    const Vec3 down = normal(plane);
    if (!(down.y > 0) || std::abs(down.x) > down.y * std::tan(radians(kMostRoll))) return false;
    const float pitch = down.z / std::hypot(down.x, down.y);
    return pitch <= std::tan(radians(kSteepestPitch)) && pitch >= std::tan(radians(kLeastPitch));
  }
};

/// The matches around a position: one of the given disparity, only farther ones, or neither.
enum class MatchAtPlace : std::uint8_t { same, farther, none };

/// An index of the matches by position.
class MatchIndex {
 public:
  MatchIndex(const Points& points, Size image, int grid_step)
      : points_(points),
        cell_(std::max(kCell, 2 * grid_step)),
        columns_(image.width / cell_ + 1),
        rows_(image.height / cell_ + 1) {
    first_.resize(static_cast<std::size_t>(columns_ * rows_) + 1);
    for (std::size_t i = 0; i < points.size(); ++i) ++first_[cell_of(i) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    members_.resize(points.size());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i) members_[next[cell_of(i)]++] = i;
  }

  /// Whether there is a match of this disparity about (x, y).
  [[nodiscard]] MatchAtPlace look(float x, float y, float d) const {
    if (!(x >= 0 && y >= 0)) return MatchAtPlace::none;
    const float column = x / static_cast<float>(cell_);
    const float row = y / static_cast<float>(cell_);
    if (!(column < static_cast<float>(columns_) && row < static_cast<float>(rows_)))
      return MatchAtPlace::none;
    const auto cell = static_cast<std::size_t>(static_cast<int>(row) * columns_ + static_cast<int>(column));
    MatchAtPlace sight = first_[cell] == first_[cell + 1] ? MatchAtPlace::none : MatchAtPlace::farther;
    for (std::size_t k = first_[cell]; k < first_[cell + 1]; ++k) {
      const float above = points_.d[members_[k]] - d;
      if (std::abs(above) <= kTolerance) return MatchAtPlace::same;
      if (above > 0) sight = MatchAtPlace::none;  // it may be hidden
    }
    return sight;
  }

 private:
  // In a coarse grid a cell is two steps wide, so that every cell has a node.
  static constexpr int kCell = 8;  // px

  [[nodiscard]] std::size_t cell_of(std::size_t i) const {
    return static_cast<std::size_t>(static_cast<int>(points_.y[i]) / cell_ * columns_ +
                                    static_cast<int>(points_.x[i]) / cell_);
  }

  const Points& points_;
  int cell_;
  int columns_;
  int rows_;
  std::vector<std::size_t> first_;
  std::vector<std::size_t> members_;
};

/// Calls visit(number, x, y, d) for each match below the plane, with the position and the disparity at which
/// the original would be seen if the plane is a mirror. A point's distance from the plane, in units of its
/// depth, is the difference of the disparities divided by the normal's length.
template <class Visit>
void for_each_original(const GroundPlane& plane, const Points& points, const Camera& camera,
                       const Kernels& run, Visit visit) {
  const Vec3 normal = camera.normal(plane);
  const float square = normal.x * normal.x + normal.y * normal.y + normal.z * normal.z;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float below_it = std::nextafter(-kTolerance, -kInfinity);
  for (const std::uint32_t i : between(points, plane, -kInfinity, below_it, run)) {
    const float below = -points.above(plane, i);
    if (plane.disparity_px(points.x[i], points.y[i]) + camera.infinity <= 0) continue;
    const float twice = 2 * below / square;
    const float z = 1 - twice * normal.z;
    if (!(z > 0)) continue;
    const float x = ((points.x[i] - camera.cx_px) / camera.focal_px - twice * normal.x) / z;
    const float y = ((points.y[i] - camera.cy_px) / camera.focal_px - twice * normal.y) / z;
    const float d = (points.d[i] + camera.infinity) / z - camera.infinity;
    visit(i, camera.cx_px + camera.focal_px * x, camera.cy_px + camera.focal_px * y, d);
  }
}

/// Splits the matches below a plane into those whose original is seen at its predicted position, and those
/// with a farther surface there.
struct Reflections {
  int seen = 0;
  int missing = 0;
};

Reflections reflections(const GroundPlane& plane, const Points& points, const MatchIndex& places,
                        const Camera& camera, const Kernels& run) {
  Reflections found;
  for_each_original(plane, points, camera, run, [&](std::uint32_t, float x, float y, float d) {
    const MatchAtPlace sight = places.look(x, y, d);
    found.seen += sight == MatchAtPlace::same ? 1 : 0;
    found.missing += sight == MatchAtPlace::farther ? 1 : 0;
  });
  return found;
}

/// The similarity of mirror images to their originals: their correlation, in standard deviations above chance. A
/// wall that a plane intersects has its lower part where the mirror image of the upper part would be; only the
/// image can distinguish the two.
double likeness(const GroundPlane& plane, const Points& points, const MatchIndex& places,
                const Camera& camera, View<const float> contrast, const Kernels& run) {
  double pp = 0;
  double pq = 0;
  double qq = 0;
  int count = 0;
  for_each_original(plane, points, camera, run, [&](std::uint32_t i, float x, float y, float d) {
    const bool apart = std::abs(points.y[i] - y) > kApart;  // else both windows contain the same pixels
    if (!apart || places.look(x, y, d) != MatchAtPlace::same) return;
    const auto u = static_cast<int>(x + 0.5F);
    const auto v = static_cast<int>(y + 0.5F);
    if (!contrast.contains(u, v)) return;
    const double p = contrast(static_cast<int>(points.x[i]), static_cast<int>(points.y[i]));
    const double q = contrast(u, v);
    pp += p * p;
    pq += p * q;
    qq += q * q;
    ++count;
  });
  return pq > 0 ? pq * std::sqrt(count / (pp * qq)) : 0;
}

/// splitmix64 (Steele, Lea, Flood 2014): a well-mixed number for each n, without a state.
std::uint64_t mixed(std::uint64_t n) {
  n += 0x9E3779B97F4A7C15U;
  n = (n ^ (n >> 30U)) * 0xBF58476D1CE4E5B9U;
  n = (n ^ (n >> 27U)) * 0x94D049BB133111EBU;
  return n ^ (n >> 31U);
}

struct PlaneHypothesis {
  GroundPlane plane;
  std::size_t i;
  std::size_t j;
  int score;
};

/// The plane through two matches for an assumed roll: two matches are correct together more often than three.
/// Most cameras are upright; for the others, refinement covers the steps between the assumed rolls.
PlaneHypothesis guess(const Points& points, std::uint64_t draw) {
  constexpr std::array kRollTangents{0.0F,  0.0F,   0.0F,  0.0F,   0.0F,  0.0F,   0.06F, -0.06F,
                                     0.12F, -0.12F, 0.18F, -0.18F, 0.26F, -0.26F, 0.36F, -0.36F};
  const std::uint64_t bits = mixed(draw);
  const auto i = static_cast<std::size_t>((bits & 0xFFFFFFU) % points.size());
  const auto j = static_cast<std::size_t>((bits >> 24U & 0xFFFFFFU) % points.size());
  const float roll = kRollTangents[bits >> 60U];
  const float down = points.y[j] - points.y[i] + roll * (points.x[j] - points.x[i]);
  const float b = down == 0 ? 0 : (points.d[j] - points.d[i]) / down;
  const float a = b * roll;
  return {{a, b, points.d[i] - a * points.x[i] - b * points.y[i]}, i, j, 0};
}

/// Possible floors, best first.
std::vector<PlaneHypothesis> guesses(const Points& points, const Camera& camera, const Kernels& run) {
  const Points few = about(kScreening, points);
  std::vector<PlaneHypothesis> list;
  for (int draw = 0; draw < kDraws && list.size() < kGuesses; ++draw) {
    PlaneHypothesis next = guess(points, static_cast<std::uint64_t>(draw));
    if (!camera.may_stand_on(next.plane)) continue;
    next.score = tally(next.plane, few, camera.infinity, run).score();
    list.push_back(next);
  }
  std::stable_sort(list.begin(), list.end(),
                   [](const PlaneHypothesis& p, const PlaneHypothesis& q) { return p.score > q.score; });
  return list;
}

/// Repeated least squares over the matches within a shrinking distance.
template <std::size_t N>
GroundPlane refined(GroundPlane plane, const Points& points, const std::array<float, N>& reaches,
                    const Kernels& run) {
  float before = 0;
  bool moved = true;
  for (const float reach : reaches) {
    if (reach == before && !moved) continue;  // the result would be the same
    PlaneFit fit(points.x[points.size() / 2], points.y[points.size() / 2]);
    const float farthest = reach * kTolerance;
    for (const std::uint32_t i : between(points, plane, -farthest, farthest, run))
      fit.add(points.x[i], points.y[i], points.d[i]);
    const GroundPlane fitted = fit.solve().value_or(plane);
    moved = fitted.a != plane.a || fitted.b != plane.b || fitted.c != plane.c;
    before = reach;
    plane = fitted;
  }
  return plane;
}

/// Whether the matches on the plane rise towards the camera as the plane does: disparities some rows apart must
/// differ by more than noise explains. This distinguishes a floor from a plane across upright surfaces at different
/// depths, for example an object in front of a wall, each of which has one disparity from top to bottom.
bool rises(const GroundPlane& plane, View<const float> disparity_px, const Points& points,
           const Kernels& run) {
  double nn = 0;  // n rows apart, d px apart
  double nd = 0;
  double dd = 0;
  int pairs = 0;
  // Farther apart than a usual matching window, which would make both equal, but still on one surface.
  const auto on_plane = between(points, plane, -kTolerance, kTolerance, run);
  for (const int rows : {disparity_px.height() / 24 + 1, disparity_px.height() / 12 + 1}) {
    for (const std::uint32_t i : on_plane) {
      const int y = static_cast<int>(points.y[i]) + rows;
      if (y >= disparity_px.height()) break;  // points are in raster order
      const float d = disparity_px(static_cast<int>(points.x[i]), y);
      if (!(std::abs(d - plane.disparity_px(points.x[i], static_cast<float>(y))) <= kTolerance)) continue;
      const double apart = double{d} - points.d[i];
      ++pairs;
      nn += rows * rows;
      nd += rows * apart;
      dd += apart * apart;
    }
  }
  if (pairs < kFewestPairs) return false;
  const double slope = nd / nn;
  const double variance = std::max(0.0, dd - slope * nd) / pairs;
  const double uncertainty = 2 * std::sqrt(kAlike * variance / nn);  // two standard deviations of the slope
  return slope - uncertainty >= kLeastRise * double{plane.b};
}

struct Candidate {
  GroundPlane plane;
  Tally tally;
};

/// The result of the search: planes that may be the floor, best first, and whether equally good planes were found
/// that cannot be a floor.
struct Candidates {
  std::vector<Candidate> floors;
  std::vector<GroundPlane> walls;
};

/// Refines candidates, best first, and calls visit(plane) for each plane that differs from the earlier ones;
/// `walls` may grow meanwhile.
template <class Visit>
void for_each_finalist(const std::vector<PlaneHypothesis>& list, const Points& points,
                       const std::vector<GroundPlane>& walls, const Kernels& run, Visit visit) {
  const Points some = about(kRefining, points);
  std::vector<GroundPlane> seen;
  for (const PlaneHypothesis& next : list) {
    if (seen.size() == kFinalists) break;
    const auto explains = [&](const GroundPlane& plane) {
      return points.on(plane, next.i) && points.on(plane, next.j);
    };
    // Candidates through a wall and another surface lead to the same wall again.
    const auto touches = [&](const GroundPlane& plane) {
      return std::min(std::abs(points.above(plane, next.i)), std::abs(points.above(plane, next.j))) <=
             2 * kTolerance;
    };
    if (std::any_of(seen.begin(), seen.end(), explains)) continue;
    if (std::any_of(walls.begin(), walls.end(), touches)) continue;
    seen.push_back(
        refined(next.plane, some, std::array{2.0F, 1.5F, 1.0F, 1.0F, 0.5F, 0.5F, 0.5F, 0.5F}, run));
    visit(seen.back());
  }
}

Candidates candidates(View<const float> disparity_px, const std::vector<PlaneHypothesis>& list,
                      const Points& points, const MatchIndex& places, const Camera& camera,
                      const Kernels& run) {
  Candidates found;
  for_each_finalist(list, points, found.walls, run, [&](const GroundPlane& plane) {
    Tally judged = tally(plane, points, camera.infinity, run);
    judged.mirrored = reflections(plane, points, places, camera, run).seen;
    if (!judged.convincing()) return;
    if (camera.may_stand_on(plane) && rises(plane, disparity_px, points, run)) {
      found.floors.push_back({plane, judged});
    } else {
      found.walls.push_back(plane);
    }
  });
  std::stable_sort(found.floors.begin(), found.floors.end(),
                   [](const Candidate& p, const Candidate& q) { return p.tally.rank() > q.tally.rank(); });
  return found;
}

/// A floor that shows hardly more than mirror images: of the planes with some matches of their own, the one
/// whose mirror images are most similar to their originals.
std::optional<GroundPlane> mirror(View<const Gray> left, std::vector<PlaneHypothesis> list,
                                  const Points& points, const std::vector<GroundPlane>& walls,
                                  const MatchIndex& places, const Camera& camera, const Kernels& run,
                                  const Exec& exec) {
  const Points few = about(kMirrorScreening, points);
  for (PlaneHypothesis& guess : list) {
    const Tally judged = tally(guess.plane, few, camera.infinity, run);
    const Reflections found = reflections(guess.plane, few, places, camera, run);
    guess.score = judged.on - judged.near + found.seen - found.missing;
  }
  std::stable_sort(list.begin(), list.end(),
                   [](const PlaneHypothesis& p, const PlaneHypothesis& q) { return p.score > q.score; });
  const Image<float> contrast = local_contrast(left, exec);
  const float nearest = *std::max_element(points.d.begin(), points.d.end());
  std::optional<GroundPlane> best;
  double most = kLeastLikeness;
  for_each_finalist(list, points, walls, run, [&](const GroundPlane& plane) {
    const auto last = static_cast<float>(left.height() - 1);
    const auto right = static_cast<float>(left.width() - 1);
    const float bottom = std::max(plane.disparity_px(0, last), plane.disparity_px(right, last));
    if (bottom + camera.infinity > kNearest * (nearest + camera.infinity)) return;
    const Tally judged = tally(plane, points, camera.infinity, run);
    const double chance = std::sqrt(judged.on + judged.near);
    if (judged.on - judged.near < 2 * chance || !camera.may_stand_on(plane)) return;
    const double alike = likeness(plane, points, places, camera, contrast, run);
    if (alike < most) return;
    most = alike;
    best = plane;
  });
  return best;
}

/// Whether most of the matches on `plane` are below `other`.
bool lies_below(const GroundPlane& plane, const GroundPlane& other, const Points& points) {
  int on = 0;
  int below = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points.on(plane, i)) continue;
    ++on;
    below += points.above(other, i) < -2 * kTolerance ? 1 : 0;
  }
  return 4 * below >= 3 * on;
}

/// Whether the two are parallel in space, within the accuracy of the fits.
bool parallel(const GroundPlane& p, const GroundPlane& q, const Camera& camera) {
  const Vec3 m = camera.normal(p);
  const Vec3 n = camera.normal(q);
  const auto dot = [](Vec3 u, Vec3 v) { return u.x * v.x + u.y * v.y + u.z * v.z; };
  return dot(m, n) >= std::cos(radians(kParallel)) * std::sqrt(dot(m, m) * dot(n, n));
}

/// The best floor; of parallel ones the lower, since the other may be the lid of a box on it.
const Candidate& choose(const std::vector<Candidate>& floors, const Points& points, const Camera& camera) {
  const Candidate* best = &floors.front();
  for (const auto& candidate : floors) {
    const bool counts = candidate.tally.score() * kLowerSurface >= floors.front().tally.score();
    const bool carries = counts && parallel(candidate.plane, best->plane, camera) &&
                         lies_below(candidate.plane, best->plane, points);
    if (carries) best = &candidate;
  }
  return *best;
}

/// Whether a plane that is not a floor explains the image: one that faces the camera, at the median
/// disparity.
bool faces_a_wall(const Points& points, const Camera& camera, const Kernels& run) {
  std::vector<float> sorted = points.d;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const auto wall = refined({0, 0, *middle}, points, std::array{2.0F, 1.0F, 1.0F}, run);
  return tally(wall, points, camera.infinity, run).convincing();
}

/// The share of all matches under the horizon that lie on the plane.
float support(const GroundPlane& plane, View<const float> disparity_px, float infinity, const Exec& exec) {
  const kernels::PlaneKernels& run = kernels::plane_kernels(exec);
  std::vector<kernels::PlaneCounts> rows(static_cast<std::size_t>(disparity_px.height()));
  parallel_for(exec, disparity_px.height(), 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      rows[static_cast<std::size_t>(y)] =
          run.count_support(disparity_px.row(y), y, disparity_px.width(), plane, infinity, kTolerance);
    }
  });
  std::int64_t on = 0;
  std::int64_t all = 0;
  for (const kernels::PlaneCounts& row : rows) {
    on += row.on;
    all += row.all;
  }
  return static_cast<float>(static_cast<double>(on) / static_cast<double>(std::max<std::int64_t>(1, all)));
}

/// Root mean square distance from the plane of the points on it.
float residual(const GroundPlane& plane, const Points& points) {
  double squares = 0;
  int on = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points.on(plane, i)) continue;
    ++on;
    squares += double{points.above(plane, i)} * points.above(plane, i);
  }
  return static_cast<float>(std::sqrt(squares / std::max(1, on)));
}

Ground refused(Refusal why) {
  return {std::nullopt, 0.0F, 0.0F, why};
}

}  // namespace

Ground find_floor(View<const float> disparity_px, View<const Gray> left, const std::optional<StereoRig>& rig,
                  const Exec& exec) {
  const std::int64_t valid = count_valid(disparity_px, exec);
  const auto least = kLeastMatches * static_cast<double>(disparity_px.size().area());
  if (valid < kFewestMatches || static_cast<double>(valid) < least) return refused(Refusal::too_few_matches);
  const int step = grid_step(valid);
  const Points points = sample(disparity_px, step);
  if (points.size() < kFewestMatches) return refused(Refusal::too_few_matches);

  const Camera camera(disparity_px.size(), rig);
  const MatchIndex places(points, disparity_px.size(), step);
  const Kernels run(exec);
  const std::vector<PlaneHypothesis> list = guesses(points, camera, run);
  const Candidates found = candidates(disparity_px, list, points, places, camera, run);
  std::optional<GroundPlane> best;
  if (!found.floors.empty()) {
    best = choose(found.floors, points, camera).plane;
  } else if (!left.empty()) {
    best = mirror(left, list, points, found.walls, places, camera, run, exec);
  }
  if (!best) {
    return refused(!found.walls.empty() || faces_a_wall(points, camera, run) ? Refusal::implausible
                                                                             : Refusal::no_plane);
  }
  const auto plane = refined(*best, points, std::array{1.0F, 0.5F, 0.5F, 0.5F}, run);
  return {plane, support(plane, disparity_px, camera.infinity, exec), residual(plane, points), Refusal::none};
}

}  // namespace cairn
