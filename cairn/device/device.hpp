// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/stereo/match_device.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

/// Graphics processors that match stereo pairs, through Vulkan 1.1 (docs/gpu.md).
namespace cairn::device {

/// A device of this computer.
struct Listed {
  std::string name;
  std::string kind;  // discrete, integrated, virtual, processor, other
  std::string driver;
  std::uint64_t largest_buffer_bytes = 0;  // limits the size of the images
  std::uint32_t group = 0;                 // most invocations of a group
  std::uint32_t subgroup = 0;              // lanes that exchange values without a barrier; 0: none do
  std::string unusable;                    // why it cannot be used; empty if it can
  std::string not_by_itself;               // why `auto` does not take it; empty if it does
};

/// All devices that Vulkan shows, in its order: a device's number is its place. Throws Error if this build or this
/// computer has no Vulkan.
std::vector<Listed> devices();

/// Called with a line for the user when a device is lost, leaves work to the processor, or is given up.
using Notice = std::function<void(const std::string&)>;

/// `wanted`: "off" or empty (null); "auto": the first graphics processor, which is given up if it does not compute what
/// the processor computes, or not faster, and null if there is none; the number of a device; or a part of its name. With
/// "auto", the device is prepared while the processor computes the first frames. Throws Error, beginning with `source`, if
/// a device that is named is not there or cannot be used. `notice` may be called from any thread.
std::shared_ptr<MatchDevice> open(const std::string& wanted, const std::string& source,
                                  const Notice& notice = {});

}  // namespace cairn::device
