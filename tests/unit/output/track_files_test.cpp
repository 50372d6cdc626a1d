// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/input/true_frames.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/output/track_files.hpp>
#include <cairn/output/trajectory_files.hpp>
#include <string>
#include <support/temporary_folder.hpp>

namespace cairn::output {
namespace {

using support::has;
using support::refusal;
using support::survives_damage;
using support::TemporaryFolder;

/// 4×3 px: the two columns on the left.
const std::string kMask = R"({"size": [3, 4], "counts": "066"})";

std::string track(const std::string& more) {
  return R"({"id": 3, "state": "confirmed", "moving": true, "object": 2, "position_m": [1, 2, 3],
    "covariance_m2": [1,0,0,0,1,0,0,0,1], "confidence": 0.9)" +
         more + "}";
}

std::string flat(std::string text) {
  std::erase(text, '\n');
  return text;
}

std::string frame(int index, const std::string& tracks, const std::string& more = "") {
  const std::string number = std::to_string(index);
  return flat(R"({"frame": )" + number + R"(, "name": "00)" + number + R"(", "stamp_ns": )" +
              std::to_string(100 * index) +
              R"(, "pose": {"position_m": [0.5, 0, 1], "quaternion_xyzw": [0, 0, 0, 2], "covariance": []},
      "motion": {"refusal": "few_points"}, "tracks": [)" +
              tracks + "]" + more + "}");
}

TEST(TrackFiles, AFrameEqualsItsLine) {
  const TemporaryFolder folder;
  const TrackFile file =
      load_tracks(folder.with("tracks.jsonl", frame(0, track(R"(, "rle": )" + kMask + R"(, "landmark": 8)")) +
                                                  "\n\n" + frame(2, "") + "\n"));
  EXPECT_FALSE(file.is_cut_off);
  ASSERT_EQ(file.frames.size(), 2U);
  EXPECT_EQ(file.frames[1].line, 3U);
  EXPECT_EQ(file.frames[1].index, 2);
  EXPECT_EQ(file.frames[1].stamp.ns, 200);
  const TrackFrame& first = file.frames[0];
  EXPECT_EQ(first.name, "000");
  EXPECT_EQ(first.refusal, "few_points");
  ASSERT_TRUE(first.map_from_camera);
  EXPECT_EQ(first.map_from_camera->translation_m, (Point3{0.5, 0, 1}));
  ASSERT_EQ(first.tracks.size(), 1U);
  const TrackRecord& one = first.tracks[0];
  EXPECT_EQ(number(one.id), 3);
  EXPECT_EQ(one.state, TrackState::confirmed);
  EXPECT_TRUE(one.is_moving);
  EXPECT_EQ(one.position_m, (Point3{1, 2, 3}));
  EXPECT_EQ(one.landmark, 8);
  const Image<TrackId> labels = track_labels(first.tracks, {4, 3}, "here");
  EXPECT_EQ(number(labels(1, 2)), 3);
  EXPECT_EQ(number(labels(2, 0)), 0);
}

TEST(TrackFiles, UnknownValuesAreMissing) {
  const TemporaryFolder folder;
  const TrackFile file = load_tracks(
      folder.with("tracks.jsonl", flat(R"({"frame": 0, "name": "a", "stamp_ns": -5, "pose": null, "tracks":
 [{"id": 1, "state": "lost", "position_m": [null, 1, 2], "covariance_m2": null}]})")));
  ASSERT_EQ(file.frames.size(), 1U);
  EXPECT_FALSE(file.frames[0].map_from_camera);
  EXPECT_FALSE(file.frames[0].tracks[0].position_m);
  EXPECT_FALSE(file.frames[0].tracks[0].mask);
}

TEST(TrackFiles, ATruncatedLastLineIsIgnored) {
  const TemporaryFolder folder;
  const std::string text = frame(0, track("")) + "\n" + frame(1, track(""));
  const TrackFile whole = load_tracks(folder.with("whole.jsonl", text));  // without its newline
  EXPECT_EQ(whole.frames.size(), 2U);
  EXPECT_FALSE(whole.is_cut_off);
  const TrackFile cut = load_tracks(folder.with("cut.jsonl", text.substr(0, text.size() - 9)));
  EXPECT_EQ(cut.frames.size(), 1U);
  EXPECT_TRUE(cut.is_cut_off);
}

TEST(TrackFiles, EachRefusalNamesTheLine) {
  const TemporaryFolder folder;
  const auto says = [&](const std::string& second, std::initializer_list<std::string_view> words) {
    const auto path = folder.with("tracks.jsonl", frame(0, "") + "\n" + second + "\n");
    const std::string message = refusal([&] { load_tracks(path); });
    EXPECT_TRUE(has(message, {path.string() + ": line 2: "}));
    EXPECT_TRUE(has(message, words));
  };
  says("{", {"is not JSON"});
  says("7", {"found 7", "{…}"});
  says(std::string(1000, '['), {"nests deeper than 64"});
  says(R"({"frame": 1e999})", {"is not JSON"});
  says(R"({"frame": 2e128})", {"`frame` is 2e+128", "a whole number from 0 to"});
  says(R"({"frame": 1.5})", {"`frame` is 1.5"});
  says(R"({"frame": 18446744073709551615})", {"`frame` is 18446744073709551615"});
  says(R"({"frame": 1, "name": 7})", {"`name` is 7, expected a text"});
  says(R"({"frame": 1, "name": "001", "stamp_ns": 5})", {"`tracks` is missing, expected a list"});
  says(frame(0, ""), {"`frame` is 0, expected more than 0"});
  says(R"({"frame": 1, "name": "001", "stamp_ns": 0, "tracks": []})",
       {"`stamp_ns` is 0, expected more than 0"});
  says(R"({"frame": 1, "name": "000", "stamp_ns": 9, "tracks": []})", {"`name` is \"000\""});
  says(frame(1, track("") + "," + track("")), {"track 3 occurs twice"});
  says(frame(1, R"({"id": 0, "state": "lost"})"), {"`id` is 0, expected a whole number from 1 on"});
  says(frame(1, R"({"id": 1, "state": "asleep"})"), {"`state` is \"asleep\"", "tentative, confirmed"});
  says(frame(1, R"({"id": 1, "state": "lost", "position_m": [1, 2]})"),
       {"`position_m` is [1,2]", "3 numbers"});
  says(frame(1, R"({"id": 1, "state": "lost", "position_m": [1, 2, 1e300]})"), {"`position_m`", "within"});
  says(frame(1, R"({"id": 1, "state": "lost", "rle": {"size": [3, 1e9], "counts": ""}})"), {"`size`"});
  says(frame(1, R"({"id": 1, "state": "lost", "moving": "yes"})"),
       {"`moving` is \"yes\", expected true or false"});
}

TEST(TrackFiles, MasksMustFitAndNotOverlap) {
  const auto with_counts = [](const std::string& counts, int id) {
    TrackRecord record;
    record.id = TrackId{id};
    record.mask = io::Rle{{4, 3}, counts};
    return record;
  };
  EXPECT_TRUE(has(refusal([&] {
                    track_labels({with_counts("066", 1)}, {4, 4}, "f: frame 2");
                  }),
                  {"f: frame 2: track 1: its mask is 4x3, expected 4x4"}));
  EXPECT_TRUE(has(refusal([&] {
                    track_labels({with_counts("099", 1)}, {4, 3}, "f");
                  }),
                  {"f: track 1: run-length"}));
  EXPECT_TRUE(has(refusal([&] {
                    track_labels({with_counts("066", 1), with_counts("39", 2)}, {4, 3}, "f");
                  }),
                  {"f: track 2: its mask overlaps that of track 1"}));
}

TEST(TrackFiles, DamageIsRefusedOrRead) {
  const TemporaryFolder folder;
  const std::string text = frame(0, track(R"(, "rle": )" + kMask)) + "\n" + frame(1, track("")) + "\n";
  survives_damage(folder, "tracks.jsonl", text, [](const auto& path) {
    for (const TrackFrame& one : load_tracks(path).frames) track_labels(one.tracks, {4, 3}, "f");
  });
  survives_damage(folder, "masks.txt", "0 3 1 3 4 066\n2 3 1 3 4 066\n", [](const auto& path) {
    for (const TrackFrame& one : load_mots(path).frames) track_labels(one.tracks, {4, 3}, "f");
  });
}

TEST(MotsFiles, FramesWithoutALineAreEmptyAndClass10IsDontCare) {
  const TemporaryFolder folder;
  const TrackFile file = load_mots(folder.with("m.txt", "2 7 10 3 4 066\n0 5 1 3 4 066\n"));
  ASSERT_EQ(file.frames.size(), 3U);
  EXPECT_EQ(number(file.frames[0].tracks.at(0).id), 5);
  EXPECT_TRUE(file.frames[1].tracks.empty());
  EXPECT_TRUE(file.frames[2].tracks.at(0).is_dont_care);
  for (const char* line :
       {"0 5 1 3 4", "0 5 1 3 4 066 7", "-1 5 1 3 4 066", "0 x 1 3 4 066", "0 0 1 3 4 066",
        "0 5 1 3 99999 066", "99999999999999999999 5 1 3 4 066", "0 7 1 3 4 0\n0 7 1 3 4 0"})
    EXPECT_TRUE(has(refusal([&] { load_mots(folder.with("m.txt", line)); }), {"m.txt: line "})) << line;
}

TEST(ChangeFiles, AreReadAndMayBeMissing) {
  const TemporaryFolder folder;
  EXPECT_TRUE(load_changes(folder.path() / "events.jsonl").empty());
  const auto changes = load_changes(
      folder.with("events.jsonl",
                  R"({"frame": 7, "kind": "moved", "landmark": 2, "from_m": [0, 0, 0], "to_m": [1, 0, 0]})"
                  "\n{\"frame\": 8, \"ki"));
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].kind, "moved");
  EXPECT_EQ(changes[0].landmark, 2);
  EXPECT_EQ(changes[0].to_m, (Point3{1, 0, 0}));
  EXPECT_FALSE(changes[0].track);
}

