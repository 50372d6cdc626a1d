// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

// Vulkan's functions are looked up at run time: nothing links libvulkan. Only the sources of instance and engine include
// this: it takes ten seconds to compile.
#define VULKAN_HPP_ENABLE_DYNAMIC_LOADER_TOOL 0
#include <cairn/device/vulkan/vulkan_engine.hpp>
#include <vulkan/vulkan_raii.hpp>
