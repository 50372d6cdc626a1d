// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <span>

namespace cairn::device {

enum class Kernel : std::uint8_t { describe, down, up, left, right };
inline constexpr const char* kKernelNames[] = {"describe", "down", "up", "left", "right"};

/// Words of four candidates for each lane.
inline constexpr int kLeastWords = 2, kMostWords = 4;

/// The compiled kernel, of `words` words a lane; `describe` is the same for all. The build compiles it from *.comp.
std::span<const std::uint32_t> shader(Kernel kernel, int words, bool shuffles);

}  // namespace cairn::device
