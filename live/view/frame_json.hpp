// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>
#include <string_view>

#include "channels.hpp"

/// What of a frame goes to viewers as JSON. Internal to the live view.
namespace cairn::live {

/// Of /cairn/stats. (docs/live_view.md, "Statistics")
std::string stats_json(const LiveFrame& frame, const std::optional<StereoRig>& rig, const ViewState& state);
/// Before the first frame: what is known without one.
std::string stats_json(const ViewState& state);
extern const std::string_view kStatsSchema;

/// Of /cairn/scene: a foxglove.SceneUpdate with a box and a text for every object that has a place.
std::string scene_json(const LiveFrame& frame, const std::optional<StereoRig>& rig);
extern const std::string_view kSceneSchema;

}  // namespace cairn::live
