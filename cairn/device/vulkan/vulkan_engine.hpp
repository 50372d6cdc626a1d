// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/device/engine.hpp>
#include <cairn/device/vulkan/vulkan.hpp>
#include <cstddef>
#include <memory>

namespace cairn::device {

/// What changes no result of the kernels.
struct Tuning {
  std::uint32_t group = 64;  // invocations of a group, 32 … 256: a power of two
  bool shuffles = true;      // where the device has them; else shared memory
};

/// The kernels of match_semi_global() on the device of this number. Throws Unfit if it cannot be used, Lost if it
/// fails.
std::unique_ptr<Engine> vulkan_engine(FindFunction find, std::size_t number, Tuning tuning = {});

}  // namespace cairn::device
