// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/stereo/semi_global.hpp>

namespace cairn::reference {

/// The definitions of semi-global matching, over whole cost volumes.
Matches match_semi_global(const StereoPair& pair, const MatchConfig& config,
                          const SemiGlobalConfig& penalties);

}  // namespace cairn::reference
