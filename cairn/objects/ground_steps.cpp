// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/objects/ground_steps.hpp>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

namespace cairn {
namespace {

constexpr float kCell = 0.1F;        // m
constexpr float kLane = 0.25F;       // m; lanes run across the step
constexpr int kLanes = 4;            // of the shortest step
constexpr int kLevelCells = 5;       // across the step, that show a level
constexpr int kHiddenCells = 10;     // across the step, that a step down may hide
constexpr float kLeast = 0.075F;     // m, of the height
constexpr float kMost = 0.35F;       // m
constexpr float kFloor = 0.04F;      // m; one level is this near to the floor
constexpr float kFlat = 0.03F;       // m, of a level's height
constexpr float kLevelShare = 0.7F;  // of its cells
constexpr float kSpread = 0.005F;    // m; levels that are flatter are as good
constexpr int kMixedCells = 3;       // across the step, between its levels
constexpr float kSigmaPx = 0.3F;     // of a disparity
constexpr float kSigmas = 4;
constexpr float kTrusted = 0.5F;
constexpr float kFew = 0.3F;        // share of the cells; fewer are noise
constexpr float kFarthest = 20;     // m
constexpr std::size_t kEnough = 3;  // pixels of a cell

/// A piece of ground, seen from above.
struct Cell {
  float x = 0;  // m, in the floor frame
  float y = 0;
  float height = 0;
  float sigma = 0;  // m, of the height by one disparity
};

int cells_along(float range_m) {
  return static_cast<int>(std::clamp(range_m, kCell, kFarthest) / kCell);
}

std::vector<Cell> cells_of(View<const ObjectId> objects, View<const float> disparity_px,
                           View<const float> confidence, const FloorFrame& floor, const StereoRig& rig,
                           float range) {
  const int length = cells_along(range);
  struct Seen {
    std::vector<float> heights;
    double disparity = 0;
  };
  std::vector<Seen> seen(slot(length) * slot(2 * length));
  for (int y = 0; y < disparity_px.height(); ++y) {
    for (int x = 0; x < disparity_px.width(); ++x) {
      if (objects(x, y) != ObjectId::none) continue;
      if (!confidence.empty() && !(confidence(x, y) >= kTrusted)) continue;
      const auto point =
          rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), disparity_px(x, y));
      if (!point) continue;
      const Vec3 at = floor.to_floor(*point);
      if (!(std::abs(at.z) <= kMost + kFloor) || !(at.x >= 0)) continue;
      const float column = std::floor(at.x / kCell),
                  row = std::floor(at.y / kCell) + static_cast<float>(length);
      if (column >= static_cast<float>(length) || row < 0 || row >= static_cast<float>(2 * length)) continue;
      Seen& of = seen[slot(static_cast<int>(row)) * slot(length) + slot(static_cast<int>(column))];
      of.heights.push_back(at.z);
      of.disparity += double{disparity_px(x, y) + rig.doffs_px};
    }
  }
  std::vector<Cell> cells;
  for (int row = 0; row < 2 * length; ++row) {
    for (int column = 0; column < length; ++column) {
      auto& [heights, disparity] = seen[slot(row) * slot(length) + slot(column)];
      if (heights.size() < kEnough) continue;
      const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
      std::nth_element(heights.begin(), middle, heights.end());
      const auto count = static_cast<float>(heights.size());
      // The height of a point on its ray is camera_height − const / d.
      const float sigma =
          kSigmaPx * std::abs(floor.camera_height_m - *middle) * count / static_cast<float>(disparity);
      cells.push_back({(static_cast<float>(column) + 0.5F) * kCell,
                       (static_cast<float>(row - length) + 0.5F) * kCell, *middle, sigma});
    }
  }
  return cells;
}

/// A step of the shortest length that is level on both sides.
struct Candidate {
  int direction = 0;
  int lane = 0;    // its first one
  float away = 0;  // m, of the edge, across the step
  float height = 0;
  float base = 0;  // m, height of the nearer level
  float score = 0;
};

/// A stretch of ground.
struct Stretch {
  std::size_t cells = 0;
  float height = 0;  // m, median
  float off = 0;     // m, mean distance of the cells from it
  float slope = 0;   // m per cell
  float sigma = 0;   // m, mean
};

/// The cells turned so that a step lies across u, sorted by lane and u.
class Turned {
 public:
  Turned(const std::vector<Cell>& cells, float angle, int length)
      : length_(length),
        lanes_(2 * static_cast<int>(static_cast<float>(length) * kCell / kLane)),
        begins_(slot(lanes_) * slot(length) + 1) {
    const float c = std::cos(angle), s = std::sin(angle);
    std::vector<std::pair<std::size_t, Turn>> all;
    for (const Cell& cell : cells) {
      const float u = (cell.x * c + cell.y * s) / kCell, t = (cell.y * c - cell.x * s) / kLane;
      const int lane = static_cast<int>(std::floor(t)) + lanes_ / 2;
      if (u < 0 || u >= static_cast<float>(length) || lane < 0 || lane >= lanes_) continue;
      all.push_back({at(lane, static_cast<int>(u)), {u, cell.height, cell.sigma}});
    }
    std::ranges::stable_sort(all, {}, &std::pair<std::size_t, Turn>::first);
    for (const auto& [place, turn] : all) {
      ++begins_[place + 1];
      turns_.push_back(turn);
    }
    for (std::size_t i = 1; i < begins_.size(); ++i) begins_[i] += begins_[i - 1];
    levels_.resize(slot(lanes_) * slot(length));
    for (int lane = 0; lane + kLanes <= lanes_; ++lane) {
      for (int line = 0; line + kLevelCells <= length; ++line)
        levels_[at(lane, line)] = stretch(lane, kLanes, line);
    }
  }
  [[nodiscard]] int lanes() const { return lanes_; }

