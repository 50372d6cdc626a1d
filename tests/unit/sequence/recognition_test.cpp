// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/sequence/landmarks.hpp>
#include <cmath>
#include <numbers>
#include <random>

namespace cairn {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

Landmark known(std::int64_t id, Point3 at, std::size_t bin) {
  Landmark l;
  l.id = LandmarkId{id};
  l.position_m = at;
  l.covariance_m2 = {0.0025, 0, 0, 0, 0.0025, 0, 0, 0, 0.0025};
  l.size = {0.4, 0.4, 0.5};
  l.height_over_floor_m = 0.25;
  LandmarkLook look;
  look.colours[bin % 8] = 1;
  look.colours[8 + bin] = 1;
  l.looks.push_back(look);
  return l;
}

Candidate seen(std::int64_t id, Point3 at, std::size_t bin) {
  const Landmark l = known(id, at, bin);
  return {TrackId{id}, at, l.covariance_m2, l.size, l.height_over_floor_m, l.looks[0].colours};
}

TEST(Recognition, IsVetoedByPositionSizeAndHeightAndDecidedByColours) {
  LandmarkMap map;
  map.list = {known(1, {1, 0, 0.25}, 5)};
  const LandmarksConfig config;
  const MapLocation here{};
  const auto is_known = [&](const Candidate& candidate) {
    return recognise(map, {candidate}, here, {}, config).pairs.size() == 1;
  };
  const Candidate same = seen(7, {1.1, 0, 0.25}, 5);
  EXPECT_TRUE(is_known(same));
  EXPECT_FALSE(is_known(seen(7, {1.5, 0, 0.25}, 5)));
  EXPECT_FALSE(is_known(seen(7, {1.1, 0, 0.25}, 6)));
  Candidate tall = same;
  tall.size.height_m = 0.9;
  EXPECT_FALSE(is_known(tall));
  Candidate wide = same;
  wide.size = {0.7, 0.8, 0.5};
  EXPECT_FALSE(is_known(wide));
  Candidate high = same;
  high.height_over_floor_m = 0.5;
  EXPECT_FALSE(is_known(high));
  EXPECT_TRUE(recognise(map, {same}, here, {LandmarkId{1}}, config).pairs.empty());
  // With an uncertain pose, a more distant object may be the same.
  MapLocation unsure = here;
  for (const std::size_t i : {0U, 5U, 10U}) unsure.covariance[i] = 0.04;
  EXPECT_EQ(recognise(map, {seen(7, {1.5, 0, 0.25}, 5)}, unsure, {}, config).pairs.size(), 1U);
}

TEST(Recognition, PairsEachObjectOnce) {
  LandmarkMap map;
  map.list = {known(1, {1, 0, 0.25}, 5), known(2, {1.2, 0, 0.25}, 5)};
  const auto found = recognise(map, {seen(7, {0.98, 0, 0.25}, 5), seen(8, {1.22, 0, 0.25}, 5)}, {}, {}, {});
  ASSERT_EQ(found.pairs.size(), 2U);
  EXPECT_EQ(found.pairs[0].landmark, LandmarkId{1});
  EXPECT_EQ(found.pairs[1].landmark, LandmarkId{2});
}

TEST(Relocation, FindsThePoseOfAConstellation) {
  LandmarkMap map;
  map.list = {known(1, {0, 0, 0.25}, 1), known(2, {2, 0, 0.25}, 2), known(3, {0, 3, 0.25}, 3),
              known(4, {4, 4, 0.25}, 4)};
  Pose map_from_odom = rotation_about({0, 0, 1.2});
  map_from_odom.translation_m = {3, -2, 0.1};
  std::vector<Candidate> candidates;
  for (std::int64_t i = 0; i < 3; ++i) {
    candidates.push_back(seen(10 + i,
                              inverse(map_from_odom)(map.list[static_cast<std::size_t>(i)].position_m),
                              static_cast<std::size_t>(i) + 1));
  }
  const Recognition found = relocate(map, candidates, {});
  ASSERT_TRUE(found.map_from_odom.has_value());
  EXPECT_EQ(found.pairs.size(), 3U);
  EXPECT_LT(angle_of(inverse(*found.map_from_odom) * map_from_odom), 1e-6);
  EXPECT_LT(length(found.map_from_odom->translation_m - map_from_odom.translation_m), 1e-6);
  // Two are too few, and a mirrored room is another one.
  candidates.pop_back();
  EXPECT_EQ(relocate(map, candidates, {}).refusal, RecognitionRefusal::no_candidates);
  candidates.push_back(seen(12, inverse(map_from_odom)({0, -3, 0.25}), 3));
  EXPECT_EQ(relocate(map, candidates, {}).refusal, RecognitionRefusal::too_few_pairs);
}

TEST(Relocation, NeedsTwoPairsGivenAGuess) {
  LandmarkMap map;
  map.list = {known(1, {1, 0, 0.25}, 1), known(2, {2.5, 1, 0.25}, 2)};
  Pose truth = rotation_about({0, 0, 0.3});
  truth.translation_m = {0.4, -0.3, 0};
  const std::vector<Candidate> candidates{seen(11, inverse(truth)({1, 0, 0.25}), 1),
                                          seen(12, inverse(truth)({2.5, 1, 0.25}), 2)};
  EXPECT_EQ(relocate(map, candidates, {}).refusal, RecognitionRefusal::no_candidates);

  MapLocation guess;
  for (const std::size_t i : {0U, 5U, 10U}) guess.covariance[i] = 1;
  guess.covariance[15] = 0.27;
  const Recognition found = relocate(map, candidates, {}, guess);
  ASSERT_TRUE(found.map_from_odom.has_value());
  EXPECT_LT(length(found.map_from_odom->translation_m - truth.translation_m), 0.05);
  EXPECT_EQ(found.pairs.size(), 2U);

  guess.map_from_odom.translation_m = {8, 0, 0};
  EXPECT_EQ(relocate(map, candidates, {}, guess).refusal, RecognitionRefusal::too_few_pairs)
      << "not near there";
}

TEST(Relocation, IsAmbiguousInARepetitiveRoom) {
  LandmarkMap map;
  std::vector<Candidate> candidates;
  for (std::int64_t i = 0; i < 4; ++i) {
    const double angle = kTurn * static_cast<double>(i) / 4;
    map.list.push_back(known(i + 1, {2 * std::cos(angle), 2 * std::sin(angle), 0.25}, 9));
    candidates.push_back(seen(i + 11, {2 * std::cos(angle), 2 * std::sin(angle), 0.25}, 9));
  }
  const Recognition found = relocate(map, candidates, {});
  EXPECT_FALSE(found.map_from_odom.has_value());
  EXPECT_EQ(found.refusal, RecognitionRefusal::ambiguous);
}

/// A map of objects in nine colours, the first of them at the places and of the colours of `shared`.
LandmarkMap room_of(std::size_t objects, const std::vector<Landmark>& shared, const Pose& map_from_room,
                    std::mt19937& random) {
  std::uniform_real_distribution<> along(0, std::sqrt(2.5 * static_cast<double>(objects)));
  std::normal_distribution<> noise(0, 0.05);
  LandmarkMap map;
  for (std::size_t i = 0; i < objects; ++i) {
    Landmark l =
        i < shared.size() ? shared[i] : known(0, {along(random), along(random), 0.25}, random() % 9 * 5);
    if (i >= shared.size()) l.size.height_m = 2 * (l.height_over_floor_m = along(random) / 10 + 0.1);
    l.position_m.z = l.height_over_floor_m;
    l.id = LandmarkId{map.next++};
    l.position_m = map_from_room(l.position_m) + Point3{noise(random), noise(random), 0};
    map.list.push_back(l);
  }
  return map;
}

TEST(Maps, OfPlacesWithNothingInCommonAreNotJoined) {
  std::mt19937 random(1);
  for (int k = 0; k < 20; ++k) {
    const LandmarkMap a = room_of(50, {}, {}, random);
    const LandmarkMap b = room_of(50, {}, {}, random);
    EXPECT_FALSE(merge(a, b, std::nullopt, {}).map_from_other.has_value()) << k;
  }
}

TEST(Maps, OfOnePlaceAreJoinedByTenObjectsOfFifty) {
  std::mt19937 random(1);
  Pose b_from_room = rotation_about({0, 0, 2});
  b_from_room.translation_m = {5, 1, 0};
  for (int k = 0; k < 20; ++k) {
    const LandmarkMap a = room_of(50, {}, {}, random);
    const LandmarkMap b = room_of(50, {a.list.begin(), a.list.begin() + 10}, b_from_room, random);
    const MapMerge merged = merge(a, b, std::nullopt, {});
    ASSERT_TRUE(merged.map_from_other.has_value()) << k;
    EXPECT_LT(length((*merged.map_from_other * b_from_room)({4, 4, 0}) - Point3{4, 4, 0}), 0.3) << k;
    EXPECT_GE(merged.pairs.size(), 6U);
  }
}

TEST(Maps, AreJoinedByFewerObjectsWhereTheOthersStandOnNoFreeFloor) {
  std::mt19937 random(1);
  const auto with_floor = [](LandmarkMap map) {
    for (int x = -4; x < 50; ++x) {
      for (int y = -4; y < 50; ++y) {
        const bool is_taken = std::any_of(map.list.begin(), map.list.end(), [&](const Landmark& l) {
          return std::hypot(l.position_m.x - kFloorCell_m * (x + 0.5),
                            l.position_m.y - kFloorCell_m * (y + 0.5)) < 0.4;
        });
        if (!is_taken) map.floor.push_back({x, y, 20});
      }
    }
    return map;
  };
  int with = 0;
  int without = 0;
  int all_free_joined = 0;
  for (int k = 0; k < 20; ++k) {
    const LandmarkMap a = room_of(50, {}, {}, random);
    // The others of b are those of a in other colours: not recognised, but not on free floor either.
    LandmarkMap b = room_of(50, a.list, {}, random);
    for (std::size_t i = 4; i < b.list.size(); ++i) {
      std::size_t bin = 0;
      while (b.list[i].looks[0].colours[8 + bin] == 0) bin += 5;
      b.list[i].looks[0].colours = known(0, {}, (bin + 5 * (1 + random() % 8)) % 45).looks[0].colours;
    }
    const auto is_right = [](const MapMerge& merged) {
      return merged.map_from_other && length((*merged.map_from_other)({4, 4, 0}) - Point3{4, 4, 0}) < 0.3;
    };
    without += is_right(merge(a, b, std::nullopt, {})) ? 1 : 0;
    with += is_right(merge(with_floor(a), with_floor(b), std::nullopt, {})) ? 1 : 0;
    // Objects on what is free in the other map speak against the place.
    LandmarkMap all_free = with_floor({});
    all_free.list = a.list;
    all_free_joined += merge(all_free, b, std::nullopt, {}).map_from_other ? 1 : 0;
  }
  EXPECT_GT(with, 15);
  EXPECT_LT(without, with);
  EXPECT_LE(all_free_joined, without);
}

TEST(Maps, SeveralAreJoinedByWayOfEachOther) {
  std::mt19937 random(1);
  const LandmarkMap b = room_of(20, {}, {}, random);
  const LandmarkMap a = room_of(20, {b.list.begin(), b.list.begin() + 8}, {}, random);
  const LandmarkMap c = room_of(15, {b.list.begin() + 10, b.list.begin() + 18}, {}, random);
  EXPECT_FALSE(merge(a, c, std::nullopt, {}).map_from_other.has_value());
  const MapsMerge merged = merge_all(a, {{c, false, {}}, {b, false, {}}}, {});
  ASSERT_EQ(merged.placed.size(), 2U);
  for (const PlacedMap& placed : merged.placed) {
    ASSERT_TRUE(placed.map_from_other.has_value());
    EXPECT_LT(length((*placed.map_from_other)({3, 3, 0}) - Point3{3, 3, 0}), 0.3);
  }
  EXPECT_EQ(merged.map.list.size(), 20U + 12U + 7U);
}

TEST(Relocation, NeedsMoreThanChanceGivesUnlessThePlaceWasGuessed) {
  std::mt19937 random(2);
  const LandmarkMap map = room_of(60, {}, {}, random);
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < 12; ++i) {
    // Three objects of the map, and nine others.
    const Landmark l = i < 3 ? map.list[i] : room_of(1, {}, {}, random).list[0];
    candidates.push_back({TrackId{static_cast<std::int64_t>(i)}, l.position_m, l.covariance_m2, l.size,
                          l.height_over_floor_m, l.looks[0].colours});
  }
  EXPECT_FALSE(relocate(map, candidates, {}).map_from_odom.has_value());
  MapLocation guess;
  for (const std::size_t i : {0U, 5U, 10U}) guess.covariance[i] = 0.04;
  guess.covariance[15] = 0.01;
  EXPECT_TRUE(relocate(map, candidates, {}, guess).map_from_odom.has_value());
}

