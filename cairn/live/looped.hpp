// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <functional>
#include <memory>

#include <cairn/input/sequence.hpp>

namespace cairn::live {

/// A sequence of files that repeats endlessly: for demonstrations, soak tests and experiments. Stamps
/// continue to ascend, and each round begins after a gap, since the camera jumps. `open` opens the source
/// again; throws Error if that does, or if it is a camera.
std::unique_ptr<input::Sequence> looped(std::function<std::unique_ptr<input::Sequence>()> open);

}  // namespace cairn::live
