// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The content of the player's data blocks, parsed as by its script. Playback is tested in a browser:
// cli/follow_page_in_browser.py.
#include <gtest/gtest.h>

#include <cairn/io/raster.hpp>
#include <cairn/output/follow_page.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/packed_map.hpp"
#include "support/temporary_folder.hpp"

namespace cairn::output {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using support::block;
using support::bytes_of;

constexpr Size kSize{41, 29};

/// Tracks 7, 300 and 70000: the first is seen in two pieces, the second is out of view, the third is one
/// object.
struct Scene {
  TrackedFrame step;
  Image<Gray> left{kSize, Gray{90}, {}};

  Scene() {
    step.index = 4;
    step.stamp = Stamp{1'700'000'000'250'000'000};
    step.motion.followed = 120;
    step.motion.inliers = 90;
    step.motion.refusal = MotionRefusal::few_inliers;
    step.map_from_camera.translation_m = {1, 2, 0.5};
    step.pose_covariance[0] = 0.25;
    step.pose_covariance[7] = 0.5;
    step.pose_covariance[14] = 0.75;
    auto& objects = step.frame.objects;
    objects.labels = Image<ObjectId>(kSize, ObjectId::none, {});
    step.ids = Image<TrackId>(kSize, TrackId::none, {});
    add({2, 3, 5, 6}, TrackId{7});
    add({10, 3, 4, 4}, TrackId{7});
    add({20, 10, 9, 8}, TrackId{70'000});
    track(TrackId{7}, ObjectId{1}).parts = {ObjectId{2}};
    track(TrackId{300}, ObjectId::none).state = TrackState::out_of_view;
    track(TrackId{70'000}, ObjectId{3}).is_moving = true;
  }

  void add(Rect box, TrackId id) {
    auto& objects = step.frame.objects;
    Object object;
    object.id = ObjectId{static_cast<std::int32_t>(objects.list.size()) + 1};
    object.box_px = box;
    for (int y = box.y; y < box.y + box.height; ++y) {
      for (int x = box.x; x < box.x + box.width; ++x) {
        objects.labels(x, y) = object.id;
        step.ids(x, y) = id;
      }
    }
    objects.list.push_back(object);
  }

  Track& track(TrackId id, ObjectId object) {
    Track added;
    added.id = id;
    added.state = TrackState::confirmed;
    added.object = object;
    added.has_place = true;
    added.position_m = {3, 0.5, 0.25};
    step.tracks.list.push_back(added);
    return step.tracks.list.back();
  }

  [[nodiscard]] EncodedFrame encoded(const std::string& name = "000004") const {
    return encode_step(step, name, left, {}, 12.345);
  }
};

FollowPageHead head(const std::string& title = "frames") {
  return {title, kSize, StereoRig{.focal_px = 200, .cx_px = 20, .cy_px = 14, .baseline_m = 0.1F}};
}

TEST(FollowPage, EachPixelHasItsTracksIndexInTheList) {
  const Scene scene;
  const EncodedFrame encoded = scene.encoded();
  const Json maps = Json::parse(encoded.maps), facts = Json::parse(encoded.facts);
  const auto slots = support::unpacked(maps.at("tracks"), static_cast<std::size_t>(kSize.area()));
  EXPECT_EQ(maps.at("tracks").at("bytes"), 1);  // however large the ids are
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const std::uint32_t slot = slots[static_cast<std::size_t>(y * kSize.width + x)];
      const std::int64_t id = slot == 0 ? 0 : facts.at("tracks").at(slot - 1).at("id").get<std::int64_t>();
      ASSERT_EQ(id, number(scene.step.ids(x, y))) << x << ", " << y;
    }
  }
}

TEST(FollowPage, TheImageIsTheLeftOne) {
  const Scene scene;
  const std::string uri = Json::parse(scene.encoded().maps).at("left");
  const std::string start = "data:image/jpeg;base64,";
  ASSERT_TRUE(uri.starts_with(start));
  const io::Raster raster = io::decode_jpeg(support::bytes_of_base64(uri.substr(start.size())));
  EXPECT_EQ(raster.size, kSize);
  EXPECT_NEAR(raster.row<std::uint8_t>(5)[5], 90, 3);
}

TEST(FollowPage, FactsEqualTheLineOfTheFileWithoutMasks) {
  const Json facts = Json::parse(Scene().encoded().facts);
  EXPECT_EQ(facts.at("frame"), 4);
  EXPECT_EQ(facts.at("stamp_ns"), 1'700'000'000'250'000'000);
  EXPECT_EQ(facts.at("motion").at("refusal"), "few_inliers");
  EXPECT_EQ(facts.at("pose").at("position_m"), Json({1, 2, 0.5}));
  EXPECT_EQ(facts.at("pose").at("covariance_m2"), Json({0.25, 0, 0, 0, 0.5, 0, 0, 0, 0.75}));
  EXPECT_DOUBLE_EQ(facts.at("ms").get<double>(), 12.35);
  ASSERT_EQ(facts.at("tracks").size(), 3U);
  for (const Json& track : facts.at("tracks")) EXPECT_FALSE(track.contains("rle"));
  EXPECT_EQ(facts.at("tracks").at(1).at("state"), "out_of_view");
  EXPECT_EQ(facts.at("tracks").at(2).at("moving"), true);
}

TEST(FollowPage, ANameIsPlacedInsideEachVisibleTrack) {
  const Scene scene;
  const Json facts = Json::parse(scene.encoded().facts);
  ASSERT_EQ(facts.at("marks").size(), 2U);
  for (const Json& mark : facts.at("marks")) {
    const std::int64_t id = facts.at("tracks").at(mark.at("id").get<std::size_t>() - 1).at("id");
    EXPECT_EQ(number(scene.step.ids(mark.at("x").get<int>(), mark.at("y").get<int>())), id);
  }
}

TEST(FollowPage, OfTwoTracksInOneObjectTheOneWithoutPixelsHasNoName) {
  Scene scene;
  scene.track(TrackId{80'000}, ObjectId{3}).is_joined = true;
  EXPECT_EQ(Json::parse(scene.encoded().facts).at("marks").size(), 2U);
}

TEST(FollowPage, ContainsTheTransformOfTheOdometryInTheMap) {
  const Scene scene;
  LandmarkUpdate marked;
  marked.state.located.map_from_odom = rotation_about({0, 0, 0.5});
  marked.state.located.map_from_odom.translation_m = {2, -1, 0};
  const auto place = [&] {
    return Json::parse(encode_step(scene.step, "", scene.left, {}, {}, marked).facts).at("map_from_odom");
  };
  EXPECT_EQ(place(), Json::parse(R"({"yaw_rad": 0.5, "position_m": [2, -1, 0]})"));
  marked.state.is_located = false;
  EXPECT_TRUE(place().is_null());
}

TEST(FollowPage, UnknownValuesAreNull) {
  Scene scene;
  scene.step.is_lost = true;
  scene.step.tracks.list[0].has_place = false;
  const Json facts = Json::parse(scene.encoded().facts);
  EXPECT_TRUE(facts.at("pose").is_null());
  EXPECT_TRUE(facts.at("tracks").at(0).at("position_m").is_null());
  EXPECT_TRUE(facts.at("tracks").at(2).at("position_m").is_array());
}

TEST(FollowPage, IsASelfContainedPage) {
  const support::TemporaryFolder folder;
  const fs::path file = folder.path() / "follow.html";
  const Scene scene;
  FollowPage page(file, head());
  page.add(scene.encoded());
  page.add_event("{\"frame\": 4, \"kind\": \"new\", \"track\": 7}\n");
  page.add(scene.encoded());
  page.add_event("{\"frame\": 4, \"kind\": \"gone\", \"landmark\": 2}\n");
  Landmark tap;
  tap.id = LandmarkId{2};
  tap.name = "tap";
  tap.is_gone = true;
  tap.position_m = {1, 2, 3};
  LandmarkMap map;
  map.list.push_back(tap);
  page.finish(map);
  const std::string html = bytes_of(file);
  EXPECT_TRUE(html.starts_with("<!doctype html>"));
  EXPECT_TRUE(html.ends_with("</html>\n"));
  EXPECT_EQ(html.find("{{"), std::string::npos);
  EXPECT_EQ(html.find("https:"), std::string::npos);
  EXPECT_EQ(html.find("http:"), html.rfind("http:"));
  EXPECT_EQ(html.find(" src=\""), std::string::npos);
  const Json run = Json::parse(block(html, "run"));
  EXPECT_EQ(run.at("frames"), 2);
  EXPECT_EQ(run.at("width"), kSize.width);
  EXPECT_EQ(run.at("rig").at("focal_px"), 200);
  EXPECT_EQ(run.at("landmarks"),
            Json::parse(R"([{"id": 2, "name": "tap", "position_m": [1, 2, 3], "gone": true}])"));
  const Json happened = Json::parse(block(html, "happened"));
  ASSERT_EQ(happened.size(), 2U);
  EXPECT_EQ(happened.at(1).at("kind"), "gone");
  EXPECT_EQ(Json::parse(block(html, "facts-1")).at("frame"), 4);
  EXPECT_TRUE(Json::parse(block(html, "maps-1")).at("left").is_string());
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator{}), 1);
}

TEST(FollowPage, AnUnfinishedPageLeavesTheOldOneAndNoTrace) {
  const support::TemporaryFolder folder;
  const fs::path file = folder.with("follow.html", "old");
  {
    FollowPage page(file, head());
    page.add(Scene().encoded());
  }
  EXPECT_EQ(bytes_of(file), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator{}), 1);
}

TEST(FollowPage, EscapesAnyName) {
  const support::TemporaryFolder folder;
  for (const std::string& name :
       {std::string("</script><script>alert(1)</script>"), std::string("<!--<script>"),
        std::string("{{style}}"), std::string("\"&'\\"), std::string("\xff\xfe not UTF-8")}) {
    FollowPage page(folder.path() / "follow.html", head(name));
    page.add(Scene().encoded(name));
    page.finish();
    const std::string html = bytes_of(folder.path() / "follow.html");
    const bool is_utf8 = name.find('\xff') == std::string::npos;
    EXPECT_TRUE(!is_utf8 || Json::parse(block(html, "facts-0")).at("name") == name) << name;
    EXPECT_TRUE(!is_utf8 || Json::parse(block(html, "run")).at("title") == name) << name;
    EXPECT_EQ(html.find("<script>alert"), std::string::npos);
    EXPECT_EQ(html.find("<!--<"), std::string::npos);
  }
}

TEST(FollowPage, WithoutARigThereIsNoneInThePage) {
  const support::TemporaryFolder folder;
  FollowPage page(folder.path() / "follow.html", {"frames", kSize, std::nullopt});
  page.finish();
  EXPECT_TRUE(Json::parse(block(bytes_of(folder.path() / "follow.html"), "run")).at("rig").is_null());
}

TEST(FollowPage, AMissingFolderIsNamed) {
  const support::TemporaryFolder folder;
  const std::string message =
      support::refusal([&] { FollowPage(folder.path() / "none" / "follow.html", head()); });
  EXPECT_NE(message.find("follow.html"), std::string::npos);
}

}  // namespace
}  // namespace cairn::output
