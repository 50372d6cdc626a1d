// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>
#include <string_view>

#include <cairn/live/view/channels.hpp>

/// The JSON data of a frame for viewers. Internal to the live view.
namespace cairn::live {

/// The content of /cairn/stats. (docs/live_view.md, "Statistics")
std::string stats_json(const LiveFrame& frame, const std::optional<StereoRig>& rig, const ViewState& state);
/// The content before the first frame.
std::string stats_json(const ViewState& state);
extern const std::string_view kStatsSchema;

/// The content of /cairn/scene: a foxglove.SceneUpdate with a box and a text for every object with a
/// position.
std::string scene_json(const LiveFrame& frame, const std::optional<StereoRig>& rig);
extern const std::string_view kSceneSchema;

}  // namespace cairn::live
