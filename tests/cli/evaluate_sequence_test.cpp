// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/io/rle.hpp>
#include <cairn/sequence/pose.hpp>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "command.hpp"

namespace cairn::command {
namespace {

using Json = nlohmann::json;

constexpr Size kSize{64, 48};

std::string two_digits(int k) {
  return (k < 10 ? "0" : "") + std::to_string(k);
}

Json list(Point3 p) {
  return {p.x, p.y, p.z};
}

/// The content of a frame, and the simulated result for it.
struct Seen {
  int id = 0;      // the true object; 0: none
  int track = 0;   // 0: not found
  Rect box;        // of the mask
  Point3 place_m;  // in the world
  Point3 error_m;  // of the track's place
  bool is_moving = false;
  int landmark = 0;
  std::string state = "confirmed";
};

/// A sequence with truth and result, whose map has another origin than the truth's world.
class EvaluateSequence : public CommandTest {
 protected:
  const Pose map_from_world_{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {3, -2, 0.5}};

  static Pose world_from_camera(int k) { return {{1, 0, 0, 0, 0, 1, 0, -1, 0}, {0.1 * k, -2, 0.8}}; }

  void add(int k, const std::vector<Seen>& all, bool has_truth = true, bool has_result = true) {
    const std::string name = "f" + two_digits(k);
    if (has_truth) write_truth(k, "truth/" + name, all);
    if (has_result) lines_ += result_line(k, name, all).dump() + "\n";
  }

  void write_result(const std::string& more = "") const {
    fs::create_directories(at("result"));
    write(at("result/tracks.jsonl"), lines_ + more);
  }

  [[nodiscard]] std::pair<Json, std::string> evaluated(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"evaluate",   path("result"), path("truth"),
                                   "--sequence", "--json",       path("all.json")};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return {Json::parse(content(at("all.json")), nullptr, false), outcome.out};
  }

  std::string lines_;

 private:
  void write_truth(int k, const std::string& folder, const std::vector<Seen>& all) const {
    Image<std::uint16_t> ids(kSize, 0, {});
    Json objects = Json::array();
    for (const Seen& one : all) {
      if (one.id == 0) continue;
      for (int y = one.box.y; y < one.box.y + one.box.height; ++y)
        std::fill_n(ids.row(y) + one.box.x, one.box.width, static_cast<std::uint16_t>(one.id));
      objects.push_back({{"id", one.id},
                         {"centroid_visible_cam", list(inverse(world_from_camera(k))(one.place_m))},
                         {"centroid_world", list(one.place_m)}});
    }
    fs::create_directories(at(folder));
    io::save_png(at(folder + "/objects.png"), ids.view());
    write(at(folder + "/scene.json"), Json{{"objects", objects}}.dump());
    const Pose pose = world_from_camera(k);
    std::string rows;
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 3; ++column)
        rows += std::to_string(pose.rotation[3 * row + column]) + " ";
      rows += std::to_string(row == 0   ? pose.translation_m.x
                             : row == 1 ? pose.translation_m.y
                                        : pose.translation_m.z);
      rows += "\n";
    }
    write(at(folder + "/pose.txt"), rows + "0 0 0 1\n");
  }

  [[nodiscard]] Json result_line(int k, const std::string& name, const std::vector<Seen>& all) const {
    Json tracks = Json::array();
    for (const Seen& one : all) {
      if (one.track == 0) continue;
      Image<ObjectId> mask(kSize, ObjectId::none, {});
      for (int y = one.box.y; y < one.box.y + one.box.height; ++y)
        std::fill_n(mask.row(y) + one.box.x, one.box.width, ObjectId{1});
      const io::Rle rle = io::encode_rle(mask, ObjectId{1}, one.box);
      Json track{{"id", one.track},
                 {"state", one.state},
                 {"moving", one.is_moving},
                 {"object", 1},
                 {"position_m", list(map_from_world_(one.place_m + one.error_m))},
                 {"covariance_m2", {0.0025, 0, 0, 0, 0.0025, 0, 0, 0, 0.0025}},
                 {"rle", {{"size", {rle.size.height, rle.size.width}}, {"counts", rle.counts}}}};
      if (one.landmark != 0) track["landmark"] = one.landmark;
      tracks.push_back(track);
    }
    const Pose pose = map_from_world_ * world_from_camera(k);
    return {{"frame", k},
            {"name", name},
            {"stamp_ns", 100'000'000 * std::int64_t{k}},
            {"pose", {{"position_m", list(pose.translation_m)}, {"quaternion_xyzw", quaternion(pose)}}},
            {"tracks", tracks}};
  }
};

