// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <SQLiteCpp/SQLiteCpp.h>
#include <cairn/core/error.hpp>
#include <cairn/sequence/map_exports.hpp>
#include <cairn/sequence/map_file.hpp>
#include <csignal>
#include <random>
#include <sstream>
#include <support/temporary_folder.hpp>

namespace cairn {
namespace {

namespace fs = std::filesystem;
using support::has;
using support::refusal;
using support::TemporaryFolder;

constexpr StereoRig kRig{200, 160, 120, 0.12F, 0};

Landmark landmark(std::int64_t id, Point3 at) {
  Landmark l;
  l.id = LandmarkId{id};
  l.position_m = at;
  l.covariance_m2 = {0.01, 0.001, 0, 0.001, 0.02, 0, 0, 0, 0.03};
  l.size = {0.3, 0.4, 0.5};
  l.height_over_floor_m = 0.25;
  LandmarkLook look;
  look.octant = 3;
  look.colours[5] = 0.75F;
  look.colours[30] = 0.5F;
  look.pixels = 400;
  look.crop_png = std::string("\x89PNG\0crop", 9);
  l.looks.push_back(look);
  l.log_odds = 2.5;
  l.seen = 10;
  l.expected = 12;
  l.open_share = 0.125;
  l.first = {1'000'000'000};
  l.last = {4'000'000'000};
  l.run = 1;
  return l;
}

/// A run of `count` frames in which one landmark is seen; another one is new at frame 5.
struct Drive {
  Tracks tracks;
  LandmarkFrame frame;
  LandmarkUpdate step;

  explicit Drive(MapFile& file) {
    step.state = begin_landmarks(file.load(), file.begin_run("frames/", {0}));
    step.state.is_located = true;
    Track track;
    track.id = TrackId{7};
    track.object = ObjectId{1};
    track.position_m = {1, 2, 0.25};
    track.covariance_m2 = {0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01};
    track.confidence = 0.5F;
    tracks.list.push_back(track);
    frame.tracks = &tracks;
    frame.rig = kRig;
  }

  void frames(MapFile& file, int count) {
    for (int i = 0; i < count; ++i, ++frame.index) {
      frame.stamp = {std::int64_t{frame.index} * 100'000'000};
      frame.is_keyframe = frame.index % 5 == 0;
      frame.odom_from_camera.translation_m.x = 0.01 * frame.index;
      LandmarkMap& map = step.state.map;
      step.events.clear();
      if (frame.index == 0 && map.list.empty()) map.list.push_back(landmark(map.next++, {1, 2, 0.25}));
      if (frame.index == 5) {
        map.list.push_back(landmark(map.next++, {3, -1, 0.5}));
        step.events.push_back(
            {LandmarkEventKind::found, frame.stamp, map.list.back().id, {3, -1, 0.5}, {}, 0.9, {4, 5}});
      }
      map.list.front().seen = frame.index;
      map.floor = {{-1, 2, frame.index + 1}};
      step.tracks = {{TrackId{7}, map.list.front().id, LandmarkRefusal::none, false, 0}};
      file.write(frame, step);
    }
  }
};

/// The outcome of `work` in a process of its own: 0, or 1 with the Error's message.
std::pair<int, std::string> in_a_child(const std::function<void()>& work) {
  std::array<int, 2> ends{};
  EXPECT_EQ(::pipe(ends.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    int code = 0;
    std::string says;
    try {
      work();
    } catch (const Error& error) {
      code = 1;
      says = error.what();
    } catch (const std::exception& error) {
      code = 2;
      says = error.what();
    }
    (void)!::write(ends[1], says.data(), says.size());
    ::_exit(code);
  }
  ::close(ends[1]);
  std::string says;
  std::array<char, 512> part{};
  for (ssize_t n = 0; (n = ::read(ends[0], part.data(), part.size())) > 0;)
    says.append(part.data(), static_cast<std::size_t>(n));
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), says};
}

TEST(MapFile, StoresEverythingThatARunLearned) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "room.db";
  LandmarkMap written;
  {
    MapFile file = MapFile::open(path, MapMode::update, kRig);
    Drive drive(file);
    drive.frames(file, 40);
    written = drive.step.state.map;
    file.end_run(RunState::done, written);
  }
  const MapFile file = MapFile::open(path, MapMode::read_only, kRig);
  const LandmarkMap read = file.load();
  ASSERT_EQ(read.list.size(), 2U);
  EXPECT_EQ(read.next, written.next);
  EXPECT_EQ(read.floor, written.floor);
  for (std::size_t i = 0; i < 2; ++i) {
    const Landmark& a = read.list[i];
    const Landmark& b = written.list[i];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.position_m, b.position_m);
    EXPECT_EQ(a.covariance_m2, b.covariance_m2);
    EXPECT_EQ(a.size.widest_m, b.size.widest_m);
    EXPECT_EQ(a.size.narrowest_m, b.size.narrowest_m);
    EXPECT_EQ(a.size.height_m, b.size.height_m);
    EXPECT_EQ(a.seen, b.seen);
    EXPECT_EQ(a.expected, b.expected);
    EXPECT_EQ(a.log_odds, b.log_odds);
    EXPECT_EQ(a.open_share, b.open_share);
    EXPECT_EQ(a.first, b.first);
    EXPECT_EQ(a.last, b.last);
    ASSERT_EQ(a.looks.size(), 1U);
    EXPECT_EQ(a.looks[0].octant, 3);
    EXPECT_EQ(a.looks[0].colours, b.looks[0].colours);
    EXPECT_EQ(a.looks[0].crop_png, b.looks[0].crop_png);
    EXPECT_EQ(a.looks[0].pixels, b.looks[0].pixels);
  }
  const auto runs = file.runs();
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_EQ(runs[0].state, RunState::done);
  EXPECT_EQ(runs[0].source, "frames/");
  EXPECT_EQ(runs[0].frames, 40);
  EXPECT_TRUE(runs[0].map_from_odom.has_value());
  const auto poses = file.poses();
  ASSERT_EQ(poses.size(), 8U);
  EXPECT_NEAR(poses[3].map_from_camera.translation_m.x, 0.15, 1e-12);
  EXPECT_EQ(file.observations().size(), 40U);
  const auto events = file.events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].event.kind, LandmarkEventKind::found);
  EXPECT_EQ(events[0].event.frames, (std::vector<int>{4, 5}));
  EXPECT_TRUE(file.check().empty());
  EXPECT_EQ(file.map_id().size(), 32U);
  ASSERT_TRUE(file.rig().has_value());
  EXPECT_EQ(file.rig()->baseline_m, kRig.baseline_m);
}