  /// The step whose nearer level ends at the line `edge`, if there is one.
  std::optional<Candidate> step(int lane, int edge) {
    const Stretch& near = levels_[at(lane, edge - kLevelCells)];
    if (!near.cells) return std::nullopt;
    // Cells that show both levels, or an upright face, lie between them; behind a step down there is hardly anything.
    std::size_t seen = 0;
    for (int gap = 1; gap <= kHiddenCells && edge + gap + kLevelCells <= length_; ++gap) {
      if (gap > kMixedCells) {
        seen += count(lane, kLanes, edge + gap - 2, edge + gap - 1);
        const auto hidden = static_cast<float>(gap - kMixedCells);
        if (static_cast<float>(seen) > kFew * kCellsAcross * hidden) return std::nullopt;
      }
      const Stretch& far = levels_[at(lane, edge + gap)];
      if (!far.cells) continue;
      const float height = far.height - near.height;
      if (gap > kMixedCells && height > 0) return std::nullopt;
      const float least = std::max(kLeast, kSigmas * (near.sigma + far.sigma) / 2);
      if (std::abs(height) < least || std::abs(height) > kMost) continue;
      if (std::min(std::abs(far.height), std::abs(near.height)) > kFloor) continue;
      // A ramp rises within its stretches, too; so does a hump, whose farther side may be hidden.
      if (std::max(std::abs(near.slope), std::abs(far.slope)) * kLevelCells > 0.4F * std::abs(height))
        continue;
      const float rise = (near.slope + far.slope) / 2 * static_cast<float>(kLevelCells + gap);
      if ((height - rise) / height < 0.6F) continue;
      int agreeing = 0;
      for (int k = lane; k < lane + kLanes; ++k) {
        const Stretch before = stretch(k, 1, edge - kLevelCells);
        const Stretch after = stretch(k, 1, edge + gap);
        agreeing += before.cells && after.cells && (after.height - before.height) / height > 0.6F ? 1 : 0;
      }
      if (agreeing < kLanes - 1) continue;
      // A step down is where the nearer level ends; the stretch may reach beyond that.
      int last = edge;
      while (static_cast<float>(count(lane, kLanes, last - 1, last)) < kFew * kCellsAcross) --last;
      const float end = static_cast<float>(last) + (height > 0 ? static_cast<float>(gap) / 2 : 0);
      return Candidate{0,      lane,        kCell * end,
                       height, near.height, std::abs(height) / (kSpread + near.off + far.off)};
    }
    return std::nullopt;
  }

 private:
  struct Turn {
    float u = 0;  // cells
    float height = 0;
    float sigma = 0;
  };
  static constexpr float kCellsAcross = kLanes * kLane / kCell;  // of the shortest step

  [[nodiscard]] std::size_t at(int lane, int line) const { return slot(lane) * slot(length_) + slot(line); }
  [[nodiscard]] std::size_t count(int lane, int lanes, int first, int last) const {
    std::size_t all = 0;
    for (int k = lane; k < lane + lanes; ++k) all += begins_[at(k, last)] - begins_[at(k, first)];
    return all;
  }
  /// kLevelCells from line `first` on. No cells if it is not level, or if less than half of it is seen.
  Stretch stretch(int lane, int lanes, int first) {
    constexpr float kHalf = 0.5F * kLane / kCell * kLevelCells;
    const int last = first + kLevelCells;
    const std::size_t n = count(lane, lanes, first, last);
    if (static_cast<float>(n) < kHalf * static_cast<float>(lanes)) return {};
    given_.clear();
    for (int k = lane; k < lane + lanes; ++k) {
      given_.insert(given_.end(), turns_.begin() + static_cast<std::ptrdiff_t>(begins_[at(k, first)]),
                    turns_.begin() + static_cast<std::ptrdiff_t>(begins_[at(k, last)]));
    }
    const auto middle = given_.begin() + static_cast<std::ptrdiff_t>(n / 2);
    std::ranges::nth_element(given_, middle, {}, &Turn::height);
    Stretch all{n, middle->height};
    float level = 0, used = 0, u = 0, z = 0, uu = 0, uz = 0;
    for (const Turn& turn : given_) {
      all.sigma += turn.sigma / static_cast<float>(n);
      const float off = turn.height - all.height, at = turn.u - static_cast<float>(first);
      all.off += std::min(std::abs(off), kMost) / static_cast<float>(n);
      level += std::abs(off) <= kFlat ? 1.0F : 0.0F;
      if (std::abs(off) > 2 * kFlat) continue;
      used += 1, u += at, z += off, uu += at * at, uz += at * off;
    }
    if (level < kLevelShare * static_cast<float>(n)) return {};
    const float spread = uu - u * u / used;
    all.slope = spread > 0 ? (uz - u * z / used) / spread : 0;
    return all;
  }

