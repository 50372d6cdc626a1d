// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace cairn {
struct Config;
struct ControlEvent;
struct DeviceReport;
struct Finding;
struct FindingChange;
struct Frame;
struct LandmarkEvent;
struct LandmarkOfTrack;
struct PairMeasures;
struct Pose;
struct Point3;
struct TrackedFrame;
struct Synchrony;
struct Tuning;
}  // namespace cairn

/// Results as JSON values; text is made where they leave the program. Internal: not installed.
namespace cairn::output {

struct EncodedFrame;
struct PageFrame;
struct Provenance;

using Json = nlohmann::ordered_json;

/// One line without a newline, or indented. Invalid UTF-8 in names is replaced: it is not an error.
std::string json_text(const Json& json, int indent = -1);

// Numbers; null if not finite.

Json finite(double value);
/// To 1e-6, which is 1 µm: further digits carry no information.
Json rounded(double value);
Json rounded(const Point3& point);
/// To this many significant digits.
Json significant(double value, int digits = 4);
/// The double nearest to the float's shortest decimal form: 0.7, not 0.699999988.
Json shortest(float value);

// Results; docs/formats.md describes their keys.

/// By section, without the options that `config` does not read.
Json json_of(const Config& config);
/// objects.json.
Json json_of(const Frame& frame, const Provenance& provenance);
/// `names`: of the pairs that Finding::frames counts.
Json json_of(const Finding& finding, const std::vector<std::string>& names);
/// Of a run, or of a measurement.
Json json_of(const DeviceReport& report);
/// Those of a run: a list, without names of pairs.
Json json_of(const std::vector<Finding>& findings);
Json json_of(const PairMeasures& measures);
/// `names`: of its frames; without them frames go by their numbers.
Json json_of(const Synchrony& synchrony, const std::vector<std::string>& names);
Json json_of(const Tuning& tuned, const std::vector<std::string>& names, std::uint32_t seed);
/// A line of tracks.jsonl.
Json json_of(const TrackedFrame& step, const std::string& name, const std::vector<LandmarkOfTrack>& landmarks,
             const std::string& frame_id);
/// A frame of the player (follow_page.hpp) from its line of tracks.jsonl. `map_from_odom`: nullopt if unknown.
EncodedFrame encode_step(Json line, const TrackedFrame& step, View<const Gray> left, View<const Rgb> left_rgb,
                         std::optional<double> milliseconds, const std::optional<Pose>& map_from_odom);
/// A frame of the page (web/html_page.hpp) with its objects.json; null: none.
EncodedFrame encode_frame(const PageFrame& frame, Json result);
/// The lines of events.jsonl of a step: options that control found, unreliability, findings about the rig, then
/// landmarks.
std::vector<Json> event_lines(const TrackedFrame& step, const std::vector<LandmarkOfTrack>& landmarks,
                              const std::vector<LandmarkEvent>& events,
                              const std::vector<FindingChange>& changes);

}  // namespace cairn::output
