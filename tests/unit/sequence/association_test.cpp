// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/core/random.hpp>
#include <limits>
#include <vector>

#include <cairn/sequence/assign.hpp>
#include <cairn/sequence/tracks.hpp>

namespace cairn {
namespace {

constexpr auto kForbidden = CostTable::kForbidden;

/// The slow twin of assign(): tries all assignments in the order that decides ties, and keeps the first of
/// the cheapest.
class AllWays {
 public:
  explicit AllWays(const CostTable& table) : table_(table), way_(static_cast<std::size_t>(table.rows), -1) {
    try_row(0, static_cast<std::int64_t>(table.rows + table.columns) * table.alone / 2);
  }
  [[nodiscard]] const std::vector<int>& best() const { return best_; }

 private:
  void try_row(int row, std::int64_t cost) {
    if (row == table_.rows) {
      if (cost >= least_) return;
      least_ = cost;
      best_ = way_;
      return;
    }
    int& column = way_[static_cast<std::size_t>(row)];
    for (int j = 0; j < table_.columns; ++j) {
      const std::int64_t pair = table_.costs[static_cast<std::size_t>(row * table_.columns + j)];
      if (pair == kForbidden || std::count(way_.begin(), way_.begin() + row, j) > 0) continue;
      column = j;
      try_row(row + 1, cost + pair - table_.alone);
    }
    column = -1;
    try_row(row + 1, cost);
  }

