// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/sequence/follow_config.hpp>
#include <optional>

#include "common.hpp"

namespace cairn::cli {

/// Like resolve(), with the options of a sequence, which may be in the same file and in --set.
FollowConfig resolve_follow(const ConfigOptions& options,
                            std::optional<int> calibrated_disparities = std::nullopt,
                            KnownGround ground = {});
/// The base preset.
std::string preset_of(const ConfigOptions& options);
/// What the search for better options found, in words.
std::string control_line(const ControlEvent& event);

}  // namespace cairn::cli
