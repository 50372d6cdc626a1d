// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <dds/dds.h>
#include <gtest/gtest.h>
#include <ros.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/fleet/rows.hpp>
#include <cairn/input/dds/ros2_sensors.hpp>
#include <cairn/input/dds/ros2_sequence.hpp>
#include <cairn/input/ros_pictures.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/live/dds/agents.hpp>
#include <cairn/live/dds/ros2_sink.hpp>
#include <cairn/live/topics.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cairn/ros/dds/participant.hpp>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "support/dds_domain.hpp"
#include "support/sensor_messages.hpp"
#include "support/type_hash.hpp"

/// ROS 2 topics: our serialisation equals Cyclone's, published messages equal the results, and pairs arrive
/// as sent.
namespace cairn::ros {
namespace {

using namespace std::chrono_literals;

class Dds : public testing::Test {
 protected:
  static void SetUpTestSuite() { enter_own_domain(); }
};

std::string message_of(const auto& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// An image with objects, as in a robot's loop; `frame_id`: of its source.
live::LiveFramePtr made_frame(const std::string& frame_id) {
  const std::filesystem::path folder =
      std::filesystem::path(CAIRN_SOURCE_DIR) / "data" / "samples" / "four_in_a_row";
  io::LoadedPair images = io::load_pair(folder / "left.png", folder / "right.png");
  const io::Calibration calibration = io::load_calibration(folder / "calib.txt");
  FollowConfig config;
  config.segmentation.match.num_disparities = calibration.num_disparities.value_or(64);
  auto frame = std::make_shared<live::LiveFrame>();
  frame->step.stamp = {1'700'000'000'123'456'789};
  frame->step.frame = segment(StereoPair::from(images.left.gray, images.right.gray, images.left.rgb),
                              calibration.rig, config.segmentation, {});
  auto pair = std::make_shared<input::SequenceFrame>();
  pair->name = "four_in_a_row";
  pair->left = std::move(images.left);
  pair->right = std::move(images.right.gray);
  pair->frame_id = frame_id;
  frame->pair = std::move(pair);
  frame->config = std::make_shared<const FollowConfig>(config);
  return frame;
}
live::LiveFramePtr live_frame() {
  static const live::LiveFramePtr made = made_frame("");
  return made;
}
StereoRig rig() {
  return *io::load_calibration(std::filesystem::path(CAIRN_SOURCE_DIR) /
                               "data/samples/four_in_a_row/calib.txt")
              .rig;
}

// ---- names and hashes ----

TEST_F(Dds, NamesFollowRos) {
  EXPECT_EQ(dds_type_name("sensor_msgs/msg/Image"), "sensor_msgs::msg::dds_::Image_");
  EXPECT_EQ(checked_name("cairn", "--ros2"), "/cairn");
  EXPECT_EQ(checked_name("/robot_1/left", "--ros2"), "/robot_1/left");
  for (const char* name : {"", "/", "a/", "a//b", "1a", "a/2b", "a-b", "a b", "~a"}) {
    EXPECT_NE(message_of([&] { checked_name(name, "--ros2"); }).find("expected a ROS name"),
              std::string::npos)
        << name;
  }
}

template <class M>
void expect_known_hash() {
  EXPECT_EQ(type_hash(M::kType), TypeDescription::hash<M>()) << M::kType;
}

TEST_F(Dds, TypeHashesFollowFromTheMembers) {
  EXPECT_EQ(io::sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  expect_known_hash<String>();
  expect_known_hash<Image>();
  expect_known_hash<CameraInfo>();
  expect_known_hash<PointCloud2>();
  expect_known_hash<DisparityImage>();
  expect_known_hash<Detection3DArray>();
  expect_known_hash<OccupancyGrid>();
  expect_known_hash<TFMessage>();
  expect_known_hash<LaserScan>();
  expect_known_hash<Imu>();
  expect_known_hash<Odometry>();
  expect_known_hash<DiagnosticArray>();
  expect_known_hash<PoseWithCovarianceStamped>();
  // As published by ROS 2's interface packages.
  EXPECT_EQ(type_hash("std_msgs/msg/String"),
            "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18");
  EXPECT_EQ(type_hash("no/msg/Type"), "");
}

TEST_F(Dds, TheDomainComesFromTheEnvironment) {
  const std::string own = std::getenv("ROS_DOMAIN_ID");
  ::setenv("ROS_DOMAIN_ID", "7", 1);
  EXPECT_EQ(domain_of_environment().id, 7U);
  EXPECT_NE(domain_of_environment().configuration.find("127.0.0.1"), std::string::npos);
  for (const char* wrong : {"233", "-1", "7a", "x"}) {
    ::setenv("ROS_DOMAIN_ID", wrong, 1);
    EXPECT_EQ(message_of([] { domain_of_environment(); }),
              "ROS_DOMAIN_ID: found " + std::string(wrong) + ", expected 0 ... 232");
  }
  ::unsetenv("ROS_DOMAIN_ID");
  EXPECT_EQ(domain_of_environment().id, 0U);
  ::setenv("ROS_LOCALHOST_ONLY", "0", 1);
  EXPECT_EQ(domain_of_environment().configuration, "");
  ::setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", 1);
  EXPECT_NE(domain_of_environment().configuration.find("Peer address"), std::string::npos);
  ::setenv("CYCLONEDDS_URI", "file:///robot.xml", 1);
  EXPECT_TRUE(domain_of_environment().configuration.ends_with(",file:///robot.xml"));
  ::setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "NEAR", 1);
  EXPECT_NE(message_of([] { domain_of_environment(); }).find("expected SUBNET, LOCALHOST, OFF"),
            std::string::npos);
  ::setenv("ROS_LOCALHOST_ONLY", "yes", 1);
  EXPECT_EQ(message_of([] { domain_of_environment(); }), "ROS_LOCALHOST_ONLY: found yes, expected 0 or 1");
  enter_own_domain();
  ::setenv("ROS_DOMAIN_ID", own.c_str(), 1);
}

// ---- bytes ----

/// Sends a message to a reader generated from IDL, sends what it received back through a generated writer,
/// and compares.
template <class Theirs, Message M>
void expect_the_bytes_of_cyclone(const M& message, const dds_topic_descriptor_t& description) {
  const Participant ours;
  const std::string there = own_topic("there/" + std::string(M::kType.substr(M::kType.rfind('/') + 1)));
  const std::string back = own_topic("back/" + std::string(M::kType.substr(M::kType.rfind('/') + 1)));
  Writer<M> writer(ours, there);
  BytesReader reader(ours, back, topic_type<M>(), {true, 5});

  const Entity theirs(dds_create_participant(ours.domain(), nullptr, nullptr), "theirs");
  const Entity there_topic(
      dds_create_topic(theirs.handle(), &description, ("rt" + there).c_str(), nullptr, nullptr), there);
  const Entity back_topic(
      dds_create_topic(theirs.handle(), &description, ("rt" + back).c_str(), nullptr, nullptr), back);
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  const Entity their_reader(dds_create_reader(theirs.handle(), there_topic.handle(), qos, nullptr), there);
  const Entity their_writer(dds_create_writer(theirs.handle(), back_topic.handle(), qos, nullptr), back);
  dds_delete_qos(qos);
  const auto has_their_reader = [&] {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(their_writer.handle(), &status);
    return status.current_count > 0;
  };
  ASSERT_TRUE(comes_true([&] { return writer.has_reader() && reader.has_writer() && has_their_reader(); }));

  ASSERT_TRUE(writer.write(message));
  void* sample = nullptr;
  dds_sample_info_t info{};
  ASSERT_TRUE(comes_true([&] { return dds_take(their_reader.handle(), &sample, &info, 1, 1) == 1; }));
  ASSERT_TRUE(info.valid_data);
  ASSERT_EQ(dds_write(their_writer.handle(), static_cast<const Theirs*>(sample)), DDS_RETCODE_OK);
  dds_return_loan(their_reader.handle(), &sample, 1);

  std::optional<Bytes> came;
  ASSERT_TRUE(comes_true([&] { return (came = reader.take()).has_value(); }));
  Bytes sent = encode(message);
  // In newer versions of the protocol, the header's last byte is the number of padding bytes.
  (*came)[3] = 0;
  came->resize(std::max(came->size(), sent.size()));
  sent.resize(came->size());
  EXPECT_LT(came->size() - encode(message).size(), 4U);
  EXPECT_TRUE(sent == *came) << M::kType;
}

TEST_F(Dds, BytesEqualThoseOfCyclone) {
  const TrackedFrame& step = live_frame()->step;
  const Header header = header_of(step.stamp, "camera");
  const StereoRig camera = rig();
  expect_the_bytes_of_cyclone<std_msgs_msg_dds__String_>(String{"so"}, std_msgs_msg_dds__String__desc);
  expect_the_bytes_of_cyclone<sensor_msgs_msg_dds__Image_>(labels_of(header, step),
                                                           sensor_msgs_msg_dds__Image__desc);
  expect_the_bytes_of_cyclone<sensor_msgs_msg_dds__CameraInfo_>(
      camera_info_of(header, camera, {640, 480}, Side::right), sensor_msgs_msg_dds__CameraInfo__desc);
  expect_the_bytes_of_cyclone<stereo_msgs_msg_dds__DisparityImage_>(
      disparity_image_of(header, step.frame, camera, live_frame()->config->segmentation.match),
      stereo_msgs_msg_dds__DisparityImage__desc);
  const PointCloud2 cloud = cloud_of(header, step.frame, ObstacleLabel::obstacle, camera,
                                     live_frame()->pair->left.gray.view(), {}, 3);
  EXPECT_GT(cloud.width, 100U);
  expect_the_bytes_of_cyclone<sensor_msgs_msg_dds__PointCloud2_>(cloud,
                                                                 sensor_msgs_msg_dds__PointCloud2__desc);
  const Detection3DArray detections = detections_of(header, step, camera);
  EXPECT_GE(detections.detections.size(), 2U);
  expect_the_bytes_of_cyclone<vision_msgs_msg_dds__Detection3DArray_>(
      detections, vision_msgs_msg_dds__Detection3DArray__desc);
  const auto grid = grid_of(header, step.frame, camera, live_frame()->config->segmentation.obstacles);
  ASSERT_TRUE(grid);
  expect_the_bytes_of_cyclone<nav_msgs_msg_dds__OccupancyGrid_>(*grid, nav_msgs_msg_dds__OccupancyGrid__desc);
  const auto floor = floor_transform_of(step.stamp, {}, step.frame.ground, camera);
  ASSERT_TRUE(floor);
  expect_the_bytes_of_cyclone<tf2_msgs_msg_dds__TFMessage_>(TFMessage{{*floor, *floor}},
                                                            tf2_msgs_msg_dds__TFMessage__desc);
  expect_the_bytes_of_cyclone<sensor_msgs_msg_dds__LaserScan_>(sensor_messages::scans(2)[1],
                                                               sensor_msgs_msg_dds__LaserScan__desc);
  expect_the_bytes_of_cyclone<sensor_msgs_msg_dds__Imu_>(sensor_messages::imu(3)[2],
                                                         sensor_msgs_msg_dds__Imu__desc);
  expect_the_bytes_of_cyclone<nav_msgs_msg_dds__Odometry_>(sensor_messages::odometry(3)[2],
                                                           nav_msgs_msg_dds__Odometry__desc);
  const DiagnosticStatus status{
      DiagnosticStatus::kWarn, "cairn: perception", "dark", "", {{"a", "1"}, {"bc", ""}}};
  expect_the_bytes_of_cyclone<diagnostic_msgs_msg_dds__DiagnosticArray_>(
      DiagnosticArray{header, {status, status}}, diagnostic_msgs_msg_dds__DiagnosticArray__desc);
  expect_the_bytes_of_cyclone<geometry_msgs_msg_dds__PoseWithCovarianceStamped_>(
      camera_pose_of(header, step, {}, {1, 2, 3}), geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc);
}

// ---- topics with keys ----

fleet::LandmarkRow row_of(std::int64_t id, std::uint64_t version, const std::string& name) {
  Landmark landmark;
  landmark.id = LandmarkId{id};
  landmark.name = name;
  landmark.position_m = {1, 2, 3};
  landmark.covariance_m2 = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  landmark.looks.resize(1);
  landmark.looks[0].octant = 3;
  landmark.looks[0].colours[5] = 1;
  return fleet::row_of(landmark, {{1, 2, 3}, "a"}, version);
}

TEST_F(Dds, RowsHaveTheBytesAndKeysOfCyclone) {
  expect_the_bytes_of_cyclone<cairn_msgs_msg_dds__Landmark_>(row_of(7, 9, "cup"),
                                                             cairn_msgs_msg_dds__Landmark__desc);
  fleet::FloorRow tile;
  tile.x = -3;
  tile.frames[63] = 7;
  expect_the_bytes_of_cyclone<cairn_msgs_msg_dds__FloorTile_>(tile, cairn_msgs_msg_dds__FloorTile__desc);
  fleet::IndexRow index;
  index.landmarks = {1, 5};
  index.tile_x = index.tile_y = {-1, 2, 3};
  expect_the_bytes_of_cyclone<cairn_msgs_msg_dds__MapIndex_>(index, cairn_msgs_msg_dds__MapIndex__desc);
  fleet::AgentRow agent;
  agent.name = "a";
  agent.robots.resize(2);
  agent.robots[1].name = "b";
  expect_the_bytes_of_cyclone<cairn_msgs_msg_dds__Agent_>(agent, cairn_msgs_msg_dds__Agent__desc);
  EXPECT_EQ(key_sizes<fleet::FloorRow>().size(), 50U);
  EXPECT_TRUE(key_sizes<String>().empty());
}

/// Among the last rows that a generated reader holds, as it counts instances by its own idea of the key.
TEST_F(Dds, AnotherReaderCountsTheSameInstances) {
  const Participant ours;
  const std::string topic = own_topic("instances");
  Writer<fleet::LandmarkRow> writer(ours, topic, {.latched = true, .depth = 1});
  for (std::uint64_t version = 1; version <= 3; ++version) {
    for (const std::int64_t id : {1, 2, 300})
      writer.write(row_of(id, version, "of " + std::to_string(version)));
  }
  const Entity theirs(dds_create_participant(ours.domain(), nullptr, nullptr), "theirs");
  const Entity their_topic(dds_create_topic(theirs.handle(), &cairn_msgs_msg_dds__Landmark__desc,
                                            ("rt" + topic).c_str(), nullptr, nullptr),
                           topic);
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
  const Entity reader(dds_create_reader(theirs.handle(), their_topic.handle(), qos, nullptr), topic);
  dds_delete_qos(qos);
  std::map<std::int64_t, std::uint64_t> versions;
  EXPECT_TRUE(comes_true([&] {
    void* sample = nullptr;
    dds_sample_info_t info{};
    while (dds_take(reader.handle(), &sample, &info, 1, 1) == 1) {
      const auto* row = static_cast<const cairn_msgs_msg_dds__Landmark_*>(sample);
      if (info.valid_data) versions[row->id] = row->version;
      dds_return_loan(reader.handle(), &sample, 1);
    }
    return versions.size() == 3;
  }));
  EXPECT_EQ(versions, (std::map<std::int64_t, std::uint64_t>{{1, 3}, {2, 3}, {300, 3}}));
}

TEST_F(Dds, ALateReaderGetsTheLastRowOfEachKey) {
  const Participant participant;
  const std::string topic = own_topic("rows");
  Writer<fleet::LandmarkRow> writer(participant, topic, {.latched = true, .depth = 1});
  constexpr std::int64_t kRows = 2000;
  for (std::uint64_t version = 1; version <= 2; ++version) {
    for (std::int64_t id = 1; id <= kRows; ++id) writer.write(row_of(id, version, ""));
  }
  Reader<fleet::LandmarkRow> late(participant, topic, {.reliable = true, .depth = 1, .latched = true});
  std::set<std::int64_t> ids;
  std::size_t count = 0;
  EXPECT_TRUE(comes_true([&] {
    while (const auto row = late.take()) {
      EXPECT_EQ(row->version, 2U);
      ids.insert(row->id);
      ++count;
    }
    return ids.size() == kRows;
  }));
  EXPECT_EQ(count, static_cast<std::size_t>(kRows));
}

TEST_F(Dds, AnAgentThatSaysNothingIsNotAlive) {
  const Participant here;
  const std::string topic = own_topic("agents");
  Reader<fleet::AgentRow> reader(here, topic, {.reliable = true, .depth = 1, .latched = true});
  Writer<fleet::AgentRow> writer(here, topic, {.latched = true, .depth = 1, .lease = 300ms});
  fleet::AgentRow row;
  row.agent = {4, 5, 6};
  row.name = "a";
  ASSERT_TRUE(comes_true([&] { return writer.has_reader() && reader.has_writer(); }));
  writer.write(row);
  std::optional<BytesReader::Change> change;
  ASSERT_TRUE(comes_true([&] { return (change = reader.take_change()).has_value(); }));
  EXPECT_TRUE(change->is_alive);
  const Bytes key(change->bytes.begin(), change->bytes.begin() + 20);
  // As long as it is asserted, it is alive.
  for (int i = 0; i < 10; ++i) {
    writer.assert_alive();
    std::this_thread::sleep_for(100ms);
  }
  EXPECT_FALSE(reader.take_change());
  ASSERT_TRUE(comes_true([&] { return (change = reader.take_change()).has_value(); }, 5s));
  EXPECT_FALSE(change->is_alive);
  EXPECT_FALSE(change->has_message);
  EXPECT_EQ(change->bytes, key);
  // The next word revives it.
  writer.write(row);
  ASSERT_TRUE(comes_true([&] { return (change = reader.take_change()).has_value(); }));
  EXPECT_TRUE(change->is_alive);
}

/// The thread that sends rows goes on, but the loop of frames does not say that it lives.
TEST_F(Dds, AWatchSeesALoopThatHangs) {
  const live::FleetDomain domain{static_cast<std::uint32_t>(std::stoi(std::getenv("ROS_DOMAIN_ID"))) + 110,
                                 ""};
  const auto watch = live::fleet_watch(domain);
  const auto sink = live::share_sink({"a", "00112233445566778899aabbccddeeff", rig(), domain});
  const auto is_alive = [&] {
    const live::FleetState state = watch->next(20ms);
    return !state.agents.empty() && state.agents[0].is_alive;
  };
  sink->offer(live_frame());
  EXPECT_TRUE(comes_true([&] {
    sink->note_alive();
    return is_alive();
  }));
  for (int i = 0; i < 60; ++i) {
    sink->note_alive();
    EXPECT_TRUE(is_alive());
    std::this_thread::sleep_for(30ms);
  }
  const auto hung = std::chrono::steady_clock::now();
  EXPECT_TRUE(comes_true([&] { return !is_alive(); }));
  EXPECT_LT(std::chrono::steady_clock::now() - hung, 10s);
  EXPECT_TRUE(comes_true([&] {
    sink->note_alive();
    return is_alive();
  }));
  const live::AgentState agent = watch->next(20ms).agents.at(0);
  EXPECT_EQ(agent.role, "perception");
  EXPECT_EQ(agent.name, "a");
  EXPECT_EQ(static_cast<std::size_t>(agent.objects), live_frame()->step.frame.objects.list.size());
  sink->finish();
  EXPECT_TRUE(comes_true([&] {
    const auto state = watch->next(20ms);
    return !state.agents.at(0).is_alive && state.agents[0].has_ended;
  }));
}

TEST_F(Dds, AWatchWarnsOfTwinsAndOfClocks) {
  const live::FleetDomain domain{static_cast<std::uint32_t>(std::stoi(std::getenv("ROS_DOMAIN_ID"))) + 110,
                                 ""};
  const auto watch = live::fleet_watch(domain);
  const Participant participant(domain_of_fleet(domain.id, ""));
  Writer<fleet::AgentRow> writer(participant, live::fleet_topics::kAgents, live::fleet_topics::kAgentRow);
  fleet::AgentRow row;
  row.role = "perception";
  row.name = "a";
  std::set<std::string> warnings;
  std::size_t agents = 0;
  const auto say = [&](std::uint8_t agent, double ahead_s) {
    row.agent = {agent};
    const auto now =
        std::chrono::system_clock::now().time_since_epoch() + std::chrono::duration<double>(ahead_s);
    row.stamp = time_of({std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()});
    writer.write(row);
  };
  const auto next = [&] {
    const live::FleetState state = watch->next(50ms);
    warnings.insert(state.warnings.begin(), state.warnings.end());
    agents = state.agents.size();
    return !warnings.empty();
  };
  EXPECT_TRUE(comes_true([&] {
    say(1, 0);
    return !next() && agents == 1;
  }));
  // A second process of this name, for longer than a restart takes.
  EXPECT_TRUE(comes_true([&] {
    say(1, 0);
    say(2, 0);
    return next();
  }));
  EXPECT_EQ(warnings, std::set<std::string>{"perception a: 2 processes of this name"});
  warnings.clear();
  row.name = "b";
  EXPECT_TRUE(comes_true([&] {
    say(3, 3600);
    next();
    return warnings.contains("perception b: its clock is 3600.0 s ahead of this computer's");
  })) << warnings.size();
  // What is not sound is not listed.
  row.name = "\n";
  for (int i = 0; i < 10; ++i) {
    say(4, 0);
    next();
  }
  EXPECT_EQ(agents, 3U);
}

/// Cyclone asks for the key of what comes from the network.
TEST_F(Dds, ARowThatIsTooShortForItsKeyIsDropped) {
  const Participant here;
  const std::string topic = own_topic("short");
  BytesReader reader(here, topic, topic_type<fleet::LandmarkRow>(), {.reliable = true});
  BytesWriter writer(here, topic, topic_type<fleet::LandmarkRow>());
  ASSERT_TRUE(comes_true([&] { return writer.has_reader(); }));
  Bytes row = encode(row_of(1, 1, ""));
  Bytes big = row;
  big[1] = 0;  // big endian
  for (Bytes bad : {Bytes{0, 1, 0, 0}, Bytes(row.begin(), row.begin() + 59), Bytes{}, big})
    EXPECT_FALSE(writer.write(std::move(bad)));
  EXPECT_TRUE(writer.write(row));
  EXPECT_TRUE(comes_true([&] { return reader.take() == row; }));
}

TEST_F(Dds, WritersAnnounceTheirTypeHash) {
  const Participant participant;
  const std::string topic = own_topic("hash");
  const Writer<Image> writer(participant, topic);
  const Entity reader(
      dds_create_reader(participant.handle(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
      "builtin");
  std::string data;
  ASSERT_TRUE(comes_true([&] {
    void* sample = nullptr;
    dds_sample_info_t info{};
    while (dds_take(reader.handle(), &sample, &info, 1, 1) == 1) {
      const auto* endpoint = static_cast<const dds_builtintopic_endpoint_t*>(sample);
      if (info.valid_data && endpoint->topic_name == "rt" + topic) {
        void* value = nullptr;
        std::size_t size = 0;
        dds_qget_userdata(endpoint->qos, &value, &size);
        data.assign(static_cast<const char*>(value), size);
        dds_free(value);
      }
      dds_return_loan(reader.handle(), &sample, 1);
      sample = nullptr;
    }
    return !data.empty();
  }));
  EXPECT_EQ(data, "typehash=" + std::string(type_hash(Image::kType)) + ";");
}

// ---- publishing ----

TEST_F(Dds, ResultsArePublished) {
  const live::LiveFramePtr frame = live_frame();
  live::Ros2Options options;
  options.name_space = own_topic("found");
  const StereoRig camera = rig();
  const auto sink = live::ros2_sink(options, camera);
  const Participant participant;
  const auto topic = [&](const char* name) { return options.name_space + "/" + name; };
  Reader<Detection3DArray> objects(participant, topic("objects"), {true, 5});
  Reader<DisparityImage> disparity(participant, topic("disparity"));
  Reader<PointCloud2> obstacles(participant, topic("obstacles"));
  Reader<PointCloud2> floor(participant, topic("floor"));
  Reader<Image> labels(participant, topic("labels"));
  Reader<Image> reject(participant, topic("reject"));
  Reader<OccupancyGrid> grid(participant, topic("grid"));
  Reader<String> stats(participant, topic("stats"));
  Reader<TFMessage> transforms(participant, "/tf", {true, 50});
  // Messages sent before discovery may miss a reader.
  const auto come = [&](auto& reader) {
    auto message = reader.take();
    comes_true([&] {
      if (!message) sink->offer(frame);
      std::this_thread::sleep_for(20ms);
      return message || (message = reader.take());
    });
    return message;
  };
  const Header header = header_of(frame->step.stamp, "cairn_camera");
  const Frame& found = frame->step.frame;
  const auto expect_same = [](const auto& message, const auto& expected) {
    ASSERT_TRUE(message.has_value());
    EXPECT_TRUE(encode(*message) == encode(expected));
  };
  const View<const Gray> left = frame->pair->left.gray.view();
  const View<const Rgb> colours = frame->pair->left.rgb.view();
  expect_same(come(objects), detections_of(header, frame->step, camera));
  expect_same(come(disparity), disparity_image_of(header, found, camera, frame->config->segmentation.match));
  expect_same(come(obstacles), cloud_of(header, found, ObstacleLabel::obstacle, camera, left, colours));
  expect_same(come(floor), cloud_of(header, found, ObstacleLabel::floor, camera, left, colours));
  expect_same(come(labels), labels_of(header, frame->step));
  expect_same(come(reject), reject_of(header, found));
  expect_same(come(grid), *grid_of(header_of(frame->step.stamp, "cairn_floor"), found, camera,
                                   frame->config->segmentation.obstacles));
  const auto said = come(stats);
  ASSERT_TRUE(said);
  const auto json = nlohmann::json::parse(said->data);
  EXPECT_EQ(json["objects"], found.objects.list.size());
  EXPECT_EQ(json["name"], "four_in_a_row");
  EXPECT_EQ(json["stamp_ns"], frame->step.stamp.ns);
  const auto transform = come(transforms);
  ASSERT_TRUE(transform);
  EXPECT_EQ(transform->transforms.front().header.frame_id, "cairn_camera");
  EXPECT_EQ(transform->transforms.front().child_frame_id, "cairn_floor");
  sink->finish();
  EXPECT_NE(sink->summary().find(topic("objects")), std::string::npos) << sink->summary();
}

TEST_F(Dds, TheFrameIdIsTheSourcesUnlessSet) {
  const live::LiveFramePtr frame = made_frame("front_left_optical");
  for (const std::string requested : {"", "left_optical"}) {
    live::Ros2Options options;
    options.name_space = own_topic("named" + requested);
    options.camera_frame = requested;
    const auto sink = live::ros2_sink(options, rig());
    const Participant participant;
    Reader<Detection3DArray> reader(participant, options.name_space + "/objects");
    std::optional<Detection3DArray> came;
    ASSERT_TRUE(comes_true([&] {
      sink->offer(frame);
      std::this_thread::sleep_for(20ms);
      return (came = reader.take()).has_value();
    }));
    EXPECT_EQ(came->header.frame_id, requested.empty() ? "front_left_optical" : requested);
    EXPECT_EQ(came->header.stamp.nanosec, time_of(frame->step.stamp).nanosec);
  }
}

TEST_F(Dds, HolesAreInRosConventionOnRequest) {
  live::Ros2Options options;
  options.name_space = own_topic("holes");
  options.marks_holes_as_ros = true;
  options.camera_frame = "left_optical";
  const auto sink = live::ros2_sink(options, rig());
  const Participant participant;
  Reader<DisparityImage> reader(participant, options.name_space + "/disparity");
  std::optional<DisparityImage> came;
  ASSERT_TRUE(comes_true([&] {
    sink->offer(live_frame());
    std::this_thread::sleep_for(20ms);
    return (came = reader.take()).has_value();
  }));
  EXPECT_EQ(came->header.frame_id, "left_optical");
  std::size_t holes = 0;
  for (std::size_t i = 0; i < came->image.data.size(); i += 4) {
    float value = 0;
    std::memcpy(&value, came->image.data.data() + i, 4);
    ASSERT_FALSE(std::isnan(value));
    holes += value < came->min_disparity ? 1 : 0;
    if (value < came->min_disparity) {
      EXPECT_EQ(value, came->min_disparity - 1);
    }
  }
  EXPECT_GT(holes, 100U);
}

TEST_F(Dds, NothingIsEncodedWithoutSubscribers) {
  live::Ros2Options options;
  options.name_space = own_topic("nobody");
  const auto sink = live::ros2_sink(options, rig());
  for (int i = 0; i < 3; ++i) {
    sink->offer(live_frame());
    std::this_thread::sleep_for(30ms);
  }
  sink->finish();
  EXPECT_NE(sink->summary().find("no subscriber"), std::string::npos) << sink->summary();
}

TEST_F(Dds, AWriterDoesNotWaitForAStuckReader) {
  live::Ros2Options options;
  options.name_space = own_topic("stuck");
  const auto sink = live::ros2_sink(options, rig());
  const Participant participant;
  const Reader<DisparityImage> stuck(participant, options.name_space + "/disparity", {true, 5});
  ASSERT_TRUE(comes_true([&] { return stuck.has_writer(); }));
  const auto began = std::chrono::steady_clock::now();
  for (int i = 0; i < 1000; ++i) sink->offer(live_frame());
#if defined(__SANITIZE_ADDRESS__)
  constexpr auto kLimit = 5s;  // waiting 10 ms for each frame would exceed it
#else
  constexpr auto kLimit = 500ms;
#endif
  EXPECT_LT(std::chrono::steady_clock::now() - began, kLimit);
}

// ---- subscribing ----

Image image(const std::string& encoding, std::uint32_t width, std::uint32_t step, Bytes data) {
  Image message;
  message.width = width;
  message.step = step;
  message.height = static_cast<std::uint32_t>(data.size() / step);
  message.encoding = encoding;
  message.data = std::move(data);
  return message;
}

io::LoadedPair images(const Image& left, const Image& right, int bits = 8) {
  return input::pictures_of(left, "/l", right, "/r", bits, {});
}

TEST(RosImages, RowsMayBeLongerThanTheImage) {
  const Image grey = image("mono8", 2, 4, {1, 2, 9, 9, 3, 4, 9, 9});
  const io::LoadedPair pair = images(grey, grey);
  EXPECT_EQ(pair.left.gray.size(), (Size{2, 2}));
  EXPECT_EQ(pair.left.gray(1, 0), 2);
  EXPECT_EQ(pair.left.gray(0, 1), 3);
  EXPECT_TRUE(pair.left.rgb.empty());
}

TEST(RosImages, ChannelsAreInTheDeclaredOrder) {
  const io::LoadedPair pair = images(image("bgr8", 1, 3, {10, 20, 30}), image("rgb8", 1, 3, {10, 20, 30}));
  EXPECT_EQ(pair.left.rgb(0, 0), (Rgb{30, 20, 10}));
  EXPECT_EQ(pair.left.gray(0, 0), (77 * 30 + 150 * 20 + 29 * 10 + 128) >> 8);
  EXPECT_EQ(pair.right.gray(0, 0), (77 * 10 + 150 * 20 + 29 * 30 + 128) >> 8);
  EXPECT_TRUE(pair.right.rgb.empty());
}

TEST(RosImages, DropAlpha) {
  const io::LoadedPair pair =
      images(image("rgba8", 1, 4, {10, 20, 30, 7}), image("bgra8", 1, 4, {10, 20, 30, 7}));
  EXPECT_EQ(pair.left.rgb(0, 0), (Rgb{10, 20, 30}));
  EXPECT_EQ(pair.right.gray(0, 0), (77 * 30 + 150 * 20 + 29 * 10 + 128) >> 8);
}

TEST(RosImages, DeepImagesKeepTheirHighBits) {
  Image left = image("mono16", 2, 4, {0x00, 0x01, 0xff, 0x0f});
  const Image right = image("mono16", 2, 4, {0x10, 0x00, 0x20, 0x00});
  const io::LoadedPair pair = images(left, right);
  EXPECT_EQ(pair.bits, 12);
  EXPECT_EQ(pair.left.gray(0, 0), 0x10);
  EXPECT_EQ(pair.left.gray(1, 0), 0xff);
  EXPECT_EQ(pair.right.gray(1, 0), 0x02);
  EXPECT_EQ(images(right, right, 12).left.gray(1, 0), 0x02);
  left.is_bigendian = 1;
  EXPECT_EQ(images(left, left).left.gray(1, 0), 0xff);
  EXPECT_EQ(images(left, left).bits, 16);
}

TEST(RosImages, RefusesInvalidImages) {
  const Image sound = image("mono8", 2, 2, {1, 2, 3, 4});
  Image other = sound;
  other.encoding = "yuv410";
  EXPECT_EQ(
      message_of([&] { images(sound, other); }),
      "/r: has the encoding yuv410, expected grey (mono8, mono16), colours (rgb8, bgr8, rgba8, bgra8), a Bayer "
      "pattern (bayer_rggb8 ...) or YUV (yuv422, yuv422_yuy2, nv12, nv21, i420)");
  other = sound;
  other.data.pop_back();
  EXPECT_NE(
      message_of([&] { images(other, sound); }).find("/l: has 3 bytes in rows of 2, expected those of 2x2"),
      std::string::npos);
  other = sound;
  other.width = 0xffffffff;
  EXPECT_NE(message_of([&] { images(other, sound); }).find("4294967295"), std::string::npos);
  EXPECT_NE(message_of([&] {
              images(sound, image("mono8", 4, 4, {1, 2, 3, 4}));
            }).find("/r: the left image is 2x2, the right one 4x1"),
            std::string::npos)
      << message_of([&] {
           images(sound, image("mono8", 4, 4, {1, 2, 3, 4}));
         });
  EXPECT_NE(message_of([&] {
              images(sound, image("mono16", 2, 4, {1, 2, 3, 4, 5, 6, 7, 8}));
            }).find("/r: the left image has 8 bits, the right one 16"),
            std::string::npos);
}

/// A camera that publishes the sample at 20 Hz.
class Camera {
 public:
  explicit Camera(const std::string& prefix, bool with_infos = true, std::int64_t right_later_ns = 0)
      : images_{Writer<Image>(participant_, prefix + "/left/image_rect"),
                Writer<Image>(participant_, prefix + "/right/image_rect")},
        infos_{Writer<CameraInfo>(participant_, prefix + "/left/camera_info"),
               Writer<CameraInfo>(participant_, prefix + "/right/camera_info")},
        thread_([this, with_infos, right_later_ns] { work(with_infos, right_later_ns); }) {}
  ~Camera() { end(); }
  void end() {
    is_over_ = true;
    if (thread_.joinable()) thread_.join();
  }

 private:
  void work(bool with_infos, std::int64_t right_later_ns) {
    const input::SequenceFrame& pair = *live_frame()->pair;
    const StereoRig camera = rig();
    for (std::int64_t i = 1; !is_over_; ++i) {
      const Stamp stamp{i * 50'000'000};
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
        const Header header = header_of({stamp.ns + (side == 1 ? right_later_ns : 0)}, "left_optical");
        if (with_infos) {
          infos_[side].write(
              camera_info_of(header, camera, pair.right.size(), side == 0 ? Side::left : Side::right));
        }
        images_[side].write(side == 0 ? pair.left.rgb.empty() ? image_of(header, pair.left.gray.view())
                                                              : image_of(header, pair.left.rgb.view())
                                      : image_of(header, pair.right.view()));
      }
      std::this_thread::sleep_for(50ms);
    }
  }

  Participant participant_;
  std::array<Writer<Image>, 2> images_;
  std::array<Writer<CameraInfo>, 2> infos_;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

bool equal(View<const Gray> a, View<const Gray> b) {
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.height(); ++y)
    if (!std::equal(a.row(y), a.row(y) + a.width(), b.row(y))) return false;
  return true;
}

TEST_F(Dds, ASourceDeliversPairsUnchanged) {
  const std::string prefix = own_topic("stereo");
  const Camera camera(prefix);
  const auto source = input::ros2_sequence("ros2:" + prefix, {}, {});
  const input::SequenceFrame& sent = *live_frame()->pair;
  EXPECT_EQ(source->image_size(), sent.right.size());
  ASSERT_TRUE(source->rig());
  const StereoRig expected = rig();
  EXPECT_EQ(source->rig()->focal_px, expected.focal_px);
  EXPECT_EQ(source->rig()->cx_px, expected.cx_px);
  EXPECT_NEAR(source->rig()->baseline_m, expected.baseline_m, 1e-6);
  EXPECT_NEAR(source->rig()->doffs_px, expected.doffs_px, 1e-4);
  Stamp before;
  for (int i = 0; i < 3; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_TRUE(equal(frame->left.gray, sent.left.gray));
    EXPECT_TRUE(equal(frame->right, sent.right));
    EXPECT_TRUE(frame->arrived);
    EXPECT_EQ(frame->frame_id, "left_optical");
    EXPECT_GT(frame->stamp, before);
    EXPECT_EQ(frame->stamp.ns % 50'000'000, 0);
    before = frame->stamp;
  }
  EXPECT_TRUE(source->status().is_live);
  EXPECT_TRUE(source->status().is_connected);
}

// ---- depth and other sensors ----

/// Publishes an image with its depth, or with its disparities, and the right image, at 20 Hz.
class DepthCamera {
 public:
  DepthCamera(const std::string& prefix, bool is_disparity)
      : image_(participant_, prefix + "/color/image_raw"),
        info_(participant_, prefix + "/color/camera_info"),
        right_(participant_, prefix + "/right/image_rect"),
        right_info_(participant_, prefix + "/right/camera_info") {
    if (is_disparity) {
      disparity_.emplace(participant_, prefix + "/disparity");
    } else {
      depth_.emplace(participant_, prefix + "/depth/image");
    }
    thread_ = std::thread([this] { work(); });
  }
  static Gray mark_of(const Header& header) {
    return static_cast<Gray>(stamp_of(header.stamp).ns / 50'000'000 % 256);
  }
  ~DepthCamera() {
    is_over_ = true;
    thread_.join();
  }

 private:
  void work() {
    const input::SequenceFrame& pair = *live_frame()->pair;
    const View<const float> disparity_px = live_frame()->step.frame.disparity.disparity_px;
    const StereoRig camera = rig();
    cairn::Image<float> depth_m(disparity_px.size());
    for (int y = 0; y < depth_m.height(); ++y) {
      for (int x = 0; x < depth_m.width(); ++x) {
        const auto point = camera.point_in_camera_m(0, 0, disparity_px(x, y));
        depth_m(x, y) = point ? point->z : std::nanf("");
      }
    }
    for (std::int64_t i = 1; !is_over_; ++i) {
      const Header header = header_of({i * 50'000'000}, "color_optical");
      info_.write(camera_info_of(header, camera, pair.right.size(), Side::left));
      right_info_.write(camera_info_of(header, camera, pair.right.size(), Side::right));
      if (depth_) depth_->write(image_of(header, depth_m.view()));
      if (disparity_) {
        disparity_->write(disparity_image_of(header, live_frame()->step.frame, camera,
                                             live_frame()->config->segmentation.match, -1.0F));
      }
      image_.write(image_of(header, pair.left.gray.view()));
      // After all others, and marked with the frame's number.
      std::this_thread::sleep_for(5ms);
      cairn::Image<Gray> right = pair.right.clone();
      right(0, 0) = mark_of(header);
      right_.write(image_of(header, right.view()));
      std::this_thread::sleep_for(45ms);
    }
  }

  Participant participant_;
  Writer<Image> image_;
  Writer<CameraInfo> info_;
  Writer<Image> right_;
  Writer<CameraInfo> right_info_;
  std::optional<Writer<Image>> depth_;
  std::optional<Writer<DisparityImage>> disparity_;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

TEST_F(Dds, ADepthImageOrDisparitiesTakeThePlaceOfTheRightImage) {
  for (const bool is_disparity : {false, true}) {
    const std::string prefix = own_topic(is_disparity ? "with_disparity" : "with_depth");
    const DepthCamera camera(prefix, is_disparity);
    input::SourceOptions options;
    options.topics = is_disparity ? "color/image_raw,disparity" : prefix + "/color/image_raw,depth/image";
    const auto source = input::ros2_sequence("ros2:" + prefix, options, {});
    ASSERT_TRUE(source->rig());
    EXPECT_NEAR(source->rig()->baseline_m, is_disparity ? rig().baseline_m : io::kDepthBaseline_m, 1e-6);
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_TRUE(frame->right.empty());
    EXPECT_EQ(source->frame_id(), "color_optical");
    const View<const float> sent = live_frame()->step.frame.disparity.disparity_px;
    ASSERT_EQ(frame->disparity_px.size(), sent.size());
    int known = 0;
    for (int y = 0; y < sent.height(); ++y) {
      for (int x = 0; x < sent.width(); ++x) {
        const auto expected = rig().point_in_camera_m(0, 0, sent(x, y));
        const float d = frame->disparity_px(x, y);
        const auto found = std::isnan(d) ? std::nullopt : source->rig()->point_in_camera_m(0, 0, d);
        ASSERT_EQ(found.has_value(), expected.has_value()) << x << " " << y << " " << sent(x, y);
        if (!found) continue;
        ++known;
        ASSERT_NEAR(found->z, expected->z, 1e-3F * expected->z);
      }
    }
    EXPECT_GT(known, 10'000);
  }
}

TEST_F(Dds, ARightImageMayCheckDepth) {
  for (const bool is_disparity : {false, true}) {
    const std::string prefix = own_topic(is_disparity ? "checked_disparity" : "checked_depth");
    const DepthCamera camera(prefix, is_disparity);
    input::SourceOptions options;
    options.topics =
        std::string("color/image_raw,right/image_rect,") + (is_disparity ? "disparity" : "depth/image");
    const auto source = input::ros2_sequence("ros2:" + prefix, options, {});
    ASSERT_TRUE(source->rig());
    EXPECT_NEAR(source->rig()->baseline_m, rig().baseline_m, 1e-6);
    // The right image of the first one may have been sent before this reader was known.
    (void)source->next();
    for (int i = 0; i < 3; ++i) {
      const auto frame = source->next();
      ASSERT_TRUE(frame);
      ASSERT_EQ(frame->right.size(), frame->disparity_px.size());
      EXPECT_EQ(frame->right(0, 0), DepthCamera::mark_of(header_of(frame->stamp, "")));
      EXPECT_EQ(frame->right(100, 100), live_frame()->pair->right(100, 100));
    }
  }
}

TEST_F(Dds, OtherSensorsEqualTheirRecordedMessages) {
  const Participant participant;
  const std::string prefix = own_topic("sensors");
  Writer<Odometry> odometry(participant, prefix + "/odom");
  Writer<LaserScan> scan(participant, prefix + "/scan");
  Writer<TFMessage> transforms(participant, "/tf_static", {.latched = true});
  const TFMessage mounting = sensor_messages::transform("base_link", "optical", {0.3, 0, 0.8},
                                                        sensor_messages::kOpticalFromRobot_rad);
  transforms.write(mounting);  // before anyone listens
  const auto sensors =
      input::ros2_sensors({.odometry = prefix + "/odom", .imu = {}, .scan = prefix + "/scan"}, "optical");
  ASSERT_TRUE(comes_true([&] { return odometry.has_reader() && scan.has_reader(); }));
  input::SensorTopics expected("optical");
  expected.add(mounting);
  for (const Odometry& message : sensor_messages::odometry(20)) {
    odometry.write(message);
    expected.add(message);
  }
  for (LaserScan message : sensor_messages::scans(10)) {
    message.header.stamp.sec += 1;
    scan.write(message);
    expected.add(message);
  }
  const Stamp before{1'060'000'000};
  const Stamp now{1'240'000'000};
  std::optional<MotionPrior> prior;
  ASSERT_TRUE(comes_true([&] {
    prior = sensors->between(before, now, {});
    return prior && sensors->assumptions().size() == 1;  // of the laser, which has no transform
  }));
  const auto recorded = expected.priors()->between(before, now);
  ASSERT_TRUE(recorded);
  EXPECT_EQ(prior->now_from_before.rotation, recorded->now_from_before.rotation);
  EXPECT_EQ(prior->now_from_before.translation_m, recorded->now_from_before.translation_m);
  EXPECT_EQ(prior->covariance, recorded->covariance);
  std::optional<cairn::LaserScan> seen;
  ASSERT_TRUE(comes_true([&] { return (seen = sensors->scan_at({1'310'000'000})).has_value(); }));
  EXPECT_EQ(seen->stamp.ns, 1'300'000'000);
  EXPECT_FALSE(sensors->scan_at({9'000'000'000})) << "silent for longer than a second: nobody waits";
}

TEST_F(Dds, DiagnosticsSayWhatIsWrong) {
  const auto said_of = [](const live::LiveFrame& frame) {
    const auto all = live::topics();
    const auto topic =
        std::ranges::find_if(all, [](const live::Topic& each) { return each.name == "/diagnostics"; });
    const auto message = live::message_of(*topic, frame, {.rig = rig()});
    return decode<DiagnosticArray>(*message).status.at(0);
  };
  const auto copy = [] { return made_frame("optical"); };
  const auto sound = said_of(*copy());
  EXPECT_EQ(sound.level, DiagnosticStatus::kOk);
  EXPECT_EQ(sound.message, "ok");
  EXPECT_EQ(sound.hardware_id, "optical");
  const auto changed = std::const_pointer_cast<live::LiveFrame>(copy());
  changed->step.reliability.is_unreliable = true;
  changed->step.reliability.value = 0.25F;
  changed->step.reliability.weakest = "scan";
  const auto weak = said_of(*changed);
  EXPECT_EQ(weak.level, DiagnosticStatus::kWarn);
  EXPECT_EQ(weak.message, "unreliable, weakest: scan");
  EXPECT_EQ(weak.values.at(0).value, "0.25");
  const auto faulty = std::const_pointer_cast<live::LiveFrame>(copy());
  faulty->step.reliability.is_unreliable = true;
  faulty->findings = {{FindingKind::swapped, Severity::broken, 60, "60 % are negative"}};
  const auto broken = said_of(*faulty);
  EXPECT_EQ(broken.level, DiagnosticStatus::kError);
  EXPECT_EQ(broken.message, "cameras swapped");
  EXPECT_EQ(broken.values.back().value, "60 % are negative");
  const auto lost = std::const_pointer_cast<live::LiveFrame>(copy());
  lost->step.is_lost = true;
  EXPECT_EQ(said_of(*lost).message, "ok") << "single frames have no place";
  const auto tracked = std::const_pointer_cast<live::LiveFrame>(copy());
  tracked->step.is_lost = true;
  tracked->step.ids = cairn::Image<TrackId>({4, 4});
  EXPECT_EQ(said_of(*tracked).message, "place of the camera unknown");
}

TEST_F(Dds, DiagnosticsSayThatNoFrameArrives) {
  const Participant participant;
  Reader<DiagnosticArray> reader(participant, "/diagnostics", {.reliable = true, .depth = 100});
  const auto sink = live::ros2_sink({own_topic("silent_run"), "", false}, rig());
  ASSERT_TRUE(comes_true([&] { return reader.has_writer(); }));
  std::vector<DiagnosticStatus> heard;
  ASSERT_TRUE(comes_true([&] {
    if (heard.empty()) sink->offer(live_frame());
    while (const auto message = reader.take()) heard.push_back(message->status.at(0));
    return heard.size() > 1;
  }));
  EXPECT_EQ(heard[0].level, DiagnosticStatus::kOk);
  EXPECT_EQ(heard.back().level, DiagnosticStatus::kError);
  EXPECT_NE(heard.back().message.find("no frame for 1"), std::string::npos) << heard.back().message;
  sink->finish();
}

TEST_F(Dds, ASourceEndsSoonWhenItIsStopped) {
  const std::string prefix = own_topic("stopped");
  auto camera = std::make_unique<Camera>(prefix);
  const auto source = input::ros2_sequence("ros2:" + prefix, {}, {});
  camera.reset();
  std::atomic<bool> has_ended = false;
  std::thread taker([&] {
    while (source->next()) {
    }
    has_ended = true;
  });
  std::this_thread::sleep_for(200ms);
  EXPECT_FALSE(has_ended);
  const auto began = std::chrono::steady_clock::now();
  source->stop();
  taker.join();
  EXPECT_LT(std::chrono::steady_clock::now() - began, 200ms);
  EXPECT_FALSE(source->next());
}

TEST_F(Dds, ASourceReportsWhatItWaitsFor) {
  input::SourceOptions options;
  options.open_timeout_s = 0.5;
  const std::string prefix = own_topic("silent");
  const std::string domain = std::getenv("ROS_DOMAIN_ID");
  EXPECT_EQ(message_of([&] { input::ros2_sequence("ros2:" + prefix, options, {}); }),
            "ros2:" + prefix + ": received nothing on " + prefix + "/left/image_rect and " + prefix +
                "/right/image_rect within 0.5 s in domain " + domain +
                ", expected sensor_msgs/msg/Image; no publisher on " + prefix + "/left/image_rect nor " +
                prefix + "/right/image_rect (check ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY and the topic names)");
  EXPECT_NE(message_of([&] { input::ros2_sequence("ros2:/a-b", options, {}); }).find("expected a ROS name"),
            std::string::npos);
}

TEST_F(Dds, ASourcePairsWithinTheSkew) {
  const std::string prefix = own_topic("skewed");
  const Camera camera(prefix, false, 4'000'000);
  input::SourceOptions options;
  options.open_timeout_s = 1;
  options.max_skew_ms = 1;
  const std::string refused = message_of([&] { input::ros2_sequence("ros2:" + prefix, options, {}); });
  EXPECT_NE(refused.find("differ by more than 0.001 s (--max-skew)"), std::string::npos) << refused;
  options.max_skew_ms = 5;
  options.calib = std::string(CAIRN_SOURCE_DIR) + "/data/samples/four_in_a_row/calib.txt";
  const auto source = input::ros2_sequence("ros2:" + prefix, options, {});
  EXPECT_TRUE(source->next());
  EXPECT_TRUE(source->rig());
}

}  // namespace
}  // namespace cairn::ros
