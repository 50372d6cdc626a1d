// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "lab/worlds/families.hpp"
#include "lab/worlds/looks.hpp"
#include "lab/worlds/models.hpp"
#include "lab/worlds/shapes.hpp"

namespace cairn::worlds {
namespace {

bool equal(const Mesh& a, const Mesh& b) {
  const auto same_point = [](Vec3 p, Vec3 q) { return p.x == q.x && p.y == q.y && p.z == q.z; };
  const auto same_uv = [](Vec2 p, Vec2 q) { return p.x == q.x && p.y == q.y; };
  return std::ranges::equal(a.points, b.points, same_point) && std::ranges::equal(a.uv, b.uv, same_uv) &&
         a.triangles == b.triangles && a.part == b.part;
}

/// Volume that the triangles enclose: negative if they face inward.
double volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += double{dot(mesh.points[a], cross(mesh.points[b], mesh.points[c]))} / 6;
  }
  return sum;
}

void check(const Mesh& mesh, const Family& family) {
  ASSERT_EQ(mesh.uv.size(), mesh.points.size());
  ASSERT_EQ(mesh.part.size(), mesh.triangles.size());
  EXPECT_GE(mesh.triangles.size(), 12U);
  EXPECT_LE(mesh.triangles.size(), 60'000U);
  const auto finite = [](float x) { return std::isfinite(x); };
  EXPECT_TRUE(
      std::ranges::all_of(mesh.points, [&](Vec3 p) { return finite(p.x) && finite(p.y) && finite(p.z); }));
  EXPECT_TRUE(std::ranges::all_of(mesh.uv, [&](Vec2 p) { return finite(p.x) && finite(p.y); }));
  EXPECT_TRUE(std::ranges::all_of(mesh.part, [](int part) { return part <= 3; }));
  for (const auto& triangle : mesh.triangles) ASSERT_LT(std::ranges::max(triangle), mesh.points.size());
  const auto [low, high] = bounds(mesh);
  const Vec3 size = high - low;
  const float longest = std::max({size.x, size.y, size.z}), close = 1e-5F * longest;
  EXPECT_GE(longest, family.least_m);
  EXPECT_LE(longest, family.most_m);
  EXPECT_NEAR(low.z, 0, close);
  EXPECT_NEAR(low.x + high.x, 0, close);
  EXPECT_NEAR(low.y + high.y, 0, close);
  EXPECT_GT(volume(mesh), 0);
}

TEST(WorldsFamilies, AreEnoughAndHaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for (const Family& family : families()) names.insert(family.name);
  EXPECT_EQ(names.size(), families().size());
  const auto count = [](Use use) { return std::ranges::count(families(), use, &Family::use); };
  EXPECT_GE(count(Use::fit), 60);
  EXPECT_GE(count(Use::yardstick), 16);
}

TEST(WorldsFamilies, MakeMeshesThatKeepTheirPromises) {
  for (const Family& family : families()) {
    Mesh before;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      SCOPED_TRACE(std::string(family.name) + ", seed " + std::to_string(seed));
      Dice dice(seed), again(seed);
      const Mesh mesh = family.make(dice);
      check(mesh, family);
      if (HasFatalFailure()) return;
      EXPECT_TRUE(equal(mesh, family.make(again)));
      EXPECT_FALSE(equal(mesh, before));
      before = mesh;
    }
  }
}

TEST(WorldsShapes, PatternsKeepTheirSizeOnSurfaces) {
  // A point's uv distance along an edge is the edge's length, where the surface is not curved.
  for (const Mesh& mesh : {box({1, 2, 3}), cylinder(0.5F, 2, 64), slab({1, 2, 0.1F}, 3, 4)}) {
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec2 step{mesh.uv[b].x - mesh.uv[a].x, mesh.uv[b].y - mesh.uv[a].y};
      if (std::abs(mesh.points[a].z - mesh.points[b].z) < 0.1F) continue;  // the caps of a cylinder
      EXPECT_NEAR(std::hypot(step.x, step.y), length(mesh.points[b] - mesh.points[a]), 0.02);
    }
  }
}

TEST(WorldsShapes, HaveTheirVolumes) {
  EXPECT_NEAR(volume(box({1, 2, 3})), 6, 1e-4);
  EXPECT_NEAR(volume(slab({1, 2, 3}, 2, 3, 4)), 6, 1e-4);
  EXPECT_NEAR(volume(cylinder(1, 2, 90)), 2 * kPi, 0.02);
  EXPECT_NEAR(volume(ball({1, 2, 3}, 60)), 8 * kPi, 0.1);
  EXPECT_NEAR(volume(torus(2, 0.5F, 90, 60)), 2 * kPi * kPi * 2 * 0.25, 0.05);
  EXPECT_NEAR(volume(extrusion({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}}, 2)), 8, 1e-4);
  EXPECT_NEAR(volume(tube(arc({}, kX, kZ, 0, 2 * kPi * 89 / 90, 89), 0.1F, true, 30)), 2 * kPi * kPi * 0.01,
              0.01);
}

TEST(WorldsLooks, ReturnValuesInRangeAndTheSameOnes) {
  const auto in_range = [](float x) { return x >= 0 && x <= 1; };
  for (const auto make : {random_look, floor_look, wall_look, ground_look}) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      Dice dice(seed), again(seed), points(seed);
      const Look look = make(dice), same = make(again);
      for (int i = 0; i < 100; ++i) {
        const Vec2 uv{draw(points, -3, 3), draw(points, -3, 3)};
        const Vec3 point{draw(points, -3, 3), draw(points, -3, 3), draw(points, -3, 3)};
        const Surface a = surface_at(look, uv, point), b = surface_at(same, uv, point);
        EXPECT_TRUE(in_range(a.albedo.x) && in_range(a.albedo.y) && in_range(a.albedo.z));
        EXPECT_TRUE(in_range(a.gloss) && in_range(a.roughness));
        EXPECT_TRUE(a.albedo.x == b.albedo.x && a.albedo.y == b.albedo.y && a.albedo.z == b.albedo.z);
      }
    }
  }
}

TEST(WorldsLooks, ShowRandomPartsOfPhotographs) {
  if (!has_photographs()) GTEST_SKIP() << "lomiri-wallpapers-16.04 is not installed";
  std::vector<TextureImage> drawn;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Dice dice(seed);
    drawn.push_back(photograph(dice));
    ASSERT_EQ(drawn.back()->size(), std::size_t{kImageSide} * kImageSide);
  }
  // What was drawn before makes no difference.
  for (std::uint64_t seed = 30; seed-- > 0;) {
    Dice dice(seed);
    EXPECT_EQ(*photograph(dice), *drawn[seed]);
    EXPECT_NE(*drawn[seed], *drawn[(seed + 1) % 30]);
  }
}

}  // namespace
}  // namespace cairn::worlds