  int length_;
  int lanes_;
  std::vector<std::size_t> begins_;
  std::vector<Turn> turns_;
  std::vector<Turn> given_;      // to stretch()
  std::vector<Stretch> levels_;  // of kLanes from a lane on, from a line on
};

}  // namespace

std::vector<GroundStep> find_steps(View<const ObjectId> objects, View<const float> disparity_px,
                                   View<const float> confidence, const FloorFrame& floor,
                                   const StereoRig& rig, const ObstaclesConfig& config) {
  constexpr int kDirections = 13;  // of the way across the step: up to 90° to either side
  const int length = cells_along(config.range);
  const auto angle_of = [](int direction) {
    const int from_straight = direction - kDirections / 2;
    return static_cast<float>(from_straight) * 15 * std::numbers::pi_v<float> / 180;
  };
  const std::vector<Cell> cells = cells_of(objects, disparity_px, confidence, floor, rig, config.range);
  std::vector<Candidate> all;
  int lanes = 0;
  for (int direction = 0; direction < kDirections; ++direction) {
    Turned turned(cells, angle_of(direction), length);
    lanes = turned.lanes();
    for (int lane = 0; lane + kLanes <= lanes; ++lane) {
      for (int edge = kLevelCells; edge + 1 + kLevelCells <= length; ++edge) {
        if (std::optional<Candidate> found = turned.step(lane, edge)) {
          found->direction = direction;
          all.push_back(*found);
        }
      }
    }
  }
  std::ranges::stable_sort(all, std::ranges::greater{}, &Candidate::score);

  // The best one is as long as its neighbours in the same line; what is near to it is the same step.
  const auto place = [&](const Candidate& of, float lane) {
    const float angle = angle_of(of.direction), t = (lane - static_cast<float>(lanes) / 2) * kLane;
    return Vec3{of.away * std::cos(angle) - t * std::sin(angle),
                of.away * std::sin(angle) + t * std::cos(angle), of.base};
  };
  std::vector<GroundStep> steps;
  while (!all.empty()) {
    const Candidate best = all.front();
    const auto continues = [&](int lane) {
      return std::ranges::any_of(all, [&](const Candidate& other) {
        return other.direction == best.direction && other.lane == lane &&
               std::abs(other.away - best.away) < 2.5F * kCell &&
               std::abs(other.height - best.height) < kFloor;
      });
    };
    int first = best.lane, last = best.lane;
    while (continues(first - 1)) --first;
    while (continues(last + 1)) ++last;
    const GroundStep step{place(best, static_cast<float>(first)),
                          place(best, static_cast<float>(last + kLanes)), best.height};
    steps.push_back(step);
    const Vec3 along{step.to_m.x - step.from_m.x, step.to_m.y - step.from_m.y, 0};
    const float size = std::hypot(along.x, along.y);
    std::erase_if(all, [&](const Candidate& other) {
      const Vec3 middle = place(other, static_cast<float>(other.lane) + kLanes / 2.0F);
      const float x = middle.x - step.from_m.x, y = middle.y - step.from_m.y;
      const float t = std::clamp((x * along.x + y * along.y) / size, 0.0F, size);
      return std::hypot(x - t * along.x / size, y - t * along.y / size) < 8 * kCell;
    });
  }
  std::ranges::stable_sort(steps, {}, [](const GroundStep& s) {
    return std::hypot(s.from_m.x + s.to_m.x, s.from_m.y + s.to_m.y);
  });
  return steps;
}

void add_steps(ObstacleGrid& grid, const std::vector<GroundStep>& steps) {
  for (const GroundStep& step : steps) {
    const float along_x = step.to_m.x - step.from_m.x, along_y = step.to_m.y - step.from_m.y;
    const int pieces = static_cast<int>(4 * std::hypot(along_x, along_y) / grid.cell_size_m) + 1;
    for (int piece = 0; piece <= pieces; ++piece) {
      const float share = static_cast<float>(piece) / static_cast<float>(pieces);
      const float x = (step.from_m.x + share * along_x - grid.origin_x_m) / grid.cell_size_m;
      const float y = (step.from_m.y + share * along_y - grid.origin_y_m) / grid.cell_size_m;
      if (x < 0 || y < 0 || x >= static_cast<float>(grid.width) || y >= static_cast<float>(grid.height))
        continue;
      grid.cells[slot(static_cast<int>(y)) * slot(grid.width) + slot(static_cast<int>(x))] =
          ObstacleGrid::kOccupied;
    }
  }
}

}  // namespace cairn
