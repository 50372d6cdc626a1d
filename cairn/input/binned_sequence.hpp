// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/input/sequence.hpp>
#include <memory>

namespace cairn::input {

/// The frames of a sequence with factor × factor pixels in one, and their calibration. Throws Error if the images are
/// smaller than that. Private to the library.
std::unique_ptr<Sequence> binned(std::unique_ptr<Sequence> sequence, int factor, const Pool& pool);

}  // namespace cairn::input
