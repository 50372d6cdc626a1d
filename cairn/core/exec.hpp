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

enum class Reject : std::uint16_t;  // defined in stereo/reject.hpp; the rest next to its stage
struct Matches;
struct DisparityMap;
struct Ground;
struct Background;
struct Superpixels;
struct ObjectHint;
struct MergeTree;
struct ChosenObjects;
struct Segmentation;
struct Fusion;
struct Objects;
struct LeftOut;
enum class Space : std::uint8_t;  // defined in objects/space.hpp

/// The result of a stage, as passed to an observer: borrowed, valid during the call only.
using Artifact =
    std::variant<const Matches*, const float*, const Image<float>*, const Image<Reject>*, const DisparityMap*,
                 const Ground*, const Image<std::uint8_t>*, const Image<std::uint16_t>*, const Background*,
                 const Superpixels*, const Image<ObjectHint>*, const MergeTree*, const ChosenObjects*,
                 const Segmentation*, const Fusion*, const Objects*, const Image<Space>*,
                 const std::vector<LeftOut>*>;

/// Called after each stage on the calling thread: name of the stage (its function's), result, time.
using Observer = std::function<void(std::string_view stage, const Artifact& artifact, double milliseconds)>;

/// The instruction set of the kernels. Never changes a result bit.
enum class Target : std::uint8_t { best, scalar, sse4, avx2, avx512, neon };

class Workers;  // persistent threads; parallel.cpp

/// How a frame is computed: threads, instruction set, memory of the images, observer. Never changes a result
/// (tested). Exec{} is one thread, the best target, images from the heap, no observer.
struct Exec {
  Target target = Target::best;
  Pool pool;
  Observer observe;
  std::shared_ptr<Workers> workers;  // null = only the calling thread

  /// `threads` ≥ 1 persistent threads, including the calling one; 0 = one per processor.
  static Exec with_threads(int threads, Target target = Target::best);
  [[nodiscard]] int threads() const;
  /// The Exec of a Later: without an observer and, if the work is concurrent, with a pool of its own.
  [[nodiscard]] Exec beside() const;
};

}  // namespace cairn