TEST(Maps, TurnedFloorHasNoHoles) {
  LandmarkMap a;
  LandmarkMap b;
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 20; ++y) b.floor.push_back({x, y, 7});
  }
  const MapMerge merged = merge(a, b, rotation_about({0, 0, 0.7}), {});
  std::size_t inside = 0;
  for (const FloorCell& cell : merged.map.floor) {
    EXPECT_EQ(cell.frames, 7);
    ++inside;
  }
  EXPECT_NEAR(static_cast<double>(inside), 400, 25);
}

TEST(Maps, FloorThatCopiesShareDoesNotCountTwice) {
  LandmarkMap a;
  a.floor = {{0, 0, 3}, {0, 1, 9}};
  LandmarkMap copy;
  copy.floor = {{0, 0, 5}, {0, 1, 4}, {2, 2, 1}};
  EXPECT_EQ(merge_copies(a, copy, {}).map.floor, (std::vector<FloorCell>{{0, 0, 5}, {0, 1, 9}, {2, 2, 1}}));
}

TEST(Maps, TheFloorOfBothIsKnownAfterwards) {
  LandmarkMap a;
  a.floor = {{0, 0, 3}, {0, 1, 4}};
  LandmarkMap b;
  b.floor = {{-4, 1, 5}, {0, 0, 6}};
  Pose a_from_b;
  a_from_b.translation_m = {1, 0, 0};
  const MapMerge merged = merge(a, b, a_from_b, {});
  EXPECT_EQ(merged.map.floor, (std::vector<FloorCell>{{0, 0, 3}, {0, 1, 9}, {4, 0, 6}}));
}

