// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/map_file.hpp>
#include <nlohmann/json.hpp>

#include "command.hpp"

/// cairn map, on files that the test writes.
namespace cairn::command {
namespace {

using Json = nlohmann::json;

class MapCommand : public CommandTest {
 protected:
  /// Five landmarks of different colours, the frame turned and shifted by `map_from_first`; a run with two
  /// keyframes.
  void write_map(const std::string& name, const Pose& map_from_first = {}, std::size_t first_colour = 0) {
    MapFile file = MapFile::open(at(name), MapMode::update, StereoRig{200, 160, 120, 0.12F, 0});
    LandmarkFrame frame;
    Tracks tracks;
    LandmarkUpdate step;
    step.state = begin_landmarks(file.load(), file.begin_run("frames/", {0}));
    const std::array places{Point3{0, 0, 0.2}, Point3{2, 0, 0.2}, Point3{0, 3, 0.3}, Point3{3, 3, 0.3},
                            Point3{-1, 2, 0.2}};
    for (std::size_t i = 0; i < places.size(); ++i) {
      Landmark l;
      l.id = LandmarkId{step.state.map.next++};
      l.position_m = map_from_first(places[i]);
      l.covariance_m2 = {0.0025, 0, 0, 0, 0.0025, 0, 0, 0, 0.0025};
      l.size = {0.3, 0.4, 0.5};
      l.log_odds = 5;
      l.seen = 20;
      LandmarkLook look;
      look.colours[i % 8] = 1;
      look.colours[8 + 5 * i + first_colour] = 1;
      look.pixels = 500;
      l.looks.push_back(look);
      step.state.map.list.push_back(l);
      Track track;
      track.id = TrackId{number(l.id)};
      track.object = ObjectId{static_cast<std::int32_t>(i) + 1};
      track.position_m = l.position_m;
      track.covariance_m2 = l.covariance_m2;
      tracks.list.push_back(track);
      step.tracks.push_back({track.id, l.id, LandmarkRefusal::none, false, 0});
    }
    step.events.push_back(
        {LandmarkEventKind::moved, {0}, LandmarkId{2}, {2, 0, 0.2}, {1, 0, 0}, 0.9, {1, 2}});
    frame.tracks = &tracks;
    frame.is_keyframe = true;
    file.write(frame, step);
    step.events.clear();
    frame.stamp = {500'000'000};
    frame.odom_from_camera.translation_m.x = 0.5;
    file.write(frame, step);
    file.end_run(RunState::done, step.state.map);
  }
};

TEST_F(MapCommand, ShowsAndChecksAMap) {
  write_map("room.db");
  const Outcome shown = run({"map", "show", "room.db"});
  EXPECT_EQ(shown.code, 0) << shown.err;
  for (const char* words : {"5 landmarks", "baseline 0.12 m", "done", "frames/", "moved", "1.00"})
    EXPECT_NE(shown.out.find(words), std::string::npos) << words << "\n" << shown.out;
  const Outcome checked = run({"map", "check", "room.db"});
  EXPECT_EQ(checked.code, 0);
  EXPECT_EQ(checked.out, "room.db: valid, 5 landmarks, 1 run\n");
}

TEST_F(MapCommand, FindsDamage) {
  write_map("room.db");
  std::string bytes = content(at("room.db"));
  const std::size_t blob = bytes.find("frames/");
  ASSERT_NE(blob, std::string::npos);
  bytes.replace(bytes.find("present"), 7, "absentt");
  write(at("room.db"), bytes);
  const Outcome checked = run({"map", "check", "room.db"});
  EXPECT_EQ(checked.code, 1);
  EXPECT_NE(checked.out.find("absentt"), std::string::npos) << checked.out;
  refuses({"map", "show", "room.db"}, {"room.db", "absentt"});
}

TEST_F(MapCommand, ExportsInFourFormats) {
  write_map("room.db");
  const Json geo = Json::parse(run({"map", "export", "room.db"}).out);
  EXPECT_EQ(geo["type"], "FeatureCollection");
  EXPECT_EQ(geo["frame_id"], "map");
  EXPECT_EQ(geo["units"], "m");
  ASSERT_EQ(geo["features"].size(), 6U);
  const Json& first = geo["features"][0];
  EXPECT_EQ(first["geometry"]["type"], "Polygon");
  const Json& ring = first["geometry"]["coordinates"][0];
  EXPECT_EQ(ring.front(), ring.back());
  EXPECT_LE(ring.size(), 17U);
  EXPECT_NEAR(ring[0][0].get<double>(), 0.175, 1e-9);
  EXPECT_EQ(geo["features"][5]["geometry"]["type"], "LineString");

  const Outcome g2o = run({"map", "export", "room.db", "--form", "g2o"});
  for (const char* line :
       {"\nVERTEX_SE3:QUAT 1 0.500000 0.000000 0.000000 0.000000000", "\nVERTEX_TRACKXYZ 1000002 2.000000",
        "\nEDGE_SE3:QUAT 0 1 0.500000", "\nEDGE_SE3_TRACKXYZ 1 1000002 0 1.500000 0.000000"})
    EXPECT_NE(g2o.out.find(line), std::string::npos) << line << g2o.out;
  EXPECT_EQ(std::count(g2o.out.begin(), g2o.out.end(), '\n'), 1 + 2 + 1 + 5 + 1 + 10);

  const Outcome tum = run({"map", "export", "room.db", "--form", "tum", "-o", "path.tum"});
  EXPECT_EQ(tum.out, "");
  EXPECT_NE(content(at("path.tum")).find("\n0.500000000 0.500000 0.000000 0.000000 "), std::string::npos);
  const Outcome csv = run({"map", "export", "room.db", "--form", "csv"});
  EXPECT_EQ(std::count(csv.out.begin(), csv.out.end(), '\n'), 6);
  EXPECT_NE(csv.out.find("\n3,,present,0.0000,3.0000,0.3000,0.0500,"), std::string::npos) << csv.out;
}

TEST_F(MapCommand, ComparesAndMergesMapsWithDifferentOrigins) {
  Pose elsewhere = rotation_about({0, 0, 2});
  elsewhere.translation_m = {5, 1, 0};
  write_map("room.db");
  write_map("other.db", elsewhere);
  EXPECT_EQ(run({"map", "diff", "room.db", "other.db"}).out, "no change\n");
  const Outcome merged = run({"map", "merge", "room.db", "other.db", "-o", "both.db"});
  EXPECT_EQ(merged.code, 0) << merged.err;
  EXPECT_EQ(merged.out,
            "both.db: 5 landmarks\nother.db: at x 1.17 m, y 4.96 m, -114.6 degrees; 5 common landmarks\n");
  EXPECT_EQ(run({"map", "check", "both.db"}).code, 0);
  EXPECT_FALSE(fs::exists(at("both.db.part")));
  refuses({"map", "merge", "room.db", "other.db", "-o", "both.db"}, {"both.db", "already exists"});
  write_map("strange.db", {}, 2);
  refuses({"map", "merge", "room.db", "strange.db", "-o", "all.db"}, {"strange.db", "too_few_pairs"});
}

TEST_F(MapCommand, MergesSeveralMapsWhereTheyMatchOrAreSaidToBe) {
  Pose elsewhere = rotation_about({0, 0, 2});
  elsewhere.translation_m = {5, 1, 0};
  write_map("a.db");
  write_map("b.db", elsewhere);
  write_map("c.db", elsewhere, 2);  // other colours
  refuses({"map", "merge", "a.db", "b.db", "c.db", "-o", "all.db"}, {"c.db", "too_few_pairs", "--at"});
  EXPECT_FALSE(fs::exists(at("all.db")));
  const Outcome merged =
      run({"map", "merge", "a.db", "--at", "c=20,-3.5,90", "c.db", "b.db", "-o", "all.db"});
  EXPECT_EQ(merged.code, 0) << merged.err;
  EXPECT_NE(merged.out.find("all.db: 10 landmarks\nc.db: at x 20.00 m, y -3.50 m, 90.0 degrees; 0 common"),
            std::string::npos)
      << merged.out;
  refuses({"map", "merge", "a.db", "b.db", "-o", "x.db", "--at", "d=1,2,3"},
          {"d=1,2,3", "0 maps", "expected 1"});
  refuses({"map", "merge", "a.db", "b.db", "-o", "x.db", "--at", "b=1,2,3", "--at", "b=1,2,4"},
          {"b=1,2,4", "second"});
  fs::copy_file(at("b.db"), at("b2.db"));
  refuses({"map", "merge", "a.db", "b.db", "b2.db", "-o", "x.db"}, {"b2.db", "copy of", "b.db", "twice"});
  fs::copy_file(at("a.db"), at("a2.db"));
  refuses({"map", "merge", "a.db", "a2.db", "-o", "x.db", "--at", "a2=0,0,0"}, {"a2.db", "copy of", "a.db"});
  for (const char* place : {"b", "b=", "b=1,2", "b=1,2,3,4", "b=1,2,nan", "b=1e9,0,0"})
    refuses({"map", "merge", "a.db", "b.db", "-o", "x.db", "--at", place}, {"--at", place, "NAME=X,Y,DEG"});
  refuses({"map", "diff", "a.db", "b.db", "c.db"}, {"3 maps", "expected 2"});
  refuses({"map", "show", "a.db", "--at", "b=1,2,3"}, {"--at", "map merge"});
}

TEST_F(MapCommand, MergesACopyWithoutCountingItTwice) {
  write_map("room.db");
  fs::copy_file(at("room.db"), at("copy.db"));
  const Outcome merged = run({"map", "merge", "room.db", "copy.db", "-o", "both.db"});
  EXPECT_EQ(merged.out,
            "both.db: 5 landmarks\ncopy.db: at x 0.00 m, y 0.00 m, 0.0 degrees; 5 common landmarks\n")
      << merged.err;
  for (const Landmark& l : MapFile::open(at("both.db"), MapMode::read_only).load().list) {
    EXPECT_EQ(l.seen, 20);
    EXPECT_NEAR(l.covariance_m2[0], 0.0025, 1e-12);
  }
}

TEST_F(MapCommand, ComparesAMapWithAnEarlierCopyOfIt) {
  write_map("room.db");
  fs::copy_file(at("room.db"), at("before.db"));
  {
    MapFile file = MapFile::open(at("room.db"), MapMode::update);
    LandmarkMap map = file.load();
    map.list[0].position_m.x += 1;
    map.list[1].is_gone = true;
    map.list[4].id = LandmarkId{9};  // another object elsewhere
    map.list[4].position_m.y += 2;
    file.replace(map);
  }
  const Outcome outcome = run({"map", "diff", "before.db", "room.db"});
  EXPECT_EQ(outcome.code, 0);
  for (const char* words : {"moved", "1.00", "gone", "new", "not in OTHER"})
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << "\n" << outcome.out;
}

TEST_F(MapCommand, ComparesCopiesThatGaveNewObjectsTheSameId) {
  write_map("room.db");
  fs::copy_file(at("room.db"), at("copy.db"));
  const auto add = [&](const std::string& name, Point3 place, std::size_t colour) {
    MapFile file = MapFile::open(at(name), MapMode::update);
    LandmarkMap map = file.load();
    Landmark l = map.list.front();
    l.id = LandmarkId{map.next++};
    l.position_m = place;
    l.first = {1'000'000 * static_cast<std::int64_t>(colour)};
    l.looks[0].colours = {};
    l.looks[0].colours[colour % 8] = 1;
    l.looks[0].colours[8 + 5 * colour] = 1;
    map.list.push_back(l);
    file.replace(map);
  };
  add("room.db", {6, -3, 0.25}, 6);
  add("copy.db", {-6, -3, 0.25}, 7);
  const Outcome outcome = run({"map", "diff", "room.db", "copy.db"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.find("moved "), outcome.out.find("moved m")) << outcome.out;  // in the head only
  for (const char* words : {"new", "not in OTHER"})
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << "\n" << outcome.out;
}

TEST_F(MapCommand, ForgetsLandmarks) {
  write_map("room.db");
  refuses({"map", "forget", "room.db", "--id", "77"}, {"77", "no such landmark"});
  refuses({"map", "forget", "room.db"}, {"--id", "--gone"});
  EXPECT_EQ(run({"map", "forget", "room.db", "--id", "2", "--id", "3"}).out,
            "room.db: 2 landmarks forgotten, 3 left\n");
  EXPECT_EQ(run({"map", "check", "room.db"}).out, "room.db: valid, 3 landmarks, 1 run\n");
}

TEST_F(MapCommand, RefusesFilesThatAreNotMaps) {
  refuses({"map", "show", "none.db"}, {"none.db", "no such file"});
  write(at("text.db"), std::string(300, 'x'));
  refuses({"map", "show", "text.db"}, {"text.db", "not an SQLite file"});
  refuses({"map", "forget", "text.db", "--gone"}, {"text.db"});
  refuses({"map", "dance", "text.db"}, {"dance"});
  refuses({"map", "show"}, {"FILE"});
  write_map("room.db");
  refuses({"map", "diff", "room.db"}, {"expected 2"});
  refuses({"map", "show", "room.db", "room.db"}, {"expected one map"});
  refuses({"map", "export", "room.db", "--form", "shapefile"}, {"shapefile"});
  refuses({"map", "export", "room.db", "-o", "no/such/folder/out.json"}, {"no/such/folder"});
}

}  // namespace
}  // namespace cairn::command
