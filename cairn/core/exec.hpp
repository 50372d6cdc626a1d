// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cairn/core/pool.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <typeinfo>

namespace cairn {

/// The result of a stage, as passed to an observer: borrowed, valid during the call only.
class StageResult {
 public:
  template <class T>
  explicit StageResult(const T& value) : type_(typeid(T)), value_(&value) {}
  /// nullptr if the stage returns another type.
  template <class T>
  [[nodiscard]] const T* as() const {
    return type_ == typeid(T) ? static_cast<const T*>(value_) : nullptr;
  }

 private:
  const std::type_info& type_;
  const void* value_;
};

/// Called after each stage on the calling thread: name of the stage (its function's), result, time.
using Observer = std::function<void(std::string_view stage, const StageResult& result, double milliseconds)>;

/// The instruction set of the kernels. Never changes a result bit.
enum class Target : std::uint8_t { best, scalar, sse4, avx2, avx512, neon };

class Workers;      // persistent threads; parallel.cpp
class MatchDevice;  // a graphics processor; stereo/match_device.hpp

/// How a frame is computed: threads, instruction set, memory of the images, observer, device. Never changes a result
/// (tested). Exec{} is one thread, the best target, images from the heap, no observer, no device.
struct Exec {
  Target target = Target::best;
  Pool pool;
  Observer observe;
  std::shared_ptr<Workers> workers;     // null = only the calling thread
  std::shared_ptr<MatchDevice> device;  // null = the processor matches

  /// `threads` ≥ 1 persistent threads, including the calling one; 0 = one per processor.
  static Exec with_threads(int threads, Target target = Target::best);
  [[nodiscard]] int threads() const;
  /// Whether part of the next frame can be computed beside this one: prefetch() has an effect.
  [[nodiscard]] bool overlaps_frames() const { return threads() > 1 || device != nullptr; }
  /// The Exec of a Later: without an observer and, if the work is concurrent, with a pool of its own.
  [[nodiscard]] Exec beside() const;
};

}  // namespace cairn