TEST(MapFile, HasPosesAndEdgesWithUncertaintiesAlongTheirOwnAxesAndExactStamps) {
  const TemporaryFolder folder;
  MapFile file = MapFile::open(folder.path() / "room.db", MapMode::update);
  const Pose quarter = rotation_about({0, 0, std::numbers::pi / 2});
  Tracks tracks;
  LandmarkUpdate step;
  step.state = begin_landmarks({}, file.begin_run("frames/", {0}), quarter);
  LandmarkFrame frame;
  frame.tracks = &tracks;
  frame.is_keyframe = true;
  // The camera looks along odometry's x: x right, y down, z forward.
  frame.odom_from_camera = {{0, 0, 1, -1, 0, 0, 0, -1, 0}, {0, 0, 0.5}};
  for (const std::int64_t i : {1, 2}) {
    frame.stamp = {(i - 1) * 1'700'000'000'123'456'789};
    frame.index = static_cast<int>(i);
    const auto n = static_cast<double>(i);
    for (std::size_t k = 0; k < 6; ++k) frame.pose_covariance[k * 7] = 0.01 * n;
    frame.pose_covariance[0] = 0.04 * n;
    step = advance_landmarks(std::move(step.state), frame, {});
    file.write(frame, step);
  }
  file.end_run(RunState::done, step.state.map);
  const auto poses = file.poses();
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_NEAR(poses[1].covariance[0], 0.02, 1e-6);  // the map's x is odometry's y
  EXPECT_NEAR(poses[1].covariance[7], 0.08, 1e-6);
  EXPECT_NEAR(poses[1].covariance[14], 0.02, 1e-6);
  // The camera's forward axis, z, is the most uncertain.
  const std::string g2o = as_g2o(file);
  std::istringstream edge(g2o.substr(g2o.find("EDGE_SE3:QUAT")));
  std::string name;
  edge >> name;
  std::array<double, 2 + 7 + 21> numbers{};
  for (double& number : numbers) ASSERT_TRUE(edge >> number) << g2o;
  EXPECT_NEAR(numbers[9 + 0], 100, 0.1);  // x
  EXPECT_NEAR(numbers[9 + 6], 100, 0.1);  // y
  EXPECT_NEAR(numbers[9 + 11], 25, 0.1);  // z
  EXPECT_NEAR(numbers[9 + 2], 0, 0.1);    // x with z
  // g2o's rotation error is the vector part of the quaternion, half the angle: four times the information.
  for (const std::size_t entry : {15U, 18U, 20U}) EXPECT_NEAR(numbers[9 + entry], 400, 0.4);

  EXPECT_NE(as_tum(file, 0).find("\n1700000000.123456789 0.000000 "), std::string::npos) << as_tum(file, 0);
  EXPECT_EQ(seconds_text({-1'500'000'000}), "-1.500000000");
  EXPECT_EQ(seconds_text({std::numeric_limits<std::int64_t>::min()}), "-9223372036.854775808");
}

TEST(MapFile, HoldsNoMoreThanTwoHundredObservationsOfALandmarkAndRunSpreadEvenly) {
  const TemporaryFolder folder;
  MapFile file = MapFile::open(folder.path() / "room.db", MapMode::update);
  Drive drive(file);
  drive.frames(file, 1000);
  file.end_run(RunState::done, drive.step.state.map);
  const auto all = file.observations();
  EXPECT_LE(all.size(), 200U);
  EXPECT_GE(all.size(), 100U);
  // Equally many of both halves, up to one.
  const auto early = std::count_if(all.begin(), all.end(),
                                   [](const MapObservation& o) { return o.stamp.ns < 50'000'000'000; });
  EXPECT_NEAR(static_cast<double>(early), static_cast<double>(all.size()) / 2, 1.5);
}

TEST(MapFile, StaysSmallOverAHundredThousandFrames) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "room.db";
  {
    MapFile file = MapFile::open(path, MapMode::update);
    Drive drive(file);
    drive.frames(file, 100'000);  // every fifth is a keyframe
    file.end_run(RunState::done, drive.step.state.map);
  }
  EXPECT_LE(fs::file_size(path), 20U << 20U);
}

TEST(MapFile, IsRefusedForReadingIfMissingAndCreatedForWriting) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "room.db";
  EXPECT_TRUE(
      has(refusal([&] { (void)MapFile::open(path, MapMode::read_only); }), {"room.db", "no such file"}));
  EXPECT_FALSE(fs::exists(path));
  const fs::path lost = folder.path() / "no/such/room.db";
  EXPECT_TRUE(has(refusal([&] { (void)MapFile::open(lost, MapMode::update); }), {"room.db", "folder"}));
  EXPECT_TRUE(has(refusal([&] { (void)MapFile::open(folder.path(), MapMode::update); }), {"is a folder"}));
  (void)MapFile::open(path, MapMode::update);
  EXPECT_TRUE(MapFile::open(path, MapMode::read_only).load().list.empty());
}

TEST(MapFile, IsRefusedForWritingIfReadOnlyButReadable) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "room.db";
  {
    MapFile file = MapFile::open(path, MapMode::update);
    Drive drive(file);
    drive.frames(file, 10);
    file.end_run(RunState::done, drive.step.state.map);
  }
  ::chmod(path.c_str(), 0444);
  ::chmod(folder.path().c_str(), 0555);
  constexpr uid_t kNobody = 65534;
  const auto as_nobody = [&](MapMode mode) {
    return in_a_child([&] {
      if (::geteuid() == 0 && ::setuid(kNobody) != 0) throw std::runtime_error("cannot become nobody");
      if (MapFile::open(path, mode).load().list.size() != 2) throw std::runtime_error("not read");
    });
  };
  const auto [code, says] = as_nobody(MapMode::update);
  EXPECT_EQ(code, 1);
  EXPECT_TRUE(has(says, {"room.db", "read-only"}));
  EXPECT_EQ(as_nobody(MapMode::read_only), (std::pair{0, std::string()}));
  ::chmod(folder.path().c_str(), 0755);
}

TEST(MapFile, IsRefusedToASecondWriterButNotToReaders) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "room.db";
  MapFile writer = MapFile::open(path, MapMode::update);
  Drive drive(writer);
  drive.frames(writer, 31);  // one transaction, and one uncommitted frame
  EXPECT_TRUE(has(refusal([&] { (void)MapFile::open(path, MapMode::update); }), {"room.db", "in use"}));
  const MapFile reader = MapFile::open(path, MapMode::read_only);
  ASSERT_EQ(reader.runs().size(), 1U);
  EXPECT_EQ(reader.runs()[0].state, RunState::running);
  EXPECT_EQ(reader.load().list.size(), 2U);
}

TEST(MapFile, ReportsAFullDiskAndKeepsCommittedData) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "room.db";
  {
    MapFile file = MapFile::open(path, MapMode::update);
    Drive drive(file);
    drive.frames(file, 30);
    file.end_run(RunState::done, drive.step.state.map);
  }
  const auto [code, says] = in_a_child([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlim_t most = fs::file_size(path) + 16384;
    const rlimit limit{most, most};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    MapFile file = MapFile::open(path, MapMode::update);
    Drive drive(file);
    drive.frames(file, 5000);
  });
  EXPECT_EQ(code, 1);
  EXPECT_TRUE(has(says, {"room.db", "written"}));
  EXPECT_EQ(says.find('\n'), std::string::npos) << says;
  MapFile file = MapFile::open(path, MapMode::update);
  EXPECT_TRUE(file.check().empty());
  EXPECT_GE(file.load().list.size(), 2U);
  EXPECT_EQ(file.runs().front().state, RunState::done);
}

TEST(MapFile, OfANewerCairnIsRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "room.db";
  (void)MapFile::open(path, MapMode::update);
  std::string bytes = support::bytes_of(path);
  bytes[63] = 2;  // user_version, big endian, at 60
  (void)folder.with("room.db", bytes);
  for (const MapMode mode : {MapMode::read_only, MapMode::update})
    EXPECT_TRUE(has(refusal([&] { (void)MapFile::open(path, mode); }), {"room.db", "newer", "schema 2"}));
  EXPECT_EQ(support::bytes_of(path), bytes);
}

TEST(MapFile, IsRefusedAndUnchangedIfItIsNotAMap) {
  const TemporaryFolder folder;
  const fs::path text = folder.with("notes.db",
                                    "these are my notes, long enough to be no header of a database. "
                                    "They go on for more than a hundred bytes, as a header does.");
  for (const MapMode mode : {MapMode::read_only, MapMode::update})
    EXPECT_TRUE(has(refusal([&] { (void)MapFile::open(text, mode); }), {"notes.db", "not an SQLite file"}));
  const fs::path path = folder.path() / "room.db";
  (void)MapFile::open(path, MapMode::update);
  std::string bytes = support::bytes_of(path);
  bytes[71] = 0;  // application_id, at 68
  (void)folder.with("room.db", bytes);
  EXPECT_TRUE(has(refusal([&] { (void)MapFile::open(path, MapMode::update); }), {"another program"}));
}

TEST(MapFile, IsConsistentAfterAKillAndTheRunIsMarkedAborted) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "room.db";
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    MapFile file = MapFile::open(path, MapMode::update);
    Drive drive(file);
    drive.frames(file, 75);
    (void)!::write(ends[1], "x", 1);
    for (;;) drive.frames(file, 100);
  }
  char mark = 0;
  ASSERT_EQ(::read(ends[0], &mark, 1), 1);
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));

  MapFile file = MapFile::open(path, MapMode::update);
  EXPECT_TRUE(file.check().empty());
  const auto runs = file.runs();
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_EQ(runs[0].state, RunState::aborted);
  EXPECT_GE(runs[0].frames, 60);
  EXPECT_EQ(file.load().list.size(), 2U);
  Drive drive(file);
  EXPECT_EQ(drive.step.state.run, 2);
}

