// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/stereo/match.hpp>
#include <cairn/stereo/semi_global.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace cairn {

/// The work of one of a device's kernels.
struct DeviceKernel {
  std::string name;
  double ms = 0;           // 0: the device has no clock
  std::int64_t bytes = 0;  // read and written, as if nothing were cached
  std::int64_t dispatches = 0;
  friend bool operator==(const DeviceKernel&, const DeviceKernel&) = default;
};

/// What a device has done so far.
struct DeviceReport {
  std::string wanted;                 // as the user asked for it: a name, a number, auto
  std::string name;                   // empty until it is open
  std::int64_t on_device = 0;         // pairs
  std::int64_t on_processor = 0;      // pairs that the device left to the processor
  std::vector<DeviceKernel> kernels;  // of all these pairs together
  std::int64_t memory_bytes = 0;      // of the device
  std::string reason;                 // why it left any to the processor; empty if it did not
};

/// Computes match() elsewhere, on a graphics processor, with the same bits. Thread-safe.
class MatchDevice {
 public:
  MatchDevice() = default;
  virtual ~MatchDevice() = default;
  MatchDevice(const MatchDevice&) = delete;
  MatchDevice& operator=(const MatchDevice&) = delete;

  /// Whether begin() has an effect with this configuration, now: the device is open and can do it.
  [[nodiscard]] virtual bool takes_early(const MatchConfig& config) const = 0;
  /// Begins the matches of a pair, of which it makes a copy, for a later match(). At most two are begun; no effect on
  /// further ones. Never waits for the device.
  virtual void begin(const StereoPair& pair, const MatchConfig& config,
                     const SemiGlobalConfig& penalties) = 0;
  /// The matches of a pair: those begun with equal images and options, or new ones. nullopt: the device cannot, and the
  /// processor has to.
  virtual std::optional<Matches> match(const StereoPair& pair, const MatchConfig& config,
                                       const SemiGlobalConfig& penalties, const Exec& exec) = 0;
  [[nodiscard]] virtual DeviceReport report() const = 0;
};

}  // namespace cairn
