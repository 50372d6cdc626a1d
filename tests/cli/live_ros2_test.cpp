// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <atomic>
#include <cairn/io/calibration_files.hpp>
#include <cairn/ros/dds/participant.hpp>
#include <cairn/ros/from_step.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "command.hpp"
#include "support/dds_domain.hpp"
#include "support/sensor_messages.hpp"

/// cairn live --ros2, received by another process.
namespace cairn::command {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

class LiveRos2 : public CommandTest {
 protected:
  static void SetUpTestSuite() { enter_own_domain(); }

  static std::string sequence() { return CAIRN_SOURCE_DIR "/data/sequences/rolling_ball"; }
  static std::map<std::int64_t, Json> frames_of(const std::string& lines) {
    std::map<std::int64_t, Json> frames;
    std::istringstream text(lines);
    for (std::string line; std::getline(text, line);) {
      const Json frame = Json::parse(line);
      frames[frame["stamp_ns"].get<std::int64_t>()] = frame;
    }
    return frames;
  }
};

/// Objects with a position, from the command and as received, in the frame of `camera`.
void expect_same_objects(const Json& frame, const ros::Detection3DArray& heard,
                         const std::string& camera = "cairn_camera") {
  std::vector<Json> placed;
  for (const Json& object : frame["objects"])
    if (!object["position_m"].is_null()) placed.push_back(object);
  ASSERT_EQ(heard.detections.size(), placed.size());
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const ros::Detection3D& detection = heard.detections[i];
    const auto place = placed[i]["position_m"].get<std::array<double, 3>>();
    const auto& position = detection.results.front().pose.pose.position;
    EXPECT_NEAR(position.x, place[0], 1e-3);
    EXPECT_NEAR(position.y, place[1], 1e-3);
    EXPECT_NEAR(position.z, place[2], 1e-3);
    EXPECT_NEAR(detection.results.front().hypothesis.score, placed[i]["confidence"].get<double>(), 1e-3);
    EXPECT_EQ(detection.id, std::to_string(placed[i]["id"].get<int>()));
    EXPECT_EQ(detection.header.frame_id, camera);
  }
}

TEST_F(LiveRos2, AnotherProcessReceivesWhatIsPrinted) {
  const ros::Participant participant;
  const std::string prefix = own_topic("run");
  ros::Reader<ros::Detection3DArray> objects(participant, prefix + "/objects", {true, 1000});
  ros::Reader<ros::String> stats(participant, prefix + "/stats", {true, 1000});
  const Outcome outcome = run(
      {"live", sequence(), "--no-tracks", "--every-frame", "--rate", "3", "--json-lines", "--ros2", prefix});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto printed = frames_of(outcome.out);
  ASSERT_EQ(printed.size(), 6U);
  int heard = 0;
  while (const auto message = objects.take()) {
    const auto frame = printed.find(ros::stamp_of(message->header.stamp).ns);
    ASSERT_NE(frame, printed.end());
    expect_same_objects(frame->second, *message);
    ++heard;
  }
  EXPECT_GE(heard, 4) << outcome.err;  // the first ones may precede discovery
  const auto said = stats.take();
  ASSERT_TRUE(said);
  EXPECT_TRUE(Json::parse(said->data).contains("worked_ms"));
  EXPECT_NE(outcome.err.find("ros2 in domain "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(prefix + "/objects " + std::to_string(heard)), std::string::npos) << outcome.err;
}

TEST_F(LiveRos2, FollowPublishesToo) {
  const ros::Participant participant;
  const std::string prefix = own_topic("followed");
  const Outcome outcome = run({"follow", sequence(), "--ros2", prefix});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("ros2 in domain "), std::string::npos) << outcome.err;
}

/// A camera that publishes a sample at 10 Hz.
class Camera {
 public:
  explicit Camera(const std::string& prefix)
      : left_(participant_, prefix + "/left/image_rect"),
        right_(participant_, prefix + "/right/image_rect"),
        left_info_(participant_, prefix + "/left/camera_info"),
        right_info_(participant_, prefix + "/right/camera_info"),
        thread_([this] { work(); }) {}
  ~Camera() {
    is_over_ = true;
    thread_.join();
  }
  static fs::path sample() { return fs::path(CAIRN_SOURCE_DIR) / "data/samples/four_in_a_row"; }

 private:
  void work() {
    const io::LoadedPair pair = io::load_pair(sample() / "left.png", sample() / "right.png");
    const StereoRig rig = *io::load_calibration(sample() / "calib.txt").rig;
    for (std::int64_t i = 1; !is_over_; ++i) {
      const ros::Header header = ros::header_of({i * 100'000'000}, "left_optical");
      const Size size = pair.left.gray.size();
      left_info_.write(ros::camera_info_of(header, rig, size, ros::Side::left));
      right_info_.write(ros::camera_info_of(header, rig, size, ros::Side::right));
      left_.write(ros::image_of(header, pair.left.rgb.view()));
      right_.write(ros::image_of(header, pair.right.gray.view()));
      std::this_thread::sleep_for(100ms);
    }
  }