TEST(MapFile, OfAnotherRigIsRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "room.db";
  (void)MapFile::open(path, MapMode::update, kRig);
  StereoRig wide = kRig;
  wide.baseline_m = 0.2F;
  for (const MapMode mode : {MapMode::read_only, MapMode::update})
    EXPECT_TRUE(has(refusal([&] { (void)MapFile::open(path, mode, wide); }), {"another rig", "0.12", "0.2"}));
  StereoRig twice = kRig;  // the same cameras at double resolution
  twice.focal_px *= 2;
  (void)MapFile::open(path, MapMode::update, twice);
}

/// A map with a whole run of eight frames.
void write_run(const fs::path& path) {
  MapFile file = MapFile::open(path, MapMode::update, kRig);
  Drive drive(file);
  drive.frames(file, 8);
  file.end_run(RunState::done, drive.step.state.map);
}

TEST(MapFile, SurvivesDamage) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "room.db";
  write_run(path);
  const std::string bytes = support::bytes_of(path);
  constexpr std::size_t kStep = 97;
  support::survives_damage(
      folder, "damaged.db", bytes,
      [](const fs::path& damaged) {
        const MapFile file = MapFile::open(damaged, MapMode::read_only);
        (void)file.load();
        (void)file.runs();
        (void)file.poses();
        (void)file.observations();
        (void)file.events();
      },
      kStep);
}

