// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/device/device.hpp>
#include <cairn/device/vulkan/vulkan.hpp>
#include <vector>

namespace cairn::device {

/// The kind of a device in software.
inline constexpr const char* kSoftware = "processor";

/// Buffers of search.glsl.
inline constexpr std::uint32_t kStorageBuffers = 6;

/// What a device offers to the kernels.
struct Traits {
  std::size_t number = 0;  // among all devices
  Listed listed;
  std::uint32_t queue_family = 0;
  std::uint64_t clock_mask = 0;  // of its ticks; 0: it has no clock
  double ns_per_tick = 0;
  bool can_fix_subgroups = false;  // demand its subgroup size, which would vary otherwise
};

/// Vulkan and its devices. Throws Unfit if there is none.
class Instance {
 public:
  explicit Instance(FindFunction find);
  [[nodiscard]] const std::vector<vk::raii::PhysicalDevice>& devices() const { return devices_; }
  [[nodiscard]] std::vector<Traits> traits() const;

 private:
  vk::raii::Context context_;
  vk::raii::Instance instance_;
  std::vector<vk::raii::PhysicalDevice> devices_;
};

}  // namespace cairn::device
