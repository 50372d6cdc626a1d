// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <functional>
#include <memory>

#include "../source/sequence.hpp"

namespace cairn::live {

/// A sequence of files that begins again at its end, for ever: for screens, soaks and trying things out. The
/// stamps go on rising, and each new round begins after a gap, because the camera is somewhere else then.
/// `open` opens it anew; throws Error where that does, and where it opens a camera.
std::unique_ptr<io::Sequence> looped(std::function<std::unique_ptr<io::Sequence>()> open);

}  // namespace cairn::live
