// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/stereo/match_device.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace cairn::device {

/// Thrown by an engine: it cannot do this, but may do other things.
struct Unfit : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// Thrown by an engine: it has failed, and must not be used any more.
struct Lost : std::runtime_error {
  explicit Lost(const std::string& says, bool busy = false) : std::runtime_error(says), is_busy(busy) {}
  bool is_busy;  // it may still be at work, so it must not be destroyed either
};

/// Does the work of a MatchDevice, one pair at a time.
class Engine {
 public:
  Engine() = default;
  virtual ~Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  [[nodiscard]] virtual std::string name() const = 0;
  /// With the version of its driver, for reports of faults.
  [[nodiscard]] virtual std::string full_name() const = 0;
  /// Names the kernels that pairs of so many disparities run: each is compared with the processor before it is trusted.
  /// Throws Unfit.
  [[nodiscard]] virtual std::string variant(int num_disparities) const = 0;
  /// Begins a pair, which it copies. The one before must be finished. Throws Unfit or Lost.
  virtual void submit(const StereoPair& pair, const MatchConfig& config,
                      const SemiGlobalConfig& penalties) = 0;
  /// Waits for the pair. Throws Lost, and std::bad_alloc before it waits.
  virtual Matches finish(const Exec& exec) = 0;
  /// Of the last pair that was finished.
  [[nodiscard]] virtual std::vector<DeviceKernel> work() const = 0;
  [[nodiscard]] virtual std::int64_t memory_bytes() const = 0;
};

}  // namespace cairn::device
