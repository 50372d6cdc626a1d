// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan_core.h>

#include <cairn/device/device.hpp>
#include <cairn/device/engine.hpp>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace cairn::device {

/// Looks up Vulkan's functions. Tests pass one of their own, whose functions fail.
using FindFunction = PFN_vkGetInstanceProcAddr;

/// Of libvulkan.so.1, which stays loaded. Throws Unfit if there is none.
FindFunction vulkan_library();

/// All devices, in Vulkan's order. Throws Unfit if there is no driver.
std::vector<Listed> vulkan_devices(FindFunction find);

/// What changes no result of the kernels.
struct Tuning {
  std::uint32_t group = 64;  // invocations of a group, 32 … 256: a power of two
  bool shuffles = true;      // where the device has them; else shared memory
};

/// The kernels of match_semi_global() on the device of this number; if a name is given and another device has the number
/// now, on one of that name. Throws Unfit if it cannot be used, Lost if it fails or is not there any more.
std::unique_ptr<Engine> vulkan_engine(FindFunction find, std::size_t number, Tuning tuning = {},
                                      const std::string& name = {});

}  // namespace cairn::device