  const CostTable& table_;
  std::vector<int> way_;
  std::vector<int> best_;
  std::int64_t least_ = std::numeric_limits<std::int64_t>::max();
};

CostTable random_table(Random& random, int rows, int columns, std::size_t costs,
                       std::size_t allowed_percent) {
  CostTable table{rows, columns, {}, 20};
  for (int i = 0; i < rows * columns; ++i) {
    table.costs.push_back(random.below(100) < allowed_percent ? static_cast<std::int64_t>(random.below(costs))
                                                              : kForbidden);
  }
  return table;
}

TEST(Assign, FindsTheBestAssignment) {
  Random random;
  for (int round = 0; round < 3000; ++round) {
    const int rows = static_cast<int>(random.below(6));
    const int columns = static_cast<int>(random.below(6));
    const CostTable table = random_table(random, rows, columns, 30, 20 + random.below(80));
    ASSERT_EQ(assign(table), AllWays(table).best()) << "round " << round;
  }
}

TEST(Assign, FindsTheFirstOfEquallyGoodAssignments) {
  Random random;
  for (int round = 0; round < 3000; ++round) {
    const CostTable table = random_table(random, 1 + static_cast<int>(random.below(5)),
                                         1 + static_cast<int>(random.below(5)), 3, 90);
    ASSERT_EQ(assign(table), AllWays(table).best()) << "round " << round;
  }
}

TEST(Assign, FindsTheBestAssignmentForSevenTracks) {
  Random random;
  for (int round = 0; round < 20; ++round) {
    const CostTable table = random_table(random, 7, 7, round % 2 == 0 ? 40 : 4, 80);
    ASSERT_EQ(assign(table), AllWays(table).best()) << "round " << round;
  }
}

TEST(Assign, LeavesTooExpensivePairsUnassigned) {
  EXPECT_EQ(assign({1, 1, {20}, 20}), std::vector{0});  // a tie prefers the pair
  EXPECT_EQ(assign({1, 1, {21}, 20}), std::vector{-1});
}

TEST(Assign, HasNothingToDoWithoutRowsOrColumns) {
  EXPECT_TRUE(assign({0, 3, {}, 20}).empty());
  EXPECT_EQ(assign({2, 0, {}, 20}), (std::vector{-1, -1}));
}

constexpr Covariance3 variances(double v) {
  return {v, 0, 0, 0, v, 0, 0, 0, v};
}

Track track_at(std::int64_t id, Point3 position_m) {
  Track track;
  track.id = TrackId{id};
  track.state = TrackState::confirmed;
  track.has_place = true;
  track.extent_m = {0.3F, 0.3F, 0.1F};
  track.look[0] = track.look[8] = 1;
  track.as_static = {position_m, variances(1e-4)};
  track.as_moving.position_m = position_m;
  for (std::size_t i = 0; i < 6; ++i) track.as_moving.covariance.at(i * 7) = i < 3 ? 1e-4 : 1;
  return track;
}

Detection sighting_at(std::int32_t object, Point3 position_m, float confidence = 0.9F) {
  Detection seen;
  seen.object = ObjectId{object};
  seen.has_place = true;
  seen.position_in_camera_m = position_m;
  seen.covariance_in_camera_m2 = variances(9e-4);
  seen.extent_m = {0.3F, 0.3F, 0.1F};
  seen.confidence = confidence;
  seen.pixel_count = 100;
  seen.box_px = {10 * object, 10, 10, 10};
  seen.look[0] = seen.look[8] = 1;
  return seen;
}

Overlaps no_overlaps(const Tracks& tracks, int objects) {
  Overlaps overlaps;
  const std::size_t count = tracks.list.size();
  for (const Track& track : tracks.list) overlaps.tracks.push_back(track.id);
  overlaps.in_view.assign(count, 1);
  overlaps.area.assign(count, 100);
  overlaps.predicted.assign(count, 100);
  overlaps.nearer.assign(count, 0);
  overlaps.objects = objects;
  overlaps.common.assign(count * static_cast<std::size_t>(objects), 0);
  return overlaps;
}
int& common(Overlaps& overlaps, std::size_t track, int object) {
  return overlaps
      .common[track * static_cast<std::size_t>(overlaps.objects) + static_cast<std::size_t>(object) - 1];
}

std::vector<std::pair<std::int64_t, std::int32_t>> pairs(const std::vector<Assignment>& matches) {
  std::vector<std::pair<std::int64_t, std::int32_t>> found;
  for (const Assignment& match : matches) found.emplace_back(number(match.track), number(match.object));
  return found;
}
using Pairs = std::vector<std::pair<std::int64_t, std::int32_t>>;

std::vector<Assignment> associated(const Tracks& tracks, const std::vector<Detection>& detections,
                                   const Overlaps& overlaps) {
  return associate(tracks, detections, overlaps, {Stamp{100'000'000}, {}}, {});
}

TEST(Associate, GivesEachTrackTheObjectAtItsPlace) {
  const Tracks tracks{{track_at(3, {0, 0, 2}), track_at(8, {1, 0, 2})}, 9, {}};
  const std::vector detections{sighting_at(1, {1.02, 0, 2}), sighting_at(2, {0.01, 0, 2}),
                               sighting_at(3, {0, 0, 3})};
  EXPECT_EQ(pairs(associated(tracks, detections, no_overlaps(tracks, 3))), (Pairs{{3, 2}, {8, 1}}));
}

TEST(Associate, NoTrackGetsAnObjectBeyondTheGate) {
  const Tracks tracks{{track_at(1, {0, 0, 2})}, 2, {}};
  // After a tenth of a second, the moving filter's gate reaches 3.4 of its standard deviations of 11 cm.
  EXPECT_TRUE(associated(tracks, {sighting_at(1, {0.5, 0, 2})}, no_overlaps(tracks, 1)).empty());
}

TEST(Associate, AnObjectThatMayBeAnywhereNeedsMoreThanItsPlace) {
  // A bollard has left the view; a car far behind, whose place is uncertain by 2.5 m, is seen for the first time.
  const Tracks tracks{{track_at(1, {0, 0, 2})}, 2, {}};
  Detection car = sighting_at(1, {0, 0, 6});
  car.covariance_in_camera_m2 = variances(6.25);
  car.look = {};
  car.look[0] = car.look[9] = 1;  // as light, of another colour
  Overlaps overlaps = no_overlaps(tracks, 1);
  EXPECT_TRUE(associated(tracks, {car}, overlaps).empty());
  common(overlaps, 0, 1) = 90;
  EXPECT_EQ(pairs(associated(tracks, {car}, overlaps)), (Pairs{{1, 1}})) << "but the same mask is enough";
}

TEST(Associate, AStableMaskKeepsItsTrackThoughItsCentroidJumps) {
  const Tracks tracks{{track_at(1, {0, 0, 2})}, 2, {}};
  Overlaps overlaps = no_overlaps(tracks, 1);
  common(overlaps, 0, 1) = 70;  // of 100 and 100: IoU 0.54
  EXPECT_EQ(pairs(associated(tracks, {sighting_at(1, {0.5, 0, 2})}, overlaps)), (Pairs{{1, 1}}));
}

TEST(Associate, ColoursDecideBetweenTracksAtTheSamePosition) {
  Tracks tracks{{track_at(1, {0, 0, 2}), track_at(2, {0, 0, 2})}, 3, {}};
  tracks.list[1].look = {};
  tracks.list[1].look[7] = tracks.list[1].look[70] = 1;
  Detection seen = sighting_at(1, {0, 0, 2});
  seen.look = tracks.list[1].look;
  EXPECT_EQ(pairs(associated(tracks, {seen}, no_overlaps(tracks, 1))), (Pairs{{2, 1}}));
}

TEST(Associate, TiesGoToTheLowerTrack) {
  const Tracks tracks{{track_at(1, {0, 0, 2}), track_at(2, {0, 0, 2})}, 3, {}};
  EXPECT_EQ(pairs(associated(tracks, {sighting_at(1, {0, 0, 2})}, no_overlaps(tracks, 1))), (Pairs{{1, 1}}));
}

TEST(Associate, ConfidentObjectsAreMatchedFirst) {
  const Tracks tracks{{track_at(1, {0, 0, 2})}, 2, {}};
  const std::vector detections{sighting_at(1, {0, 0, 2}, 0.2F), sighting_at(2, {0.03, 0, 2}, 0.9F)};
  EXPECT_EQ(pairs(associated(tracks, detections, no_overlaps(tracks, 2))), (Pairs{{1, 2}}));
}

TEST(Associate, AnUncertainObjectIsMatchedIfThereIsNoBetterOne) {
  const Tracks tracks{{track_at(1, {0, 0, 2})}, 2, {}};
  EXPECT_EQ(pairs(associated(tracks, {sighting_at(1, {0, 0, 2}, 0.2F)}, no_overlaps(tracks, 1))),
            (Pairs{{1, 1}}));
}

TEST(Associate, PiecesOfOneObjectShareItsTrack) {
  Tracks tracks{{track_at(1, {0, 0, 2})}, 2, {}};
  std::vector detections{sighting_at(1, {0, 0, 2}), sighting_at(2, {0.15, 0, 2})};
  for (Detection& seen : detections) seen.pixel_count = 40;
  Overlaps overlaps = no_overlaps(tracks, 2);
  common(overlaps, 0, 1) = 38;
  common(overlaps, 0, 2) = 35;
  EXPECT_EQ(pairs(associated(tracks, detections, overlaps)), (Pairs{{1, 1}, {1, 2}}));
  // A distant object is not a piece, nor is one that overlaps only with its edge …
  detections[1].box_px.x += 3;
  EXPECT_EQ(pairs(associated(tracks, detections, overlaps)), (Pairs{{1, 1}}));
  detections[1].box_px.x -= 3;
  common(overlaps, 0, 2) = 20;
  EXPECT_EQ(pairs(associated(tracks, detections, overlaps)), (Pairs{{1, 1}}));
  // … and an object that is in pieces for long is several objects.
  common(overlaps, 0, 2) = 35;
  tracks.list[0].in_parts = 5;
  EXPECT_EQ(pairs(associated(tracks, detections, overlaps)), (Pairs{{1, 1}}));
}

TEST(Associate, AnObjectThatCoversTwoTracksGoesToOneOfThem) {
  const Tracks tracks{{track_at(1, {0, 0, 2}), track_at(2, {0.8, 0, 2})}, 3, {}};
  Detection both = sighting_at(1, {0.4, 0, 2});
  both.pixel_count = 190;
  Overlaps overlaps = no_overlaps(tracks, 1);
  common(overlaps, 0, 1) = 90;
  common(overlaps, 1, 1) = 95;
  EXPECT_EQ(joined_objects(tracks, overlaps), std::vector{ObjectId{1}});
  EXPECT_EQ(pairs(associated(tracks, {both}, overlaps)), (Pairs{{2, 1}}));
}

TEST(Associate, WithoutPositionsMasksDecide) {
  Tracks tracks{{track_at(1, {}), track_at(2, {})}, 3, {}};
  for (Track& track : tracks.list) track.has_place = false;
  std::vector detections{sighting_at(1, {}), sighting_at(2, {})};
  for (Detection& seen : detections) seen.has_place = false;
  Overlaps overlaps = no_overlaps(tracks, 2);
  common(overlaps, 0, 2) = 60;
  EXPECT_EQ(pairs(associated(tracks, detections, overlaps)), (Pairs{{1, 2}}));
}

}  // namespace
}  // namespace cairn