TEST(Maps, CopiesAreMergedWithoutDoubleCounting) {
  LandmarkMap room;
  const std::array places{Point3{0, 0, 0.25}, Point3{2, 0, 0.25}, Point3{0, 3, 0.25}, Point3{3, 3, 0.25}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    Landmark l = known(room.next++, places[i], 5 * i);
    l.run = 1;
    l.seen = l.expected = 20;
    l.log_odds = 2;
    room.list.push_back(l);
  }
  LandmarkMap copy = room;
  room.list[0].last = {9'000'000'000};
  room.list[0].seen = 30;
  copy.list[1].run = 2;
  copy.list[1].position_m.x += 1;
  copy.list[1].seen = 25;
  copy.list[1].name = "box";
  copy.list[2].is_gone = true;  // expected, and not seen
  copy.list[2].expected = 40;
  // Each copy has assigned this id to a new object since.
  room.list.push_back(known(room.next++, {6, -3, 0.25}, 30));
  copy.list.push_back(known(copy.next++, {-6, -3, 0.25}, 40));
  const auto check = [](const MapMerge& merged) {
    const std::vector<Landmark>& list = merged.map.list;
    ASSERT_EQ(list.size(), 6U);
    EXPECT_EQ(merged.pairs.size(), 4U);
    EXPECT_EQ(list[0].seen, 30);
    EXPECT_EQ(list[1].seen, 25);
    EXPECT_EQ(list[1].name, "box");
    EXPECT_EQ(list[1].position_m, (Point3{3, 0, 0.25}));
    EXPECT_TRUE(list[2].is_gone);
    EXPECT_EQ(list[3].seen, 20);
    EXPECT_EQ(list[3].log_odds, 2);
    EXPECT_EQ(list[3].covariance_m2[0], 0.0025);
    EXPECT_NE(list[4].id, list[5].id);
  };
  check(merge_copies(room, copy, {}));
  check(merge_copies(copy, room, {}));
  const MapMerge same = merge_copies(room, room, {});
  EXPECT_EQ(same.map.list.size(), room.list.size());
  EXPECT_EQ(same.map.list[3].seen, 20);
}

TEST(Maps, ALandmarkThatIsInTheOtherMapIsNotGone) {
  LandmarkMap ours;
  LandmarkMap theirs;
  const std::array places{Point3{0, 0, 0.25}, Point3{2, 0, 0.25}, Point3{0, 3, 0.25}, Point3{3, 3, 0.25}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (LandmarkMap* map : {&ours, &theirs}) map->list.push_back(known(map->next++, places[i], 5 * i));
    ours.list[i].log_odds = theirs.list[i].log_odds = 3;
    ours.list[i].first = {7};
    theirs.list[i].first = {3};
  }
  ours.list[1].is_gone = true;
  ours.list[1].log_odds = -2.5;
  theirs.list[1].size.height_m = ours.list[1].size.height_m + 0.1;
  theirs.list[1].looks[0].octant = 3;
  theirs.list[1].looks[0].pixels = 900;
  const MapMerge merged = merge(ours, theirs, Pose{}, {});
  ASSERT_EQ(merged.map.list.size(), 4U);
  const Landmark& both = merged.map.list[1];
  EXPECT_FALSE(both.is_gone);
  EXPECT_EQ(both.size.height_m, theirs.list[1].size.height_m);
  ASSERT_EQ(both.looks.size(), 2U);
  EXPECT_EQ(both.looks[1].octant, 3);
  EXPECT_EQ(both.looks[1].pixels, 900);
  EXPECT_EQ(both.first.ns, 7) << "stamps of different runs are not comparable";
}

TEST(Changes, AreTheLastChangeOfEachLandmark) {
  const auto event = [](LandmarkEventKind kind, std::int64_t id, double by = 0) {
    LandmarkEvent e;
    e.kind = kind;
    e.landmark = LandmarkId{id};
    e.moved_by_m.x = by;
    return e;
  };
  using enum LandmarkEventKind;
  const auto changes = changes_of({event(relocated, 0), event(gone, 1), event(gone, 2), event(moved, 2, 1),
                                   event(back, 1), event(found, 3), event(gone, 4), event(moved, 2, 0.5)});
  ASSERT_EQ(changes.size(), 3U);
  EXPECT_EQ(changes[0].landmark, LandmarkId{2});
  EXPECT_EQ(changes[0].kind, moved);
  EXPECT_EQ(changes[0].moved_by_m.x, 1.5);
  EXPECT_EQ(changes[1].kind, found);
  EXPECT_EQ(changes[2].landmark, LandmarkId{4});

  const auto returned = changes_of({event(moved, 2, 1), event(gone, 2), event(back, 2), event(found, 3),
                                    event(gone, 3), event(back, 3), event(found, 4), event(gone, 4)});
  ASSERT_EQ(returned.size(), 2U);
  EXPECT_EQ(returned[0].kind, moved) << "what moved before it left is still elsewhere";
  EXPECT_EQ(returned[0].moved_by_m.x, 1);
  EXPECT_EQ(returned[1].landmark, LandmarkId{3});
  EXPECT_EQ(returned[1].kind, found);
}

}  // namespace
}  // namespace cairn
