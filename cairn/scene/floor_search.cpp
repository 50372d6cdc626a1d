// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/image/local_contrast.hpp>
#include <cairn/scene/floor_search.hpp>
#include <cairn/scene/plane_fit.hpp>
#include <cairn/scene/plane_kernels.hpp>
#include <cairn/stereo/label_kernels.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
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
constexpr float kMinPitch = -30.0F;  // degrees; a camera that looks up more sees no floor
constexpr float kMaxRoll = 20.0F;    // degrees
constexpr float kParallel = 5.0F;    // degrees; fits to parallel surfaces differ by less

// The conditions for accepting a floor.
constexpr double kMinMatches = 0.005;  // share of the image
constexpr std::int64_t kMinMatchesSeen = 64;
constexpr double kMinScore = 0.05;    // share of the matches under the plane's horizon
constexpr double kMinRise = 0.5;      // share of its slope that the matches certainly show from row to row
constexpr int kMinPairs = 8;          // of matches, to judge the slope
constexpr double kAlike = 4;          // number of neighbouring matches with the same error
constexpr double kMinLikeness = 7.5;  // standard deviations: similarity of mirror images to their originals
constexpr double kConfirmedLikeness = 5;  // the same, after a fit to all matches that confirm the plane
constexpr double kNoLikeness = 2;         // the same; less is chance
constexpr double kMinSurplus = 6;         // standard deviations: of matches on a mirror over those beside it
constexpr int kMinSeen = 3;               // originals seen for each one that is missing, of a mirror
constexpr float kNearest = 1.25F;  // times the nearest match: the nearest a floor may be at the lower border
constexpr float kApart = 4;        // px; least distance from an original
constexpr int kLowerSurface = 3;   // a plane below the best counts with a third of its score

// Fitted to planes that are a floor and planes that are none (lab/floors.py; docs/stages/ground.md, "Plausible
// floors"): the log odds of a floor.
constexpr double kOddsAtOnce = 0.7;     // without support, upright, at a usual height
constexpr double kOddsOfSupport = 4.5;  // per share of the matches under the horizon
constexpr double kOddsOfRoll = -0.15;   // per degree
constexpr double kOddsOfHeight = -5.6;  // per factor e above the usual heights
constexpr double kOddsOfDepth = -4.1;   // per factor e below them
constexpr double kUsuallyHighest = 40;  // baselines
constexpr double kUsuallyLowest = 1.5;  // baselines

// The effort of the search: one to three milliseconds, four more if the left image is used.
constexpr std::size_t kSamples = 4096;
constexpr std::size_t kRefining = 1024;  // of them, for least squares
constexpr std::size_t kScreening = 512;  // of them, to score a candidate
constexpr std::size_t kMirrorScreening = 256;
constexpr int kDraws = 8192;
constexpr std::size_t kGuesses = 1024;
constexpr std::size_t kFinalists = 24;
constexpr std::size_t kMirrorGuesses = 512;
constexpr std::size_t kMirrorFinalists = 32;
constexpr std::size_t kMirrorClimbs = 6;
constexpr int kClimbs = 6;  // rounds for each step

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
  [[nodiscard]] double support() const { return static_cast<double>(on) / std::max(1, all); }
  [[nodiscard]] bool convincing() const { return score() > 0 && score() >= kMinScore * all; }
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
    if (!(down.y > 0) || std::abs(down.x) > down.y * std::tan(radians(kMaxRoll))) return false;
    const float pitch = down.z / std::hypot(down.x, down.y);
    return pitch <= std::tan(radians(kSteepestPitch)) && pitch >= std::tan(radians(kMinPitch));
  }
};

/// The log odds that a plane with this support (0 … 1) is a floor: a camera stands upright, some baselines above its
/// floor; the less usual a plane is, the more of what is seen must lie on it.
double floor_odds(const GroundPlane& plane, double support, const Camera& camera) {
  const Vec3 down = camera.normal(plane);
  const auto x = double{down.x};
  const auto y = double{down.y};
  const double height = double{camera.focal_px} / std::sqrt(x * x + y * y + double{down.z} * double{down.z});
  const double roll = std::abs(std::atan2(x, y)) * 180 / std::numbers::pi;
  return kOddsAtOnce + kOddsOfSupport * support + kOddsOfRoll * roll +
         kOddsOfHeight * std::max(0.0, std::log(height / kUsuallyHighest)) +
         kOddsOfDepth * std::max(0.0, std::log(kUsuallyLowest / height));
}

