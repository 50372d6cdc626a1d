// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "map_work.hpp"

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/sequence/map_exports.hpp>
#include <cairn/sequence/map_file.hpp>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <numbers>

#include "follow_options.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

std::string seconds(Stamp stamp) {
  return text_of("%.2f", static_cast<double>(stamp.ns) * 1e-9);
}

int show(const MapOptions& options) {
  const MapFile file = MapFile::open(options.file, MapMode::read_only);
  const LandmarkMap map = file.load();
  const auto gone = static_cast<std::size_t>(
      std::count_if(map.list.begin(), map.list.end(), [](const Landmark& l) { return l.is_gone; }));
  std::cout << options.file << ": " << count_of(map.list.size(), "landmark")
            << (gone > 0 ? ", " + std::to_string(gone) + " of them gone" : "") << "\n";
  if (const auto rig = file.rig()) {
    std::cout << "rig: baseline " << text_of("%g m", static_cast<double>(rig->baseline_m))
              << ", focal length " << text_of("%g px", static_cast<double>(rig->focal_px)) << "\n";
  }
  Table landmarks(
      {"landmark", "x m", "y m", "z m", "± m", "width m", "height m", "present", "seen", "expected", "name"});
  for (const Landmark& l : map.list) {
    const double sigma = std::sqrt((l.covariance_m2[0] + l.covariance_m2[4]) / 2);
    landmarks.add({std::to_string(number(l.id)), text_of("%.2f", l.position_m.x),
                   text_of("%.2f", l.position_m.y), text_of("%.2f", l.position_m.z), text_of("%.2f", sigma),
                   text_of("%.2f", (l.size.narrowest_m + l.size.widest_m) / 2),
                   text_of("%.2f", l.size.height_m),
                   l.is_gone ? "gone" : text_of("%.3f", probability_of(l.log_odds)), std::to_string(l.seen),
                   std::to_string(l.expected), l.name});
  }
  if (!map.list.empty()) std::cout << "\n" << landmarks.text();
  Table runs({"run", "state", "frames", "start s", "end s", "located", "source"});
  for (const MapRun& run : file.runs()) {
    runs.add({std::to_string(run.id), choice_name(run.state, kRunStates), std::to_string(run.frames),
              seconds(run.began), seconds(run.ended), run.map_from_odom ? "yes" : "no", run.source});
  }
  if (!file.runs().empty()) std::cout << "\n" << runs.text();
  Table events({"event", "run", "time s", "landmark", "x m", "y m", "moved m", "probability"});
  for (const MapEvent& e : file.events()) {
    events.add({choice_name(e.event.kind, kLandmarkEventKinds), std::to_string(e.run), seconds(e.event.stamp),
                e.event.landmark == LandmarkId::none ? "" : std::to_string(number(e.event.landmark)),
                text_of("%.2f", e.event.position_m.x), text_of("%.2f", e.event.position_m.y),
                e.event.kind == LandmarkEventKind::moved ? text_of("%.2f", length(e.event.moved_by_m)) : "",
                text_of("%.2f", e.event.probability)});
  }
  if (!file.events().empty()) std::cout << "\n" << events.text();
  return 0;
}

int check(const MapOptions& options) {
  const MapFile file = MapFile::open(options.file, MapMode::read_only);
  const std::vector<std::string> wrong = file.check();
  for (const std::string& line : wrong) std::cout << line << "\n";
  if (!wrong.empty()) return 1;
  std::cout << options.file << ": valid, " << count_of(file.load().list.size(), "landmark") << ", "
            << count_of(file.runs().size(), "run") << "\n";
  return 0;
}

int write_out(const MapOptions& options) {
  const MapFile file = MapFile::open(options.file, MapMode::read_only);
  const std::string text = options.form == "g2o"   ? as_g2o(file)
                           : options.form == "tum" ? as_tum(file, options.run)
                           : options.form == "csv" ? as_csv(file.load())
                                                   : as_geojson(file);
  if (options.output.empty()) {
    std::cout << text;
  } else {
    io::write_file(options.output, text);
  }
  return 0;
}

bool are_copies(const MapFile& file, const MapFile& other) {
  return !file.map_id().empty() && file.map_id() == other.map_id();
}

/// The known poses of `others`.
std::vector<std::optional<Pose>> places_of(const MapOptions& options) {
  std::vector<std::optional<Pose>> places(options.others.size());
  for (const std::string& text : options.places) {
    const auto [name, pose] = named_pose(text);
    std::vector<std::size_t> named;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (fs::path(options.others[i]).stem() == name) named.push_back(i);
    }
    if (named.size() != 1)
      throw Error("--at " + text + ": " + count_of(named.size(), "map") +
                  " of that name after FILE, expected 1");
    if (places[named[0]]) throw Error("--at " + text + ": the second pose of this map, expected one");
    places[named[0]] = pose;
  }
  return places;
}

/// All maps in the frame of the first: copies of it by id and appearance, others where --at says, or by appearance and
/// place. Throws Error if one finds no place.
MapsMerge merged_of(const MapFile& file, const MapOptions& options) {
  std::vector<std::optional<Pose>> places = places_of(options);
  std::vector<MapFile> files;
  std::vector<MapToMerge> others;
  for (std::size_t i = 0; i < options.others.size(); ++i) {
    files.push_back(MapFile::open(options.others[i], MapMode::read_only));
    const bool is_copy = are_copies(file, files[i]);
    if (is_copy && places[i])
      throw Error("--at: " + options.others[i] + " is a copy of " + options.file + ", so its pose is known");
    for (std::size_t j = 0; j < i && !is_copy; ++j) {
      if (are_copies(files[i], files[j])) {
        throw Error(options.others[i] + ": is a copy of " + options.others[j] +
                    "; merge these two first, or what both saw would count twice");
      }
    }
    others.push_back({files[i].load(), is_copy, places[i]});
  }
  MapsMerge merged = merge_all(file.load(), others, LandmarksConfig{});
  for (std::size_t i = 0; i < merged.placed.size(); ++i) {
    if (merged.placed[i].map_from_other) continue;
    throw Error(options.others[i] + ": matches no place in " + options.file + " (" +
                choice_name(merged.placed[i].refusal, kRecognitionRefusals) + "), expected common landmarks" +
                (options.action == "merge" ? ", or --at" : ""));
  }
  return merged;
}

