// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cairn/core/pool.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <variant>
#include <vector>

namespace cairn {

enum class Reject : std::uint16_t;  // defined in disparity/reject.hpp; the rest beside its stage
struct Matches;
struct DisparityMap;
struct Ground;
struct Background;
struct Superpixels;
struct MergeTree;
struct ChosenObjects;
struct Segmentation;
struct Fusion;
struct Objects;
struct LeftOut;
enum class Space : std::uint8_t;  // defined in objects/space.hpp

/// What a stage made, as an observer sees it: borrowed, valid during the call only.
using Artifact =
    std::variant<const Matches*, const float*, const Image<float>*, const Image<Reject>*, const DisparityMap*,
                 const Ground*, const Image<std::uint8_t>*, const Background*, const Superpixels*,
                 const MergeTree*, const ChosenObjects*, const Segmentation*, const Fusion*, const Objects*,
                 const Image<Space>*, const std::vector<LeftOut>*>;

/// Called after each stage on the calling thread: the stage's name (as the function's), its result, its time.
using Observer = std::function<void(std::string_view stage, const Artifact& artifact, double milliseconds)>;

/// Which instruction set the kernels use. Never changes a result bit.
enum class Target : std::uint8_t { best, scalar, sse4, avx2, avx512, neon };

class Workers;  // persistent threads; parallel.cpp

/// How the work is done: threads, instruction set, where images live, who watches. Never what comes out
/// (tested law). Exec{} is one thread, the best target, images from the heap, nobody watching.
struct Exec {
  Target target = Target::best;
  Pool pool;
  Observer observe;
  std::shared_ptr<Workers> workers;  // none = the calling thread alone

  /// `threads` ≥ 1 persistent threads, the calling one counted; 0 = one for each processor.
  static Exec with_threads(int threads, Target target = Target::best);
  [[nodiscard]] int threads() const;
  /// For a Later: unobserved, and where it is done at the same time, with a pool of its own.
  [[nodiscard]] Exec beside() const;
};

}  // namespace cairn