TEST(MapFile, RefusesNumbersOutOfRange) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "room.db";
  write_run(path);
  for (const auto& [change, word] :
       {std::pair{"INSERT INTO floor VALUES(4294967297, 0, 1)", "floor.x is 4294967297"},
        {"UPDATE landmark SET widest=1e6", "landmark.widest is 1000000"},
        {"UPDATE meta SET value='9223372036854775807' WHERE key='next_landmark'", "expected an id of"}}) {
    fs::copy_file(path, folder.path() / "wrong.db", fs::copy_options::overwrite_existing);
    SQLite::Database((folder.path() / "wrong.db").string(), SQLite::OPEN_READWRITE).exec(change);
    const MapFile wrong = MapFile::open(folder.path() / "wrong.db", MapMode::read_only);
    EXPECT_TRUE(has(refusal([&] { (void)wrong.load(); }), {word})) << change;
    EXPECT_FALSE(wrong.check().empty()) << change;
  }
}

TEST(MapFile, DeletesALandmarkWithAllItsRecords) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "room.db";
  MapFile file = MapFile::open(path, MapMode::update);
  Drive drive(file);
  drive.frames(file, 20);
  file.end_run(RunState::done, drive.step.state.map);
  file.replace(forget(file.load(), LandmarkId{2}));
  EXPECT_EQ(file.load().list.size(), 1U);
  EXPECT_TRUE(file.events().empty());
  EXPECT_EQ(file.load().next, 3);  // ids are never reused
  file.replace(forget(file.load(), LandmarkId{1}));
  EXPECT_TRUE(file.observations().empty());
  EXPECT_TRUE(file.check().empty());
  EXPECT_TRUE(has(refusal([&] { (void)forget(file.load(), LandmarkId{9}); }), {"no landmark 9"}));
}

}  // namespace
}  // namespace cairn