int diff(const MapOptions& options) {
  if (options.others.size() != 1)
    throw Error("map diff: found " + count_of(options.others.size() + 1, "map") + ", expected 2");
  const MapFile file = MapFile::open(options.file, MapMode::read_only);
  const LandmarkMap map = file.load();
  const LandmarkMap second = MapFile::open(options.others[0], MapMode::read_only).load();
  const auto moved_by = [](const Landmark& a, Point3 b) {
    return std::hypot(b.x - a.position_m.x, b.y - a.position_m.y);
  };
  const auto least = static_cast<double>(LandmarksConfig{}.moved);
  Table table({"change", "landmark", "x m", "y m", "moved m"});
  std::size_t changes = 0;
  const auto add = [&](const char* change, LandmarkId id, Point3 at, double by) {
    table.add({change, std::to_string(number(id)), text_of("%.2f", at.x), text_of("%.2f", at.y),
               by > 0 ? text_of("%.2f", by) : ""});
    ++changes;
  };
  const PlacedMap placed = merged_of(file, options).placed[0];
  const Pose pose = *placed.map_from_other;
  std::vector<LandmarkId> met;
  for (const Landmark& theirs : second.list) {
    const Landmark* ours = nullptr;
    for (const LandmarkPair& pair : placed.pairs) {
      if (number(pair.track) == number(theirs.id)) ours = find(map, pair.landmark);
    }
    const Point3 at = pose(theirs.position_m);
    if (ours == nullptr) {
      if (!theirs.is_gone) add("new", theirs.id, at, 0);
      continue;
    }
    met.push_back(ours->id);
    if (theirs.is_gone && !ours->is_gone) {
      add("gone", ours->id, ours->position_m, 0);
    } else if (!theirs.is_gone && ours->is_gone) {
      add("back", ours->id, at, 0);
    } else if (!theirs.is_gone && moved_by(*ours, at) > least) {
      add("moved", ours->id, at, moved_by(*ours, at));
    }
  }
  for (const Landmark& ours : map.list) {
    if (!ours.is_gone && std::find(met.begin(), met.end(), ours.id) == met.end())
      add("not in OTHER", ours.id, ours.position_m, 0);
  }
  std::cout << (changes == 0 ? "no change\n" : table.text());
  return 0;
}

int merge_files(const MapOptions& options) {
  if (options.others.empty()) throw Error("map merge: found one map, expected OTHER");
  const MapFile file = MapFile::open(options.file, MapMode::read_only);
  if (options.output.empty()) throw Error("map merge: found no output file, expected -o FILE");
  if (fs::exists(options.output)) throw Error("-o " + options.output + ": already exists");
  const MapsMerge merged = merged_of(file, options);
  const fs::path part = options.output + ".part";
  std::error_code unimportant;
  fs::remove(part, unimportant);
  try {
    file.copy_to(part);
    MapFile::open(part, MapMode::update).replace(merged.map);
    fs::rename(part, options.output);
  } catch (...) {
    fs::remove(part, unimportant);
    throw;
  }
  std::cout << options.output << ": " << count_of(merged.map.list.size(), "landmark") << "\n";
  for (std::size_t i = 0; i < merged.placed.size(); ++i) {
    const Pose& pose = *merged.placed[i].map_from_other;
    std::cout << options.others[i] << ": at x " << text_of("%.2f", pose.translation_m.x) << " m, y "
              << text_of("%.2f", pose.translation_m.y) << " m, "
              << text_of("%.1f", yaw_of(pose) * 180 / std::numbers::pi) << " degrees; "
              << count_of(merged.placed[i].pairs.size(), "common landmark") << "\n";
  }
  return 0;
}

int forget_some(const MapOptions& options) {
  if (options.ids.empty() && !options.gone)
    throw Error("map forget: found no landmark, expected --id N or --gone");
  MapFile file = MapFile::open(options.file, MapMode::update);
  LandmarkMap map = file.load();
  const std::size_t before = map.list.size();
  if (options.gone) std::erase_if(map.list, [](const Landmark& l) { return l.is_gone; });
  for (const std::int64_t id : options.ids) {
    if (find(map, LandmarkId{id}) == nullptr)
      throw Error("--id " + std::to_string(id) + ": " + options.file + " has no such landmark");
    map = forget(std::move(map), LandmarkId{id});
  }
  file.replace(map);
  std::cout << options.file << ": " << count_of(before - map.list.size(), "landmark") << " forgotten, "
            << map.list.size() << " left\n";
  return 0;
}

}  // namespace

int work_on_map(const MapOptions& options) {
  const bool takes_two = options.action == "diff" || options.action == "merge";
  if (!takes_two && !options.others.empty())
    throw Error("map " + options.action + ": expected one map, found a second, " + options.others[0]);
  if (options.action != "merge" && !options.places.empty())
    throw Error("--at: is for map merge, not for map " + options.action);
  if (options.action == "show") return show(options);
  if (options.action == "check") return check(options);
  if (options.action == "export") return write_out(options);
  if (options.action == "diff") return diff(options);
  if (options.action == "merge") return merge_files(options);
  return forget_some(options);
}

}  // namespace cairn::cli
