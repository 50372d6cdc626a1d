// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/true_frames.hpp>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/frame_names.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/io/read_file.hpp>

#include <cairn/output/json_line.hpp>
#include <cairn/output/trajectory_files.hpp>

namespace cairn::input {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::int64_t kMaxId = 65'535;
constexpr std::int64_t kMaxFrames = 10'000'000;

Json load_json(const fs::path& path) {
  constexpr std::size_t kMax = std::size_t{64} << 20;
  std::optional<Json> json;
  try {
    json = output::parsed_json(io::read_file(path, kMax));
  } catch (const Error& error) {
    const std::string message = error.what();
    throw Error(message.starts_with(path.string()) ? message : path.string() + ": " + message);
  }
  if (!json) throw Error(path.string() + ": is not JSON");
  return *json;
}

/// Calls take(line) for each entry of a list, and prefixes errors with the file's name.
template <class Take>
void each_in(const fs::path& path, const Json& json, const char* key, const Take& take) {
  try {
    const output::JsonLine whole(json);
    const Json& list = whole.at(key);
    if (list.is_null()) return;
    if (!list.is_array()) whole.refuse(key, "a list");
    for (const Json& one : list) take(output::JsonLine(one));
  } catch (const Error& error) {
    throw Error(path.string() + ": " + error.what());
  }
}

std::map<std::int64_t, TruePlace> load_places(const fs::path& path) {
  std::map<std::int64_t, TruePlace> places;
  each_in(path, load_json(path), "objects", [&](const output::JsonLine& object) {
    places[object.integer("id", 1, kMaxId)] = {object.maybe_point("centroid_visible_cam"),
                                               object.maybe_point("centroid_world")};
  });
  return places;
}

std::vector<TrueEvent> load_events(const fs::path& path) {
  std::vector<TrueEvent> events;
  each_in(path, load_json(path), "events", [&](const output::JsonLine& line) {
    TrueEvent event;
    event.id = line.integer("id", 1, kMaxId);
    event.is_in_view = line.text("what").find("while out of view") == std::string::npos;
    event.first_frame = line.integer("first_frame", 0, kMaxFrames);
    event.last_frame = line.integer("last_frame", event.first_frame, kMaxFrames);
    event.from_m = line.maybe_numbers<2>("from_xy");
    event.to_m = line.maybe_numbers<2>("to_xy");
    events.push_back(event);
  });
  return events;
}

TrueSequence from_mots(const fs::path& path) {
  TrueSequence truth;
  truth.is_numbered = true;
  for (output::TrackFrame& frame : output::load_mots(path).frames) {
    TrueFrame one;
    one.name = frame.name;
    one.masks = std::move(frame.tracks);
    truth.frames.push_back(std::move(one));
  }
  return truth;
}

}  // namespace

TrueSequence load_truth(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) throw Error(path.string() + ": no such file or folder");
  if (!fs::is_directory(path, ignored)) return from_mots(path);
  TrueSequence truth;
  std::error_code reason;
  for (fs::directory_iterator it(path, reason), end; !reason && it != end; it.increment(reason)) {
    const fs::path& folder = it->path();
    if (!fs::is_regular_file(folder / "objects.png", ignored)) continue;
    TrueFrame frame;
    frame.name = folder.filename().string();
    frame.is_partial = fs::exists(folder / "partial", ignored);
    frame.labels = folder / "objects.png";
    truth.frames.push_back(std::move(frame));
  }
  if (reason) throw Error(path.string() + ": cannot be listed: " + reason.message());
  if (truth.frames.empty())
    throw Error(path.string() + ": has no sub-folder with objects.png, expected one per frame");
  std::sort(truth.frames.begin(), truth.frames.end(),
            [](const TrueFrame& a, const TrueFrame& b) { return io::in_natural_order(a.name, b.name); });
  for (TrueFrame& frame : truth.frames) {
    const fs::path folder = frame.labels.parent_path();
    if (fs::exists(folder / "pose.txt", ignored))
      frame.world_from_camera = output::load_pose(folder / "pose.txt");
    if (fs::exists(folder / "scene.json", ignored)) frame.places = load_places(folder / "scene.json");
  }
  truth.has_events = fs::exists(path / "events.json", ignored);
  if (truth.has_events) truth.events = load_events(path / "events.json");
  return truth;
}

Image<TruthId> load_true_labels(const TrueFrame& frame) {
  if (!frame.labels.empty()) return io::truth_ids(io::load_labels(frame.labels));
  const auto first = std::find_if(frame.masks.begin(), frame.masks.end(),
                                  [](const output::TrackRecord& track) { return track.mask.has_value(); });
  if (first == frame.masks.end()) return {};
  const Image<TrackId> ids =
      output::track_labels(frame.masks, first->mask->size, "truth: frame " + frame.name);
  Image<TruthId> labels(ids.size(), TruthId::none, {});
  for (const output::TrackRecord& track : frame.masks) {
    const TruthId truth =
        track.is_dont_care ? TruthId::dont_care : TruthId{static_cast<std::int32_t>(number(track.id))};
    for (int y = 0; y < ids.height(); ++y) {
      for (int x = 0; x < ids.width(); ++x) {
        if (ids(x, y) == track.id) labels(x, y) = truth;
      }
    }
  }
  return labels;
}

}  // namespace cairn::input
