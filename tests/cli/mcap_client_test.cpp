// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <sys/wait.h>

#include <gtest/gtest.h>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "support/recordings.hpp"
#include "support/temporary_folder.hpp"

/// Independent programs read our recordings: npm's @mcap/core the file, @foxglove/rosmsg2-serialization the
/// messages, with the definitions published by ROS.
namespace cairn {
namespace {

using Json = nlohmann::json;

struct Client {
  int code = -1;
  std::string out;
};
Client client(const std::filesystem::path& file) {
  const std::string command =
      "node '" + std::string(CAIRN_SOURCE_DIR) + "/tests/cli/mcap_client.mjs' '" + file.string() + "' 2>&1";
  Client result;
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return result;
  std::array<char, 4096> piece{};
  while (const std::size_t got = std::fread(piece.data(), 1, piece.size(), pipe))
    result.out.append(piece.data(), got);
  const int status = ::pclose(pipe);
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

TEST(McapClient, ThirdPartyProgramsReadOurRecordings) {
  const support::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "all.mcap";
  constexpr Size kSize{6, 2};
  const StereoRig rig{500.5F, 320.25F, 240, 0.125F, 2};
  const Stamp stamp{12'345'678'901'234};
  const ros::Header header = ros::header_of(stamp, "camera");
  {
    recordings::CameraFile file(path, {.chunk_bytes = 2000, .sync = false});
    file.file().metadata("cairn", {{"preset", "default"}});
    file.file().attachment("calib.txt", "text/plain", "fx=500.5\n");
    const auto add = [&](const char* topic, const auto& message) {
      const auto channel = file.topic<std::remove_cvref_t<decltype(message)>>(topic);
      for (int i = 0; i < 3; ++i) file.add(channel, {stamp.ns + i}, message);
    };
    ros::Image image;
    image.header = header;
    image.width = 6;
    image.height = 2;
    image.encoding = "mono8";
    image.step = 6;
    image.data = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 250, 255};
    add("/image", image);
    add("/compressed", ros::CompressedImage{header, "jpeg", {255, 216, 1}});
    add("/info", ros::camera_info_of(header, rig, kSize, ros::Side::right));
    Frame frame;
    frame.disparity.disparity_px = cairn::Image<float>(kSize, 7.5F, {});
    add("/disparity", ros::disparity_image_of(header, frame, rig, {}));
    frame.space = cairn::Image<ObstacleLabel>(kSize, ObstacleLabel::floor, {});
    frame.objects.labels = cairn::Image<ObjectId>(kSize, ObjectId{3}, {});
    const cairn::Image<Gray> grey(kSize, 77, {});
    add("/cloud", ros::cloud_of(header, frame, ObstacleLabel::floor, rig, grey, {}));
    ros::OccupancyGrid grid;
    grid.header = header;
    grid.info.resolution = 0.5F;
    grid.info.width = 3;
    grid.info.height = 1;
    grid.info.origin.position = {1.5, -2.5, 0};
    grid.data = {-1, 0, 100};
    add("/grid", grid);
    ros::TFMessage transforms;
    transforms.transforms.push_back({header, "floor", {{1, 2, 3}, {0, 0.6, 0, 0.8}}});
    add("/tf", transforms);
    add("/text", ros::String{"wörter"});
    ros::Detection3D found;
    found.header = header;
    found.id = "7";
    found.bbox.center.position = {0.5, 0.25, 2};
    found.bbox.size = {1, 2, 3};
    found.results.emplace_back().hypothesis = {"object", 0.75};
    found.results.back().pose.covariance[35] = 9;
    ros::Detection3DArray detections;
    detections.header = header;
    detections.detections = {found, found};
    add("/objects", detections);
    file.file().close();
  }
  const Client result = client(path);
  if (result.code == 77 || result.code == 127) GTEST_SKIP() << result.out;
  ASSERT_EQ(result.code, 0) << result.out;
  const Json all = Json::parse(result.out);
  EXPECT_EQ(all["profile"], "ros2");
  EXPECT_EQ(all["messages"], 27);
  EXPECT_GT(all["chunks"], 2);
  EXPECT_EQ(all["attachments"]["calib.txt"], "fx=500.5\n");
  EXPECT_EQ(all["metadata"]["cairn"]["preset"], "default");
  const auto first = [&](const char* topic) { return all["topics"][topic]["first"]; };
  for (const char* topic :
       {"/image", "/compressed", "/info", "/disparity", "/cloud", "/grid", "/tf", "/text"}) {
    EXPECT_EQ(all["topics"][topic]["count"], 3) << topic;
    EXPECT_EQ(all["topics"][topic]["official"], true) << topic;
    if (first(topic).contains("header")) {
      EXPECT_EQ(first(topic)["header"]["stamp"]["sec"], 12345) << topic;
      EXPECT_EQ(first(topic)["header"]["frame_id"], "camera") << topic;
    }
  }
  EXPECT_EQ(first("/image")["data"], Json({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 250, 255}));
  EXPECT_EQ(first("/image")["encoding"], "mono8");
  EXPECT_EQ(first("/compressed")["data"], Json({255, 216, 1}));
  EXPECT_EQ(first("/info")["p"], Json({500.5, 0, 322.25, -62.5625, 0, 500.5, 240, 0, 0, 0, 1, 0}));
  EXPECT_EQ(first("/info")["distortion_model"], "plumb_bob");
  EXPECT_EQ(first("/disparity")["f"], 500.5);
  EXPECT_EQ(first("/disparity")["t"], 0.125);
  EXPECT_EQ(first("/disparity")["min_disparity"], 2);
  EXPECT_EQ(first("/disparity")["delta_d"], 0.0625);
  EXPECT_EQ(first("/disparity")["valid_window"]["width"], 6);
  EXPECT_EQ(first("/disparity")["image"]["data"][3], 65);  // 9.5 is 0x41180000
  EXPECT_EQ(first("/cloud")["width"], 12);
  EXPECT_EQ(first("/cloud")["fields"][4]["name"], "object");
  EXPECT_EQ(first("/cloud")["fields"][4]["offset"], 16);
  EXPECT_EQ(first("/cloud")["is_dense"], true);
  EXPECT_EQ(first("/grid")["data"], Json({-1, 0, 100}));
  EXPECT_EQ(first("/grid")["info"]["origin"]["position"]["y"], -2.5);
  EXPECT_EQ(first("/tf")["transforms"][0]["child_frame_id"], "floor");
  EXPECT_EQ(first("/tf")["transforms"][0]["transform"]["rotation"]["y"], 0.6);
  EXPECT_EQ(first("/text")["data"], "wörter");
  // The packages have no definition of vision_msgs: read by the file's own.
  EXPECT_EQ(first("/objects")["detections"][1]["id"], "7");
  EXPECT_EQ(first("/objects")["detections"][1]["results"][0]["hypothesis"]["score"], 0.75);
  EXPECT_EQ(first("/objects")["detections"][1]["results"][0]["pose"]["covariance"][35], 9);
  EXPECT_EQ(first("/objects")["detections"][0]["bbox"]["size"]["z"], 3);
}

}  // namespace
}  // namespace cairn
