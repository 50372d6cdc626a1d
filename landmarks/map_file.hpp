// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "landmarks.hpp"

namespace cairn {

enum class MapMode : std::uint8_t {
  read_only,  // the file must be there; several readers beside one writer
  update      // made where it is not there; one writer at a time
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
  std::optional<Pose> map_from_odom;  // as it was last; none: not known where
  RunState state = RunState::running;
};

/// A keyframe's pose.
struct MapPose {
  std::int64_t run = 0;
  Stamp stamp;
  Pose map_from_camera;
  Covariance6 covariance{};  // stored in single precision
};

/// A landmark as one frame saw it.
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
/// names the file: absent, no map, damaged, of a newer cairn, of another rig, read-only, in use, no space
/// left. What a transaction had not ended is not in the file; what was committed stays whole whatever
/// happens.
class MapFile {
 public:
  /// `rig`: whose baseline the map's must be; asked of a file that knows one, remembered by one that does
  /// not.
  static MapFile open(const std::filesystem::path& path, MapMode mode,
                      const std::optional<StereoRig>& rig = std::nullopt);
  MapFile(MapFile&&) noexcept;
  MapFile& operator=(MapFile&&) noexcept;
  MapFile(const MapFile&) = delete;
  MapFile& operator=(const MapFile&) = delete;
  /// Ends what is open without a word; a run that was not ended is found `aborted` by the next who writes.
  ~MapFile();

  /// What the file held when its last transaction was committed.
  [[nodiscard]] LandmarkMap load() const;
  [[nodiscard]] std::vector<MapRun> runs() const;
  [[nodiscard]] std::vector<MapPose> poses() const;
  [[nodiscard]] std::vector<MapObservation> observations() const;
  [[nodiscard]] std::vector<MapEvent> events() const;
  /// A name of this map and of its copies.
  [[nodiscard]] std::string map_id() const;
  [[nodiscard]] std::optional<StereoRig> rig() const;
  /// What is wrong inside, one line each; none: sound.
  [[nodiscard]] std::vector<std::string> check() const;

  /// From here on, write() belongs to this run.
  std::int64_t begin_run(const std::string& source, Stamp began);
  /// One frame: its pose where it is a keyframe, its events, what was seen where it is not is_guessed().
  /// Committed every 30 frames or 1 s of stamps.
  void write(const LandmarkFrame& frame, const Landmarked& step);
  /// `map`: as it is at the end.
  void end_run(RunState state, const LandmarkMap& map);

  /// A copy with all that is committed, runs and events included. Throws Error where `path` is there already.
  void copy_to(const std::filesystem::path& path) const;

  /// The whole map in place of what is there: after forget() or merge().
  void replace(const LandmarkMap& map);

 private:
  struct Store;
  explicit MapFile(std::unique_ptr<Store> store);
  std::unique_ptr<Store> store_;
};

/// Without a landmark, all that was said of it included. Throws Error where there is none.
LandmarkMap forget(LandmarkMap map, LandmarkId id);

}  // namespace cairn
