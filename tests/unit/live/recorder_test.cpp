// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/core/error.hpp>
#include <cairn/input/sequence.hpp>
#include <cairn/live/recorder.hpp>
#include <map>
#include <thread>

#include "support/recordings.hpp"
#include "support/temporary_folder.hpp"

namespace cairn::live {
namespace {

namespace fs = std::filesystem;
using support::TemporaryFolder;

constexpr Size kSize{64, 48};

/// A frame without results.
std::shared_ptr<LiveFrame> frame_of(int index, std::uint64_t revision = 0) {
  auto pair = std::make_shared<input::SequenceFrame>();
  pair->name = std::to_string(index);
  pair->index = static_cast<std::size_t>(index);
  pair->stamp = {(index + 1) * 100'000'000LL};
  pair->left.gray = recordings::dots(kSize, static_cast<unsigned>(index));
  pair->right = recordings::dots(kSize, 1000U + static_cast<unsigned>(index));
  auto frame = std::make_shared<LiveFrame>();
  frame->step.index = index;
  frame->step.stamp = pair->stamp;
  frame->step.is_lost = true;
  frame->step.frame.disparity.disparity_px = Image<float>(kSize, 5.0F, {});
  frame->step.frame.disparity.reject = Image<Reject>(kSize, Reject::none, {});
  frame->step.frame.objects.labels = Image<ObjectId>(kSize, ObjectId::none, {});
  frame->step.frame.space = Image<ObstacleLabel>(kSize, ObstacleLabel::obstacle, {});
  frame->pair = pair;
  FollowConfig config;
  config.segmentation.match.num_disparities = 32 + static_cast<int>(revision);
  frame->config = std::make_shared<const FollowConfig>(config);
  frame->revision = revision;
  return frame;
}

RecordedRun some_run() {
  RecordedRun run;
  run.source = "camera";
  run.rig = StereoRig{100, 31.5F, 23.5F, 0.1F, 0};
  run.size = kSize;
  run.preset = "default";
  run.tracks = false;
  return run;
}

std::map<std::string, int> counts_of(const fs::path& path) {
  ros::McapReader reader(path);
  std::map<std::string, int> counts;
  while (const auto message = reader.next()) ++counts[reader.channels().at(message->channel).topic];
  return counts;
}

TEST(Recorder, WritesTheRequestedPartsOfEachFrame) {
  const TemporaryFolder folder;
  RecorderOptions options;
  options.what = parse_record_what("all");
  Recorder recorder(some_run(), options);
  recorder.offer(frame_of(0));  // ignored before the start
  recorder.start(folder.path() / "a.mcap");
  for (int i = 1; i < 6; ++i) recorder.offer(frame_of(i));
  recorder.finish();
  const RecorderStatus status = recorder.status();
  EXPECT_FALSE(status.is_recording);
  EXPECT_EQ(status.frames, 5U);
  EXPECT_EQ(status.bytes, fs::file_size(folder.path() / "a.mcap"));
  const auto counts = counts_of(folder.path() / "a.mcap");
  for (const char* topic :
       {"/stereo/left/image_rect", "/stereo/right/image_rect", "/stereo/left/camera_info",
        "/stereo/right/camera_info", "/cairn/objects", "/cairn/frames", "/cairn/stats", "/cairn/disparity",
        "/cairn/labels", "/cairn/reject", "/cairn/obstacles", "/cairn/floor"})
    EXPECT_EQ(counts.contains(topic) ? counts.at(topic) : 0, 5) << topic;
  const ros::McapReader reader(folder.path() / "a.mcap");
  EXPECT_NE(ros::attachment_of(reader, "config.yaml")->find("preset: default\n"), std::string::npos);
  EXPECT_NE(ros::attachment_of(reader, "calib.txt")->find("baseline=0.1\n"), std::string::npos);
  EXPECT_TRUE(recorder.summary().starts_with("recorded ")) << recorder.summary();
}

TEST(Recorder, UsesTheFrameIdOfTheSource) {
  for (const std::string camera : {"", "front_left_optical"}) {
    const TemporaryFolder folder;
    RecorderOptions options;
    options.what = parse_record_what("all");
    Recorder recorder(some_run(), options);
    const std::shared_ptr<LiveFrame> frame = frame_of(1);
    auto pair = std::make_shared<input::SequenceFrame>();
    pair->stamp = frame->pair->stamp;
    pair->left.gray = recordings::dots(kSize, 1);
    pair->right = recordings::dots(kSize, 2);
    pair->frame_id = camera;
    frame->pair = pair;
    frame->step.is_lost = false;  // then the map has a transform to the camera
    recorder.start(folder.path() / "a.mcap");
    recorder.offer(frame);
    recorder.stop();
    const std::string expected = camera.empty() ? "cairn_camera" : camera;
    ros::McapReader reader(folder.path() / "a.mcap");
    int headers = 0;
    while (const auto message = reader.next()) {
      const ros::McapChannel& channel = reader.channels().at(message->channel);
      const std::string& type = channel.type;
      std::string found;
      if (type == ros::Image::kType) {
        found = ros::decode<ros::Image>(message->bytes).header.frame_id;
      } else if (type == ros::CameraInfo::kType) {
        found = ros::decode<ros::CameraInfo>(message->bytes).header.frame_id;
      } else if (type == ros::Detection3DArray::kType) {
        found = ros::decode<ros::Detection3DArray>(message->bytes).header.frame_id;
      } else if (type == ros::DisparityImage::kType) {
        found = ros::decode<ros::DisparityImage>(message->bytes).header.frame_id;
      } else if (type == ros::PointCloud2::kType) {
        found = ros::decode<ros::PointCloud2>(message->bytes).header.frame_id;
      } else if (type == ros::TFMessage::kType) {
        found = ros::decode<ros::TFMessage>(message->bytes).transforms.at(0).child_frame_id;
      } else {
        continue;
      }
      EXPECT_EQ(found, expected) << channel.topic;
      ++headers;
    }
    EXPECT_EQ(headers, 11);  // 4 images, 2 of camera_info, 2 clouds, objects, disparity, tf
    // On replay, the camera has the name given by the source, or none if it had none.
    const auto again = input::open_sequence((folder.path() / "a.mcap").string(), {});
    EXPECT_EQ(again->next()->frame_id, camera);
  }
}

TEST(Recorder, StartsAndStopsBetweenFrames) {
  const TemporaryFolder folder;
  Recorder recorder(some_run(), {});
  EXPECT_EQ(recorder.summary(), "");
  recorder.stop();  // no effect
  for (const char* name : {"a.mcap", "b.mcap"}) {
    recorder.start(folder.path() / name);
    EXPECT_THROW(recorder.start(folder.path() / "c.mcap"), Error);
    recorder.offer(frame_of(1));
    recorder.offer(frame_of(2));
    recorder.stop();
    recorder.offer(frame_of(3));
    EXPECT_EQ(counts_of(folder.path() / name)["/cairn/objects"], 2);
  }
  EXPECT_THROW(recorder.start(folder.path() / "a.mcap"), Error);  // already exists
  EXPECT_FALSE(fs::exists(folder.path() / "c.mcap"));
}

TEST(Recorder, OptionChangesAreRecordedInOrder) {
  const TemporaryFolder folder;
  Recorder recorder(some_run(), {});
  recorder.start(folder.path() / "a.mcap");
  recorder.offer(frame_of(1, 0));
  recorder.offer(frame_of(2, 1));
  recorder.offer(frame_of(3, 1));
  recorder.stop();
  ros::McapReader reader(folder.path() / "a.mcap");
  EXPECT_NE(ros::attachment_of(reader, "config.yaml")->find("num_disparities: 32 "), std::string::npos);
  std::vector<std::string> changes;
  while (const auto message = reader.next()) {
    if (reader.channels().at(message->channel).topic == "/cairn/config")
      changes.push_back(ros::decode<ros::String>(message->bytes).data);
  }
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_NE(changes[0].find("num_disparities: 33 "), std::string::npos);
}

TEST(Recorder, SkipsFramesInsteadOfDelayingTheRunAndReportsIt) {
  const TemporaryFolder folder;
  RecorderOptions options;
  options.most_waiting = 1;
  Recorder recorder(some_run(), options);
  recorder.start(folder.path() / "a.mcap");
  constexpr int kFrames = 300;
  const LiveFramePtr frame = frame_of(1);
  for (int i = 0; i < kFrames; ++i) recorder.offer(frame);
  // One more when there is room again; it carries the count of the skipped ones.
  const std::uint64_t skipped = recorder.status().skipped;
  while (recorder.status().frames + skipped < kFrames) std::this_thread::yield();
  recorder.offer(frame);
  recorder.stop();
  const RecorderStatus status = recorder.status();
  ASSERT_GT(status.skipped, 0U);
  EXPECT_EQ(status.frames + status.skipped, kFrames + 1U);
  ros::McapReader reader(folder.path() / "a.mcap");
  std::uint64_t reported = 0;
  while (const auto message = reader.next()) {
    if (reader.channels().at(message->channel).topic != "/cairn/skipped") continue;
    reported += std::stoull(ros::decode<ros::String>(message->bytes).data.substr(10));  // {"frames":3}
  }
  EXPECT_EQ(reported, status.skipped);
  EXPECT_NE(recorder.summary().find("skipped"), std::string::npos);
}

TEST(Recorder, WaitsIfNoFrameMayBeMissing) {
  const TemporaryFolder folder;
  RecorderOptions options;
  options.most_waiting = 1;
  options.waits = true;
  Recorder recorder(some_run(), options);
  recorder.start(folder.path() / "a.mcap");
  for (int i = 0; i < 50; ++i) recorder.offer(frame_of(i));
  recorder.stop();
  EXPECT_EQ(recorder.status().frames, 50U);
  EXPECT_EQ(recorder.status().skipped, 0U);
}

TEST(Recorder, UnrepresentableStampsEndTheRecordingButNotTheRun) {
  const TemporaryFolder folder;
  std::vector<std::string> lines;
  RecorderOptions options;
  options.on_trouble = [&](const std::string& line) { lines.push_back(line); };
  Recorder recorder(some_run(), options);
  recorder.start(folder.path() / "a.mcap");
  const LiveFramePtr frame = frame_of(1);
  auto late = frame_of(2);
  const_cast<LiveFrame&>(*late).step.stamp = {std::int64_t{5'000'000'000} * 1'000'000'000};
  recorder.offer(late);
  while (recorder.status().is_recording) std::this_thread::yield();
  recorder.offer(frame);
  recorder.finish();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].starts_with("recording stopped: stamp: found")) << lines[0];
  EXPECT_NE(recorder.summary().find("stopped: "), std::string::npos);
}

TEST(Recorder, RefusesUnknownParts) {
  EXPECT_TRUE(parse_record_what("all").grid);
  EXPECT_TRUE(parse_record_what("input,grid").input);
  EXPECT_FALSE(parse_record_what("input,grid").objects);
  for (const char* text : {"", "input,", "Input", "images", "all;grid"})
    EXPECT_THROW(parse_record_what(text), Error) << text;
}

}  // namespace
}  // namespace cairn::live
