// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <cairn/sequence/landmarks.hpp>

namespace cairn {

enum class MapMode : std::uint8_t {
  read_only,  // the file must exist; several readers next to one writer
  update      // created if absent; one writer at a time
};

enum class RunState : std::uint8_t { running, done, aborted };
inline constexpr std::array kRunStates{Choice{"running", RunState::running}, Choice{"done", RunState::done},
                                       Choice{"aborted", RunState::aborted}};

struct MapRun {
  std::int64_t id = 0;
  std::string source;
  Stamp began;
  Stamp ended;
  int frames = 0;
  std::optional<Pose> map_from_odom;  // the last one; none = unknown
  RunState state = RunState::running;
};

/// The pose of a keyframe.
struct MapPose {
  std::int64_t run = 0;
  Stamp stamp;
  Pose map_from_camera;
  Covariance6 covariance{};  // stored in single precision
};

/// A landmark as observed in one frame.
struct MapObservation {
  std::int64_t run = 0;
  Stamp stamp;
  LandmarkId landmark = LandmarkId::none;
  TrackId track = TrackId::none;
  Point3 position_m;
  Covariance3 covariance_m2{};
  double confidence = 0;
};

struct MapEvent {
  std::int64_t run = 0;
  LandmarkEvent event;
};

/// A map in one SQLite file; docs/formats.md has its schema. Every member throws Error with one line that
/// names the file: absent, not a map, damaged, of a newer cairn, of another rig, read-only, in use, no space
/// left. Uncommitted transactions are not in the file; committed data survives any crash.
class MapFile {
 public:
  /// `rig`: its baseline must be that of the map, if the map has one; otherwise the map stores it.
  static MapFile open(const std::filesystem::path& path, MapMode mode,
                      const std::optional<StereoRig>& rig = std::nullopt);
  MapFile(MapFile&&) noexcept;
  MapFile& operator=(MapFile&&) noexcept;
  MapFile(const MapFile&) = delete;
  MapFile& operator=(const MapFile&) = delete;
  /// Closes silently; a run that was not ended is marked `aborted` by the next writer.
  ~MapFile();

  /// The contents as of the last commit.
  [[nodiscard]] LandmarkMap load() const;
  [[nodiscard]] std::vector<MapRun> runs() const;
  [[nodiscard]] std::vector<MapPose> poses() const;
  [[nodiscard]] std::vector<MapObservation> observations() const;
  [[nodiscard]] std::vector<MapEvent> events() const;
  /// The identity of this map and of its copies.
  [[nodiscard]] std::string map_id() const;
  [[nodiscard]] std::optional<StereoRig> rig() const;
  /// Inconsistencies, one line each; empty if sound.
  [[nodiscard]] std::vector<std::string> check() const;

  /// Begins the run that following calls of write() belong to.
  std::int64_t begin_run(const std::string& source, Stamp began);
  /// Stores one frame: its pose if it is a keyframe, its events, its observations unless is_guessed().
  /// Commits every 30 frames or 1 s of stamps.
  void write(const LandmarkFrame& frame, const LandmarkUpdate& step);
  /// `map`: its final state.
  void end_run(RunState state, const LandmarkMap& map);

  /// A copy of all committed data, runs and events included. Throws Error if `path` exists.
  void copy_to(const std::filesystem::path& path) const;

  /// Replaces the whole map: after forget() or merge().
  void replace(const LandmarkMap& map);

  /// Other data that is kept in the file, by key: what a map agent knows of its robots (cairn/fleet).
  [[nodiscard]] std::map<std::string, std::string> kept() const;
  /// Adds or replaces what has a value, and removes what has none, together with replace(). Throws Error during a run.
  void keep(const std::map<std::string, std::optional<std::string>>& changes, const LandmarkMap& map);

 private:
  struct Store;
  explicit MapFile(std::unique_ptr<Store> store);
  std::unique_ptr<Store> store_;
};

/// The map without a landmark and all its data. Throws Error if it does not exist.
LandmarkMap forget(LandmarkMap map, LandmarkId id);

}  // namespace cairn