/// Twelve frames. Object 1 is static and changes its id in the sixth; object 2 moves from frame 3 on, is not
/// found in frame 4, and is labelled from frame 6 on; object 3 is too small to count.
class DrawnSequence : public EvaluateSequence {
 protected:
  void SetUp() override {
    for (int k = 0; k < 12; ++k) {
      const double way = 0.05 * std::max(0, k - 2);
      add(k, {{1, k < 6 ? 1 : 7, {2, 2, 20, 15}, {1, 2, 0.3}, {0.2, 0, 0}, k == 2, 0, "confirmed"},
              {2, k == 4 ? 0 : 2, {30, 10, 16, 16}, {2 + way, 2, 0.3}, {}, k >= 6, 0, "confirmed"},
              {3, 5, {50, 40, 5, 5}, {3, 2, 0.1}, {}, false, 0, "confirmed"}});
    }
    add(12, {{1, 0, {2, 2, 20, 15}, {1, 2, 0.3}, {}, false, 0, ""}}, true, false);
    add(13, {}, false, true);
    write_result(R"({"frame": 14, "na)");
  }
};

TEST_F(DrawnSequence, TracksAndOracleIdsAreScored) {
  const auto [json, text] = evaluated();
  const Json& ours = json.at("summary").at("tracks");
  const Json& oracle = json.at("summary").at("oracle_ids");
  EXPECT_EQ(json.at("summary").at("frames"), 12);
  EXPECT_EQ(ours.at("CLR_TP"), 23);
  EXPECT_EQ(ours.at("CLR_FN"), 1);
  EXPECT_EQ(ours.at("CLR_FP"), 0);  // the small one is ignored
  EXPECT_EQ(ours.at("IDSW"), 1);
  EXPECT_EQ(ours.at("Frag"), 1);
  EXPECT_EQ(ours.at("MT"), 2);
  EXPECT_NEAR(ours.at("MOTA"), 22.0 / 24, 1e-9);
  EXPECT_NEAR(ours.at("DetA"), 23.0 / 24, 1e-9);
  const double association = (3 + 3 + 121.0 / 12) / 23;
  EXPECT_NEAR(ours.at("AssA"), association, 1e-9);
  EXPECT_NEAR(ours.at("HOTA"), std::sqrt(association * 23 / 24), 1e-9);
  EXPECT_EQ(ours.at("IDTP"), 17);
  EXPECT_EQ(oracle.at("IDSW"), 0);
  EXPECT_NEAR(oracle.at("AssA"), (12 + 121.0 / 12) / 23, 1e-9);
  EXPECT_NE(text.find("oracle ids"), std::string::npos);
  EXPECT_NE(text.find("switches                1           0"), std::string::npos) << text;
}

