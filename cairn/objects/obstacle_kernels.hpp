// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/objects/floor_probability.hpp>
#include <cairn/objects/obstacles.hpp>
#include <cstdint>
#include <optional>
#include <vector>

/// The kernels of label_obstacles(), group_by_floor() and what places obstacles, per pixel of a row; one set per instruction set. Private to
/// the library.
namespace cairn::kernels {

/// The surfaces behind objects.
struct Backdrop {
  std::optional<GroundPlane> floor;
  std::vector<GroundPlane> walls;
  float infinity_px = 0;  // disparities above −infinity_px are before infinity
};

/// The disparities of a backdrop behind the pixels of a row, px.
struct BackdropRow {
  float* free_floor;  // NaN above the horizon, without a floor, and where a wall hides the floor
  float* wall;        // of the nearest wall, −∞ without walls
  float* barrier;     // what an obstacle must be in front of: the floor, else the walls, else infinity
};

/// The rows of label_obstacles().
struct SpaceRow {
  const ObjectId* object;
  const float* disparity;
  const float* surface;
  const float* confidence;
  const float* floor_probability;  // NaN: unknown
  const float* free_floor;
  const float* barrier;
};

/// The rows of mark_kinds().
struct KindRow {
  const ObjectId* object;
  const Reject* reject;
  const float* seen;
  const float* free_floor;
};

/// The rows of place().
struct PlacedRow {
  const ObstacleLabel* label;
  const ObjectId* object;
  const float* matched;
  const float* refined;
  const float* refined_confidence;
};

/// What a disparity is and how sure it is; surface: see ObstacleCues.
struct SeenPixels {
  const float* disparity;
  const float* surface;
  const float* confidence;
};
struct SeenPixelsOut {
  float* disparity;
  float* surface;
  float* confidence;
};

/// Disparities relative to the floor's plane, in whole numbers; 0 for a hole.
struct HeightsOut {
  static constexpr float kLowest = -8, kHighest = 16;  // px from the floor; beyond, all disparities are alike
  static constexpr int kSteps = 64;                    // of a px
  static constexpr int kSureSteps = 256;               // of a confidence of 1
  static constexpr std::int32_t kSure = 0x3ff, kOn = 1 << 10, kFront = 1 << 11, kKnown = 1 << 12;
  std::int32_t* height;  // from kLowest
  std::int32_t* marks;   // the confidence in kSure; within the margin of the floor, nearer, no hole
};

/// Plain loops that compilers vectorise, as in PointKernels.
struct ObstacleKernels {
  /// Of row y.
  void (*in_steps_from_floor)(const float* disparity_px, const float* confidence, int y,
                              const GroundPlane& floor, float margin, int width, const HeightsOut& out);
  /// The matches of a row, or the refined disparities in their place where their confidence is at least `least`.
  void (*prefer_refined)(const SeenPixels& matched, const float* refined, const float* refined_confidence,
                         float least, int width, const SeenPixelsOut& out);
  /// For the pixels of row y.
  void (*look_behind)(const Backdrop& backdrop, int y, int width, const BackdropRow& out);
  /// As label_obstacles() defines it.
  void (*label)(const SpaceRow& row, float margin, int width, ObstacleLabel* out);
  /// As obstacle_disparities() defines it, for row y above the floor's plane.
  void (*place)(const PlacedRow& row, const GroundPlane& floor, int y, int width, float* out);
  /// The kind of each pixel, as group_by_floor() defines it.
  void (*mark_kinds)(const KindRow& row, float margin, int width, FloorKind* out);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const ObstacleKernels* obstacle_kernels(Target target);
/// The functions for the active target of `exec`.
const ObstacleKernels& obstacle_kernels(const Exec& exec);

}  // namespace cairn::kernels