  ros::Participant participant_;
  ros::Writer<ros::Image> left_;
  ros::Writer<ros::Image> right_;
  ros::Writer<ros::CameraInfo> left_info_;
  ros::Writer<ros::CameraInfo> right_info_;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

TEST_F(LiveRos2, ACameraOnTopicsIsSegmentedAsItsImagesAre) {
  const std::string prefix = own_topic("stereo");
  const ros::Participant participant;
  ros::Reader<ros::Detection3DArray> objects(participant, prefix + "/objects", {true, 1000});
  const Camera camera(prefix);
  const Outcome live = run({"live", "ros2:" + prefix, "--no-tracks", "--max-age", "0", "--frames", "8",
                            "--set", "match.num_disparities=32", "--json-lines", "--ros2", prefix});
  ASSERT_EQ(live.code, 0) << live.err;
  const fs::path sample = Camera::sample();
  const Outcome alone =
      run({"segment", sample / "left.png", sample / "right.png", "--calib", sample / "calib.txt", "--json"});
  const Json expected = Json::parse(alone.out);
  const auto frames = frames_of(live.out);
  ASSERT_GE(frames.size(), 1U) << live.err;
  for (const auto& [stamp, frame] : frames) {
    EXPECT_EQ(stamp % 100'000'000, 0);
    EXPECT_EQ(frame["frame_id"], "left_optical");
    EXPECT_EQ(frame["objects"], expected["objects"]);
    EXPECT_EQ(frame["floor_frame"], expected["floor_frame"]);
  }
  int heard = 0;
  while (const auto message = objects.take()) {
    expect_same_objects(expected, *message, "left_optical");
    ++heard;
  }
  EXPECT_GE(heard, 1) << live.err;
}

TEST_F(LiveRos2, WheelsOnATopicArePriorsOfOdometry) {
  const std::string prefix = own_topic("wheels");
  const Camera camera(prefix);
  const ros::Participant participant;
  ros::Writer<ros::Odometry> wheels(participant, prefix + "/odom");
  std::atomic<bool> is_over = false;
  std::thread robot([&] {
    ros::Odometry message = sensor_messages::odometry(1).front();
    // Ahead of the images, so that none has to wait; the robot stands.
    for (std::int64_t i = 1; !is_over; ++i) {
      message.header.stamp = ros::time_of({i * 20'000'000 + 500'000'000});
      wheels.write(message);
      std::this_thread::sleep_for(20ms);
    }
  });
  const Outcome outcome =
      run({"odometry", "ros2:" + prefix, "--odometry", "ros2:" + prefix + "/odom", "--frames", "20"});
  is_over = true;
  robot.join();
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::string used = "prior: topic " + prefix + "/odom, used for ";
  const auto at = outcome.err.find(used);
  ASSERT_NE(at, std::string::npos) << outcome.err;
  EXPECT_GE(std::stoi(outcome.err.substr(at + used.size())), 1) << outcome.err;
  EXPECT_NE(outcome.err.find("/tf_static has no transform from base_link"), std::string::npos) << outcome.err;
}

TEST_F(LiveRos2, RefusesNamesThatRosDoesNotAllow) {
  refuses({"live", sequence(), "--ros2", "a-b"}, {"--ros2", "a-b", "expected a ROS name"});
  refuses({"live", sequence(), "--ros2", "--ros2-holes", "zero"}, {"--ros2-holes", "zero", "nan or ros"});
  refuses({"live", sequence(), "--ros2-holes", "ros"}, {"--ros2-holes", "needs --ros2"});
  refuses({"live", "ros2:/a//b"}, {"a//b", "expected a ROS name"});
  refuses({"live", "ros2:/a", "--layout", "side_by_side"}, {"--layout"});
  const std::string domain = std::getenv("ROS_DOMAIN_ID");
  ::setenv("ROS_DOMAIN_ID", "300", 1);
  refuses({"live", sequence(), "--ros2"}, {"ROS_DOMAIN_ID", "300", "0 ... 232"});
  ::setenv("ROS_DOMAIN_ID", domain.c_str(), 1);
}

/// The sockets that a process has open.
int sockets_of(pid_t process) {
  int sockets = 0;
  std::error_code gone;
  for (const auto& entry : fs::directory_iterator("/proc/" + std::to_string(process) + "/fd", gone))
    sockets += fs::read_symlink(entry.path(), gone).string().starts_with("socket:") ? 1 : 0;
  return sockets;
}

/// Sockets of the command while it runs.
int sockets_while(std::vector<std::string> arguments, const std::string& out) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int number : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&files, number, out.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  arguments.insert(arguments.begin(), CAIRN_COMMAND);
  std::vector<char*> argv;
  for (std::string& word : arguments) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  EXPECT_EQ(posix_spawn(&child, CAIRN_COMMAND, &files, nullptr, argv.data(), environ), 0);
  posix_spawn_file_actions_destroy(&files);
  EXPECT_TRUE(comes_true([&] { return !content(out).empty(); }));  // its first frame
  const int sockets = sockets_of(child);
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0) << content(out);
  return sockets;
}

TEST_F(LiveRos2, OpensNoSocketUnlessRequested) {
  const int own = sockets_of(getpid());  // a child may inherit these
  EXPECT_LE(sockets_while({"live", sequence(), "--json-lines"}, path("without")), own);
  EXPECT_GT(sockets_while({"live", sequence(), "--json-lines", "--ros2"}, path("with")), own);
}

}  // namespace
}  // namespace cairn::command