TEST_F(DrawnSequence, ObjectsPositionsAndMotionAreScored) {
  const auto [json, text] = evaluated();
  const Json& all = json.at("summary");
  EXPECT_EQ(all.at("objects").at("scored"), 24);
  EXPECT_EQ(all.at("objects").at("found_75"), 23);
  EXPECT_NEAR(all.at("objects").at("mean_error"), 2.0 / 24, 1e-9);
  EXPECT_EQ(all.at("steadiness").at("found_again"), 1);
  EXPECT_NEAR(all.at("steadiness").at("mean_iou_difference"), 2.0 / 22, 1e-9);
  const Json& places = all.at("positions");
  EXPECT_EQ(places.at("in_map").at("compared"), 23);
  EXPECT_NEAR(places.at("in_map").at("median_m"), 0.2, 1e-6);  // 12 of 23
  EXPECT_NEAR(places.at("in_camera").at("p95_m"), 0.2, 1e-6);
  EXPECT_NEAR(places.at("inside_95"), 11.0 / 23, 1e-9);  // 0.2 m are 4 σ
  EXPECT_NEAR(places.at("median_nees"), 16, 1e-3);
  const Json& moving = all.at("moving");
  EXPECT_EQ(moving.at("frames_to_detect"), (Json{{"2", 3}}));
  EXPECT_EQ(moving.at("moving"), 8);
  EXPECT_EQ(moving.at("moving_labelled"), 6);
  EXPECT_EQ(moving.at("at_rest"), 15);
  EXPECT_EQ(moving.at("at_rest_labelled"), 1);
  EXPECT_TRUE(all.at("landmarks").is_null());
  EXPECT_TRUE(all.at("changes").is_null());
  EXPECT_NEAR(all.at("trajectory").at("path_m"), 1.1, 1e-6);
  EXPECT_NEAR(all.at("trajectory").at("ate_rmse_m"), 0, 1e-6);
}

TEST_F(DrawnSequence, UncomparableFramesAreNamed) {
  const auto [json, text] = evaluated();
  EXPECT_EQ(json.at("without_result"), (Json{"f12"}));
  EXPECT_EQ(json.at("without_truth"), (Json{"f13"}));
  EXPECT_EQ(json.at("cut_off"), true);
  for (const char* words :
       {"cut off ", "1 frame of the truth, first f12", "1 frame of the result, first f13"})
    EXPECT_NE(text.find(words), std::string::npos) << text;
}