/// A folder with one frame `000` of 4×3 px.
void write_truth(const TemporaryFolder& folder, const std::string& pose, const std::string& scene) {
  Image<std::uint8_t> ids({4, 3}, 0, {});
  ids(1, 1) = 9;
  ids(0, 0) = 255;
  std::filesystem::create_directories(folder.path() / "000");
  io::save_png(folder.path() / "000/objects.png", ids.view());
  if (!pose.empty()) (void)folder.with("000/pose.txt", pose);
  if (!scene.empty()) (void)folder.with("000/scene.json", scene);
}

TEST(TrueFrames, AFolderHasLabelsPosesAndPositions) {
  const TemporaryFolder folder;
  write_truth(folder, "# camera to world\n0 -1 0 5\n1 0 0 6\n0 0 1 7\n0 0 0 1\n",
              R"({"objects": [{"id": 9, "centroid_visible_cam": [1, 2, 3], "centroid_world": null}]})");
  (void)folder.with("events.json", R"({"events": [{"id": 9, "what": "moves in view", "first_frame": 1,
      "last_frame": 2, "from_xy": [0, 1], "to_xy": [2, 3]},
      {"id": 8, "what": "walks", "first_frame": 0, "last_frame": 2},
      {"id": 7, "what": "carried away while out of view", "first_frame": 0, "last_frame": 2}]})");
  const input::TrueSequence truth = input::load_truth(folder.path());
  ASSERT_EQ(truth.frames.size(), 1U);
  const input::TrueFrame& one = truth.frames[0];
  EXPECT_EQ(one.name, "000");
  ASSERT_TRUE(one.world_from_camera);
  EXPECT_EQ((*one.world_from_camera)({1, 0, 0}), (Point3{5, 7, 7}));
  EXPECT_EQ(one.places.at(9).visible_in_camera_m, (Point3{1, 2, 3}));
  EXPECT_FALSE(one.places.at(9).in_world_m);
  ASSERT_EQ(truth.events.size(), 3U);
  EXPECT_TRUE(truth.events[0].is_in_view);
  EXPECT_TRUE(truth.events[1].is_in_view);
  EXPECT_FALSE(truth.events[2].is_in_view);
  const Image<TruthId> labels = input::load_true_labels(one);
  EXPECT_EQ(number(labels(1, 1)), 9);
  EXPECT_EQ(labels(0, 0), TruthId::dont_care);
}