/// The matches around a position: one of the given disparity, only farther ones, or neither.
enum class MatchAtPlace : std::uint8_t { same, farther, none };

/// An index of the matches by position.
class MatchIndex {
 public:
  MatchIndex(const Points& points, Size image, int grid_step)
      : cell_(std::max(kCell, 2 * grid_step)),
        columns_(image.width / cell_ + 1),
        rows_(image.height / cell_ + 1) {
    first_.resize(static_cast<std::size_t>(columns_ * rows_) + 1);
    for (std::size_t i = 0; i < points.size(); ++i) ++first_[cell_of(points, i) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    disparities_.resize(points.size());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i) disparities_[next[cell_of(points, i)]++] = points.d[i];
  }

  /// Whether there is a match of this disparity about (x, y).
  [[nodiscard]] MatchAtPlace look(float x, float y, float d) const {
    if (!(x >= 0 && y >= 0)) return MatchAtPlace::none;
    const float column = x * by_cell_;
    const float row = y * by_cell_;
    if (!(column < static_cast<float>(columns_) && row < static_cast<float>(rows_)))
      return MatchAtPlace::none;
    const auto cell = static_cast<std::size_t>(static_cast<int>(row) * columns_ + static_cast<int>(column));
    const float* const begin = disparities_.data() + first_[cell];
    const float* const end = disparities_.data() + first_[cell + 1];
    MatchAtPlace detect = begin == end ? MatchAtPlace::none : MatchAtPlace::farther;
    for (const float* at = begin; at != end; ++at) {
      const float above = *at - d;
      if (std::abs(above) <= kTolerance) return MatchAtPlace::same;
      if (above > 0) detect = MatchAtPlace::none;  // it may be hidden
    }
    return detect;
  }

 private:
  // In a coarse grid a cell is two steps wide, so that every cell has a node.
  static constexpr int kCell = 8;  // px

  [[nodiscard]] std::size_t cell_of(const Points& points, std::size_t i) const {
    return static_cast<std::size_t>(static_cast<int>(points.y[i]) / cell_ * columns_ +
                                    static_cast<int>(points.x[i]) / cell_);
  }

  int cell_;
  float by_cell_ = 1 / static_cast<float>(cell_);
  int columns_;
  int rows_;
  std::vector<std::uint32_t> first_;
  std::vector<float> disparities_;  // by cell
};

/// The matches of a map that the search uses.
struct SampledMap {
  View<const float> disparity_px;
  int step;
  Points points;
  MatchIndex places;
  float nearest = 0;  // the largest disparity, px

  SampledMap(View<const float> map, std::int64_t valid)
      : disparity_px(map),
        step(grid_step(valid)),
        points(sample(map, step)),
        places(points, map.size(), step) {
    if (points.size() > 0) nearest = *std::max_element(points.d.begin(), points.d.end());
  }
  SampledMap(const SampledMap&) = delete;  // the index refers to the points
  SampledMap& operator=(const SampledMap&) = delete;
  SampledMap(SampledMap&&) = delete;
  SampledMap& operator=(SampledMap&&) = delete;
  ~SampledMap() = default;
};

/// Calls visit(number, x, y, d) for each match below the plane, with the position and the disparity at which
/// the original would be seen if the plane is a mirror. A point's distance from the plane, in units of its
/// depth, is the difference of the disparities divided by the normal's length.
template <class Visit>
void for_each_original(const GroundPlane& plane, const Points& points, const Camera& camera,
                       const Kernels& run, Visit visit) {
  const Vec3 normal = camera.normal(plane);
  const float twice_by_square = 2 / (normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
  const float by_focal = 1 / camera.focal_px;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float below_it = std::nextafter(-kTolerance, -kInfinity);
  for (const std::uint32_t i : between(points, plane, -kInfinity, below_it, run)) {
    const float below = -points.above(plane, i);
    if (plane.disparity_px(points.x[i], points.y[i]) + camera.infinity <= 0) continue;
    const float twice = twice_by_square * below;
    const float z = 1 - twice * normal.z;
    if (!(z > 0)) continue;
    const float by_z = 1 / z;
    const float x = ((points.x[i] - camera.cx_px) * by_focal - twice * normal.x) * by_z;
    const float y = ((points.y[i] - camera.cy_px) * by_focal - twice * normal.y) * by_z;
    const float d = (points.d[i] + camera.infinity) * by_z - camera.infinity;
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
    const MatchAtPlace detect = places.look(x, y, d);
    found.seen += detect == MatchAtPlace::same ? 1 : 0;
    found.missing += detect == MatchAtPlace::farther ? 1 : 0;
  });
  return found;
}