TEST_F(DrawnSequence, RunsAreComparedInATable) {
  const Outcome outcome =
      run({"evaluate", "result", "result/tracks.jsonl", "truth", "--sequence", "--csv", "runs.csv"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const std::string csv = content(at("runs.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
  EXPECT_TRUE(csv.starts_with("run,frames,tracks.HOTA,")) << csv;
  EXPECT_NE(csv.find("\nresult,12,0."), std::string::npos) << csv;
}

TEST_F(DrawnSequence, RefusesFoldersThatAreNotSequences) {
  refuses({"evaluate", "truth", "truth", "--sequence"}, {"truth: has no tracks.jsonl"});
  refuses({"evaluate", "nowhere", "truth", "--sequence"}, {"nowhere: no such file or folder"});
  refuses({"evaluate", "result", "result", "--sequence"}, {"no sub-folder with objects.png"});
  refuses({"evaluate", "result", "truth", "--tentative"}, {"--tentative", "--sequence"});
  refuses({"evaluate", "result", "truth", "--sequence", "--html", "page"}, {"--html page"});
  write(at("result/tracks.jsonl"), R"({"frame": 0, "name": "x", "stamp_ns": 0, "tracks": []})");
  refuses({"evaluate", "result", "truth", "--sequence"}, {"first frame is x", "truth f00"});
}

TEST_F(EvaluateSequence, TentativeTracksCountOnRequest) {
  add(0, {{1, 1, {2, 2, 20, 15}, {1, 2, 0.3}, {}, false, 0, "tentative"}});
  write_result();
  EXPECT_EQ(evaluated().first.at("summary").at("tracks").at("CLR_TP"), 0);
  EXPECT_EQ(evaluated({"--tentative"}).first.at("summary").at("tracks").at("CLR_TP"), 1);
}

TEST_F(EvaluateSequence, UnlabelledObjectsOfAPartialTruthAreNotErrors) {
  add(0, {{1, 1, {2, 2, 20, 15}, {1, 2, 0.3}, {}, false, 0, "confirmed"},
          {0, 2, {30, 10, 16, 16}, {2, 2, 0.3}, {}, false, 0, "confirmed"}});
  write_result();
  EXPECT_EQ(evaluated().first.at("summary").at("tracks").at("CLR_FP"), 1);
  write(at("truth/f00/partial"), "");
  const auto [json, text] = evaluated();
  EXPECT_EQ(json.at("summary").at("tracks").at("CLR_FP"), 0);
  EXPECT_TRUE(json.at("summary").at("objects").at("precision_50").is_null());
}

/// Objects 1 and 2 are out of view for 11 frames and come back; object 3 does not. 1 is recognised, 2 is
/// mistaken for 3, and 1 was moved by a metre meanwhile.
TEST_F(EvaluateSequence, LandmarksAndChangesAreScored) {
  for (int k = 0; k < 34; ++k) {
    const bool back = k >= 22;
    std::vector<Seen> all;
    if (k <= 10 || back) {
      all = {{1, back ? 9 : 1, {2, 2, 20, 15}, {1, back ? 3.0 : 2.0, 0.3}, {}, false, 4, "confirmed"},
             {2, back ? 10 : 2, {30, 10, 16, 16}, {2, 2, 0.3}, {}, false, back ? 6 : 5, "confirmed"}};
      if (!back) all.push_back({3, 3, {30, 28, 16, 16}, {3, 2, 0.3}, {}, false, 6, "confirmed"});
    }
    add(k, all);
  }
  write_result();
  write(at("truth/events.json"), R"({"events": [
    {"id": 1, "what": "carried away while out of view", "first_frame": 15, "last_frame": 16,
     "from_xy": [1, 2], "to_xy": [1, 3]}]})");
  // The map's y is the world's x, its −x the world's y.
  write(
      at("result/events.jsonl"),
      R"({"frame": 24, "kind": "moved", "landmark": 4, "track": 9, "from_m": [0, 0, 0], "to_m": [-1.1, 0, 0]})"
      "\n"
      R"({"frame": 25, "kind": "back", "landmark": 5})"
      "\n"
      R"({"frame": 26, "kind": "gone", "track": 10})"
      "\n");
  const auto [json, text] = evaluated();
  const Json& landmarks = json.at("summary").at("landmarks");
  EXPECT_EQ(landmarks.at("in_view_again"), 2);
  EXPECT_EQ(landmarks.at("re_identified"), 1);
  EXPECT_EQ(landmarks.at("wrong"), 1);
  // By its landmark, 1 keeps its id, and 2 has that of 3.
  EXPECT_EQ(json.at("summary").at("tracks").at("IDSW"), 2);
  const Json& known = json.at("summary").at("by_landmark");
  EXPECT_EQ(known.at("IDSW"), 1);
  EXPECT_EQ(known.at("IDTP"), 23 + 11 + 11);
  EXPECT_NE(text.find("by landmark"), std::string::npos) << text;
  const Json& changes = json.at("summary").at("changes");
  EXPECT_EQ(changes.at("expected"), 1);
  EXPECT_EQ(changes.at("found"), 1);
  EXPECT_EQ(changes.at("reported"), 2);
  EXPECT_EQ(changes.at("wrong"), 1);
  EXPECT_NEAR(changes.at("median_error_m"), 0.1, 1e-6);
}

TEST_F(EvaluateSequence, ATrackGetsTheIdOfItsLastLandmarkUnlessBothAreInView) {
  for (int k = 0; k < 12; ++k) {
    const bool late = k >= 6;
    add(k, {{1, late ? 4 : 1, {2, 2, 20, 15}, {1, 2, 0.3}, {}, false, k < 8 ? 6 : 5, "confirmed"},
            {2, 2, {30, 10, 16, 16}, {2, 2, 0.3}, {}, false, 7, "confirmed"},
            {3, 3, {30, 28, 16, 16}, {3, 2, 0.3}, {}, false, 7, "confirmed"}});
  }
  write_result();
  const Json known = evaluated().first.at("summary").at("by_landmark");
  EXPECT_EQ(known.at("IDSW"), 1);
  EXPECT_EQ(known.at("IDTP"), 6 + 12 + 12);
  lines_.clear();
  for (int k = 0; k < 12; ++k)
    add(k,
        {{1, k < 6 ? 1 : 4, {2, 2, 20, 15}, {1, 2, 0.3}, {}, false, k < 6 || k >= 8 ? 5 : 6, "confirmed"}});
  write_result();
  EXPECT_EQ(evaluated().first.at("summary").at("tracks").at("IDSW"), 1);
  EXPECT_EQ(evaluated().first.at("summary").at("by_landmark").at("IDSW"), 0);
}

TEST_F(EvaluateSequence, TwoFilesOfPosesAreCompared) {
  std::string truth;
  std::string ours;
  for (int k = 0; k <= 20; ++k) {
    const std::string stamp = std::to_string(0.1 * k);
    truth += stamp + " " + std::to_string(0.1 * k) + " 0 0 0 0 0 1\n";
    ours += stamp + " " + std::to_string(0.101 * k) + " 0 0 0 0 0 1\n";
  }
  write(at("truth.tum"), truth);
  write(at("ours.tum"), ours);
  const Outcome outcome = run({"evaluate", "ours.tum", "truth.tum", "--json", "t.json"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json trajectory = Json::parse(content(at("t.json"))).at("summary").at("trajectory");
  EXPECT_EQ(trajectory.at("compared"), 21);
  EXPECT_NEAR(trajectory.at("end_drift"), 0.01, 1e-6);
  // KITTI: up to the first pose beyond one metre, per metre.
  EXPECT_NEAR(trajectory.at("t_rel"), 0.011, 1e-6);
  EXPECT_NE(outcome.out.find("t_rel 1.10 %"), std::string::npos) << outcome.out;
  write(at("late.tum"), "99 0 0 0 0 0 0 1\n100 1 0 0 0 0 0 1\n");
  refuses({"evaluate", "late.tum", "truth.tum"},
          {"late.tum: its stamps are 99.00 to 100.00 s", "0.00 to 2.00 s"});
}

TEST_F(EvaluateSequence, ATrajectoryIsComparedWithAFolderOfFrames) {
  std::string ours;
  for (int k = 0; k < 5; ++k) {
    add(k, {});
    ours += std::to_string(0.1 * k) + " " + std::to_string(-0.1 * k) + " 0 0 0 0 0 1\n";
  }
  write(at("ours.tum"), ours);
  const Outcome outcome = run({"evaluate", "ours.tum", "truth", "--json", "t.json"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json trajectory = Json::parse(content(at("t.json"))).at("summary").at("trajectory");
  EXPECT_EQ(trajectory.at("compared"), 5);
  EXPECT_NEAR(trajectory.at("path_m"), 0.4, 1e-6);
  EXPECT_NEAR(trajectory.at("ate_rmse_m"), 0, 1e-6);  // rotated, which the alignment compensates
}

TEST_F(EvaluateSequence, MotsTextIsComparedByTheNumberOfTheFrame) {
  Image<ObjectId> mask(kSize, ObjectId::none, {});
  const Rect box{2, 2, 20, 15};
  for (int y = box.y; y < box.y + box.height; ++y) std::fill_n(mask.row(y) + box.x, box.width, ObjectId{1});
  const std::string rle = " 1 48 64 " + io::encode_rle(mask, ObjectId{1}, box).counts + "\n";
  write(at("gt.mots.txt"), "0 5" + rle + "1 5" + rle + "2 5" + rle);
  write(at("ours.mots.txt"), "0 1" + rle + "1 1" + rle + "2 2" + rle);
  const Outcome outcome = run({"evaluate", "ours.mots.txt", "gt.mots.txt", "--sequence", "--json", "m.json"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json tracks = Json::parse(content(at("m.json"))).at("summary").at("tracks");
  EXPECT_EQ(tracks.at("CLR_TP"), 3);
  EXPECT_EQ(tracks.at("IDSW"), 1);
}

}  // namespace
}  // namespace cairn::command
