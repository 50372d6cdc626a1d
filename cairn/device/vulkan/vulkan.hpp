// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

// Vulkan's functions are looked up at run time: nothing links libvulkan.
#define VK_NO_PROTOTYPES
#define VULKAN_HPP_ENABLE_DYNAMIC_LOADER_TOOL 0
#include <vulkan/vulkan_raii.hpp>

namespace cairn::device {

/// Looks up Vulkan's functions. Tests pass one of their own, whose functions fail.
using FindFunction = PFN_vkGetInstanceProcAddr;

/// Of libvulkan.so.1, which stays loaded. Throws Unfit if there is none.
FindFunction vulkan_library();

}  // namespace cairn::device