TEST(TrueFrames, MalformedInputIsRefusedByName) {
  const std::string good = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  const auto says = [&](const std::string& pose, const std::string& scene,
                        std::initializer_list<std::string_view> words) {
    const TemporaryFolder folder;
    write_truth(folder, pose, scene);
    EXPECT_TRUE(has(refusal([&] { input::load_truth(folder.path()); }), words));
  };
  says("1 2 3", "", {"pose.txt: found 3 numbers"});
  says("1 x", "", {"pose.txt:1: found 'x'"});
  says("2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "", {"pose.txt", "not a rotation"});
  says("nan 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "", {"pose.txt:1: found 'nan'"});
  says(good, "{", {"scene.json: is not JSON"});
  says(good, R"({"objects": 7})", {"scene.json: `objects` is 7, expected a list"});
  says(good, R"({"objects": [{"id": 2e128}]})", {"scene.json: `id` is 2e+128"});
  const TemporaryFolder empty;
  EXPECT_TRUE(has(refusal([&] { input::load_truth(empty.path()); }), {"no sub-folder with objects.png"}));
  EXPECT_TRUE(has(refusal([&] { input::load_truth(empty.path() / "x"); }), {"no such file or folder"}));
}

TEST(TrueFrames, MotsTextIsAccepted) {
  const TemporaryFolder folder;
  const input::TrueSequence truth =
      input::load_truth(folder.with("gt.txt", "0 5 1 3 4 066\n0 6 10 3 4 66\n"));
  EXPECT_TRUE(truth.is_numbered);
  const Image<TruthId> labels = input::load_true_labels(truth.frames.at(0));
  EXPECT_EQ(number(labels(0, 0)), 5);
  EXPECT_EQ(labels(3, 0), TruthId::dont_care);
}

TEST(TrajectoryFiles, TumAndKittiAreDistinguished) {
  const TemporaryFolder folder;
  const Trajectory tum = load_trajectory(
      folder.with("a.tum", "# t x y z qx qy qz qw\n2.5 4 5 6 0 0 1 0\n1403715273.262142976 1 2 3 0 0 0 1\n"));
  ASSERT_EQ(tum.poses.size(), 2U);
  EXPECT_EQ(tum.poses[0].stamp.ns, 2'500'000'000);
  EXPECT_EQ(tum.poses[1].stamp.ns, 1'403'715'273'262'142'976);
  EXPECT_EQ(tum.poses[1].map_from_camera.translation_m, (Point3{1, 2, 3}));
  const std::string row = "1 0 0 4 0 1 0 5 0 0 1 6\n";
  const Trajectory kitti = load_trajectory(folder.with("k.txt", row + row));
  EXPECT_EQ(kitti.poses[1].stamp.ns, 100'000'000);
  EXPECT_EQ(kitti.poses[1].map_from_camera.translation_m, (Point3{4, 5, 6}));
}

TEST(TrajectoryFiles, MalformedInputIsRefusedByName) {
  const TemporaryFolder folder;
  for (const char* text : {"# nothing\n", "0 1 2 3\n", "0 1 2 x 0 0 0 1\n", "0 1 2 inf 0 0 0 1\n",
                           "1e300 1 2 3 0 0 0 1\n", "0 1 2 3 0 0 0 0\n", "0 1 2 3 0 0 0 1\n0 1 2 3 0 0 0 1\n",
                           "0 1 2 3 0 0 0 1\n1 0 0 4 0 1 0 5 0 0 1 6\n"})
    EXPECT_TRUE(has(refusal([&] { load_trajectory(folder.with("p.tum", text)); }), {"p.tum:"})) << text;
}

}  // namespace
}  // namespace cairn::output