/// The similarity of mirror images to their originals: their correlation, in standard deviations above chance. A
/// wall that a plane intersects has its lower part where the mirror image of the upper part would be; only the
/// image can distinguish the two.
struct MirrorImages {
  Reflections found;
  double likeness = 0;
};

MirrorImages mirror_images(const GroundPlane& plane, const Points& points, const MatchIndex& places,
                           const Camera& camera, View<const float> contrast, const Kernels& run) {
  Reflections found;
  double pp = 0;
  double pq = 0;
  double qq = 0;
  int count = 0;
  for_each_original(plane, points, camera, run, [&](std::uint32_t i, float x, float y, float d) {
    const MatchAtPlace detect = places.look(x, y, d);
    found.missing += detect == MatchAtPlace::farther ? 1 : 0;
    if (detect != MatchAtPlace::same) return;
    ++found.seen;
    if (std::abs(points.y[i] - y) <= kApart) return;  // both windows contain the same pixels
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
  return {found, pq > 0 ? pq * std::sqrt(count / (pp * qq)) : 0};
}

double likeness(const GroundPlane& plane, const Points& points, const MatchIndex& places,
                const Camera& camera, View<const float> contrast, const Kernels& run) {
  return mirror_images(plane, points, places, camera, contrast, run).likeness;
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

/// rising: certainly; flat: more likely than rising; unknown: too few matches, or too uncertain.
enum class Slope : std::uint8_t { rising, flat, unknown };

/// Whether the matches on the plane rise towards the camera as the plane does: disparities some rows apart must
/// differ by more than noise explains. This distinguishes a floor from a plane across upright surfaces at different
/// depths, for example an object in front of a wall, each of which has one disparity from top to bottom.
Slope slope_on(const GroundPlane& plane, const SampledMap& seen, const Kernels& run) {
  const View<const float> disparity_px = seen.disparity_px;
  const Points& points = seen.points;
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
  if (pairs < kMinPairs) return Slope::unknown;
  const double slope = nd / nn;
  const double variance = std::max(0.0, dd - slope * nd) / pairs;
  const double uncertainty = 2 * std::sqrt(kAlike * variance / nn);  // two standard deviations of the slope
  const double least = kMinRise * double{plane.b};
  if (slope - uncertainty >= least) return Slope::rising;
  return slope < least ? Slope::flat : Slope::unknown;
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
  bool has_unlikely = false;  // some of `walls` rise like a floor
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

/// The local contrast of the left image, computed when it is first needed.
class Contrast {
 public:
  Contrast(View<const Gray> left, const Exec& exec) : left_(left), exec_(exec) {}
  [[nodiscard]] bool is_known() const { return !left_.empty(); }
  [[nodiscard]] View<const float> view() {
    if (contrast_.empty()) contrast_ = local_contrast(left_, exec_);
    return contrast_;
  }

 private:
  View<const Gray> left_;
  const Exec& exec_;
  Image<float> contrast_;
};

/// The tally with the mirror images among the matches.
Tally tally_with_mirrored(const GroundPlane& plane, const SampledMap& seen, const Camera& camera,
                          const Kernels& run) {
  Tally judged = tally(plane, seen.points, camera.infinity, run);
  judged.mirrored = reflections(plane, seen.points, seen.places, camera, run).seen;
  return judged;
}

/// Whether textured matches show the plane to be upright. Smooth matches can rise across what has no texture.
bool is_upright(const GroundPlane& plane, const SampledMap& textured, const Camera& camera,
                const Kernels& run) {
  return tally_with_mirrored(plane, textured, camera, run).convincing() &&
         slope_on(plane, textured, run) == Slope::flat;
}

/// `textured` may be null.
Candidates candidates(const std::vector<PlaneHypothesis>& list, const SampledMap& seen,
                      const SampledMap* textured, Contrast& contrast, const Camera& camera,
                      const Kernels& run) {
  Candidates found;
  for_each_finalist(list, seen.points, found.walls, run, [&](const GroundPlane& plane) {
    const Tally judged = tally_with_mirrored(plane, seen, camera, run);
    if (!judged.convincing()) return;
    if (!camera.may_stand_on(plane) || slope_on(plane, seen, run) != Slope::rising ||
        (textured && is_upright(plane, *textured, camera, run))) {
      found.walls.push_back(plane);
      return;
    }
    if (floor_odds(plane, judged.support(), camera) < 0) {
      found.walls.push_back(plane);
      found.has_unlikely = true;
      return;
    }
    // A plane that only its mirror images support must be a mirror indeed.
    const bool is_carried = judged.score() < judged.mirrored;
    const bool is_no_mirror =
        is_carried && contrast.is_known() &&
        likeness(plane, seen.points, seen.places, camera, contrast.view(), run) < kNoLikeness;
    if (!is_no_mirror) found.floors.push_back({plane, judged});
  });
  std::stable_sort(found.floors.begin(), found.floors.end(),
                   [](const Candidate& p, const Candidate& q) { return p.tally.rank() > q.tally.rank(); });
  return found;
}

/// Whether a floor may be as near as this at the lower border, given the nearest match.
bool is_within_reach(const GroundPlane& plane, float nearest, Size image, const Camera& camera) {
  const auto last = static_cast<float>(image.height - 1);
  const auto right = static_cast<float>(image.width - 1);
  const float bottom = std::max(plane.disparity_px(0, last), plane.disparity_px(right, last));
  return bottom + camera.infinity <= kNearest * (nearest + camera.infinity);
}

/// A floor that shows little but mirror images: of the planes with matches of their own, the one whose mirror
/// images are most similar to their originals.
std::optional<GroundPlane> mirror(std::vector<PlaneHypothesis> list, const SampledMap& seen,
                                  View<const float> contrast, const std::vector<GroundPlane>& walls,
                                  const Camera& camera, const Kernels& run) {
  const Points few = about(kMirrorScreening, seen.points);
  for (PlaneHypothesis& guess : list) {
    const Tally judged = tally(guess.plane, few, camera.infinity, run);
    const Reflections found = reflections(guess.plane, few, seen.places, camera, run);
    guess.score = judged.on - judged.near + found.seen - found.missing;
  }
  std::stable_sort(list.begin(), list.end(),
                   [](const PlaneHypothesis& p, const PlaneHypothesis& q) { return p.score > q.score; });
  std::optional<GroundPlane> best;
  double most = kMinLikeness;
  for_each_finalist(list, seen.points, walls, run, [&](const GroundPlane& plane) {
    if (!is_within_reach(plane, seen.nearest, contrast.size(), camera)) return;
    const Tally judged = tally(plane, seen.points, camera.infinity, run);
    const double chance = std::sqrt(judged.on + judged.near);
    if (judged.on - judged.near < 2 * chance || !camera.may_stand_on(plane)) return;
    const double alike = likeness(plane, seen.points, seen.places, camera, contrast, run);
    if (alike < most) return;
    most = alike;
    best = plane;
  });
  return best;
}

/// The plane in which match i is the mirror image of match j: half-way between both, and square to the line
/// through them.
std::optional<GroundPlane> plane_between(const Points& points, std::size_t i, std::size_t j,
                                         const Camera& camera) {
  const auto point = [&](std::size_t k) {  // in baselines
    const float z = 1 / (points.d[k] + camera.infinity);
    return Vec3{(points.x[k] - camera.cx_px) / camera.focal_px * z,
                (points.y[k] - camera.cy_px) / camera.focal_px * z, z};
  };
  if (!(std::min(points.d[i], points.d[j]) + camera.infinity > kTolerance)) return std::nullopt;
  const Vec3 image = point(i);
  const Vec3 original = point(j);
  const Vec3 n{image.x - original.x, image.y - original.y, image.z - original.z};  // its length cancels
  const float twice_height =
      n.x * (image.x + original.x) + n.y * (image.y + original.y) + n.z * (image.z + original.z);
  if (!(twice_height > 0)) return std::nullopt;
  GroundPlane plane;
  plane.a = 2 * n.x / (camera.focal_px * twice_height);
  plane.b = 2 * n.y / (camera.focal_px * twice_height);
  plane.c = 2 * n.z / twice_height - plane.a * camera.cx_px - plane.b * camera.cy_px - camera.infinity;
  return plane;
}

/// Planes between pairs of matches of about the same column, of which one may be the mirror image of the other.
std::vector<PlaneHypothesis> mirror_guesses(const Points& points, const Camera& camera) {
  constexpr int kColumn = 8;  // px
  const float right = *std::max_element(points.x.begin(), points.x.end());
  std::vector<std::vector<std::uint32_t>> columns(static_cast<std::size_t>(right) / kColumn + 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    columns[static_cast<std::size_t>(points.x[i]) / kColumn].push_back(static_cast<std::uint32_t>(i));
  std::vector<PlaneHypothesis> list;
  for (int draw = 0; draw < kDraws && list.size() < kMirrorGuesses; ++draw) {
    const std::uint64_t bits = mixed(static_cast<std::uint64_t>(draw));
    const auto i = static_cast<std::size_t>((bits & 0xFFFFFFU) % points.size());
    const auto& column = columns[static_cast<std::size_t>(points.x[i]) / kColumn];
    const std::size_t j = column[static_cast<std::size_t>(bits >> 24U & 0xFFFFFFU) % column.size()];
    // The image is below its original, and as far away or farther.
    if (points.y[i] < points.y[j] + 2 * kApart || points.d[i] > points.d[j] + kTolerance) continue;
    const auto plane = plane_between(points, i, j, camera);
    if (plane && camera.may_stand_on(*plane)) list.push_back({*plane, i, j, 0});
  }
  return list;
}

/// How much a plane is a mirror: its likeness, or 0 where it may be no floor.
class MirrorJudge {
 public:
  MirrorJudge(const SampledMap& seen, View<const float> contrast, const Camera& camera, const Kernels& run)
      : seen_(seen), contrast_(contrast), camera_(camera), run_(run) {}

  [[nodiscard]] double operator()(const GroundPlane& plane, const Points& points) const {
    if (!camera_.may_stand_on(plane) || !is_within_reach(plane, seen_.nearest, contrast_.size(), camera_))
      return 0;
    const auto [found, alike] = mirror_images(plane, points, seen_.places, camera_, contrast_, run_);
    return found.seen == 0 || kMinSeen * found.missing > found.seen ? 0 : alike;
  }
  [[nodiscard]] double operator()(const GroundPlane& plane) const { return (*this)(plane, seen_.points); }

  /// Whether climbing from both would lead to the same plane.
  [[nodiscard]] bool are_alike(const GroundPlane& p, const GroundPlane& q) const {
    const auto last = static_cast<float>(contrast_.height() - 1);
    const auto apart = [&](float y) {
      return std::abs(p.disparity_px(camera_.cx_px, y) - q.disparity_px(camera_.cx_px, y));
    };
    return std::max(apart(last / 2), apart(last)) <= kNear;
  }

  /// Moves the plane in small steps while it becomes a better mirror. Returns its likeness.
  double climb(GroundPlane& plane) const {
    climb(plane, some_, {4.0F, 2.0F, 1.0F, 0.5F});
    return (*this)(plane);
  }

 private:
  /// `steps`: px, at the middle row, the last row, the sides.
  double climb(GroundPlane& plane, const Points& points, std::initializer_list<float> steps) const {
    const float middle = 0.5F * static_cast<float>(contrast_.height());
    const auto last = static_cast<float>(contrast_.height() - 1);
    const float half_width = 0.5F * static_cast<float>(contrast_.width());
    double most = (*this)(plane, points);
    for (const float step : steps) {
      bool moved = true;
      for (int round = 0; moved && round < kClimbs; ++round) {
        moved = false;
        for (const auto& [at_middle, at_last, at_side] : kSteps) {
          const float up = plane.disparity_px(camera_.cx_px, middle) + at_middle * step;
          const float down = plane.disparity_px(camera_.cx_px, last) + at_last * step;
          GroundPlane next;
          next.a = plane.a + at_side * step / half_width;
          next.b = (down - up) / (last - middle);
          next.c = up - next.b * middle - next.a * camera_.cx_px;
          const double alike = (*this)(next, points);
          if (!(alike > most)) continue;
          most = alike;
          plane = next;
          moved = true;
        }
      }
    }
    return most;
  }

  static constexpr float kNear = 2;  // px
  static constexpr std::array<std::array<float, 3>, 6> kSteps{
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

  const SampledMap& seen_;
  Points some_ = about(kRefining, seen_.points);
  View<const float> contrast_;
  const Camera& camera_;
  const Kernels& run_;
};

/// A floor that is known by what it mirrors, of which textured matches tell, and by smooth matches of its own,
/// which both must confirm: neither is enough by itself.
std::optional<GroundPlane> confirmed_mirror(std::vector<PlaneHypothesis> list, const SampledMap& seen,
                                            const SampledMap& textured, View<const float> contrast,
                                            const Camera& camera, const Kernels& run) {
  const MirrorJudge judge(textured, contrast, camera, run);
  const std::vector<PlaneHypothesis> between = mirror_guesses(textured.points, camera);
  list.insert(list.end(), between.begin(), between.end());
  const Points few = about(kMirrorScreening, textured.points);
  for (PlaneHypothesis& guess : list) guess.score = static_cast<int>(1000 * judge(guess.plane, few));
  const auto better = [](const PlaneHypothesis& p, const PlaneHypothesis& q) { return p.score > q.score; };
  std::stable_sort(list.begin(), list.end(), better);
  list.resize(std::min(list.size(), kMirrorFinalists));
  for (PlaneHypothesis& guess : list) guess.score = static_cast<int>(1000 * judge(guess.plane));
  std::stable_sort(list.begin(), list.end(), better);
  std::optional<GroundPlane> best;
  double most = kMinLikeness;
  std::vector<GroundPlane> starts;
  for (const PlaneHypothesis& guess : list) {
    if (starts.size() == kMirrorClimbs) break;
    if (std::any_of(starts.begin(), starts.end(),
                    [&](const GroundPlane& start) { return judge.are_alike(start, guess.plane); })) {
      continue;
    }
    starts.push_back(guess.plane);
    GroundPlane plane = guess.plane;
    const double alike = judge.climb(plane);
    if (alike < most) continue;
    plane = refined(plane, seen.points, std::array{1.0F, 0.75F, 1.0F, 0.5F, 0.5F, 0.5F}, run);
    const Tally judged = tally(plane, seen.points, camera.infinity, run);
    const double chance = std::sqrt(judged.on + judged.near);
    const bool is_confirmed = judged.on - judged.near >= kMinSurplus * chance &&
                              slope_on(plane, seen, run) == Slope::rising &&
                              judge(plane) >= kConfirmedLikeness;
    if (!is_confirmed) continue;
    most = alike;
    best = plane;
  }
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

Ground find_floor(View<const float> disparity_px, const FloorCues& cues, const std::optional<StereoRig>& rig,
                  const Exec& exec) {
  const auto enough = [](View<const float> map, std::int64_t valid) {
    const auto least = kMinMatches * static_cast<double>(map.size().area());
    return valid >= kMinMatchesSeen && static_cast<double>(valid) >= least;
  };
  const std::int64_t valid = count_valid(disparity_px, exec);
  if (!enough(disparity_px, valid)) return refused(Refusal::too_few_matches);
  const SampledMap seen(disparity_px, valid);
  if (seen.points.size() < kMinMatchesSeen) return refused(Refusal::too_few_matches);
  std::optional<SampledMap> textured;
  if (!cues.textured_px.empty()) {
    const std::int64_t of_them = count_valid(cues.textured_px, exec);
    if (enough(cues.textured_px, of_them)) textured.emplace(cues.textured_px, of_them);
    if (textured && textured->points.size() < kMinMatchesSeen) textured.reset();
  }
  const SampledMap* const if_textured = textured ? &*textured : nullptr;
  Contrast contrast(cues.left, exec);

  const Camera camera(disparity_px.size(), rig);
  const Kernels run(exec);
  const std::vector<PlaneHypothesis> list = guesses(seen.points, camera, run);
  const Candidates found = candidates(list, seen, if_textured, contrast, camera, run);
  std::optional<GroundPlane> best;
  if (!found.floors.empty()) {
    best = choose(found.floors, seen.points, camera).plane;
  } else if (contrast.is_known() && if_textured) {
    best = confirmed_mirror(list, seen, *if_textured, contrast.view(), camera, run);
  } else if (contrast.is_known()) {
    best = mirror(list, seen, contrast.view(), found.walls, camera, run);
  }
  if (!best) {
    if (found.has_unlikely) return refused(Refusal::unlikely);
    return refused(!found.walls.empty() || faces_a_wall(seen.points, camera, run) ? Refusal::implausible
                                                                                  : Refusal::no_plane);
  }
  const auto plane = refined(*best, seen.points, std::array{1.0F, 0.5F, 0.5F, 0.5F}, run);
  const float supported = support(plane, disparity_px, camera.infinity, exec);
  if (floor_odds(plane, double{supported}, camera) < 0) return refused(Refusal::unlikely);
  return {plane, supported, residual(plane, seen.points), Refusal::none};
}

}  // namespace cairn
