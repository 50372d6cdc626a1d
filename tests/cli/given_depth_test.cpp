// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "support/recordings.hpp"
#include "support/sensor_messages.hpp"

/// Depth and other sensors from elsewhere: folders, recordings and files give the same results.
namespace cairn::command {
namespace {

using Json = nlohmann::json;
using recordings::CameraFile;
namespace messages = sensor_messages;

const fs::path kSample = fs::path(CAIRN_SOURCE_DIR) / "data/samples/four_in_a_row";

class Given : public CommandTest {
 protected:
  static StereoRig rig() { return *io::load_calibration(kSample / "calib.txt").rig; }
  /// The true depths of the sample, in mm.
  static Image<std::uint16_t> depth_mm() {
    const Image<float> truth = io::load_disparity(kSample / "disp_left.png");
    Image<std::uint16_t> depth(truth.size());
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 0; x < depth.width(); ++x) {
        const auto point = rig().point_in_camera_m(0, 0, truth(x, y));
        depth(x, y) =
            point ? static_cast<std::uint16_t>(std::lround(1000 * double{point->z})) : std::uint16_t{0};
      }
    }
    return depth;
  }
  /// A standing RGB-D camera: rgb/N.png and depth/N.png.
  void rgbd(int frames) const {
    for (const char* folder : {"in/rgb", "in/depth"}) fs::create_directories(at(folder));
    const Image<std::uint16_t> depth = depth_mm();
    for (int i = 0; i < frames; ++i) {
      fs::copy_file(kSample / "left.png", at("in/rgb/" + std::to_string(i) + ".png"));
      io::save_png(at("in/depth/" + std::to_string(i) + ".png"), depth.view());
    }
    std::string text;
    for (const auto& [key, value] :
         {std::pair{"fx", rig().focal_px}, {"cx", rig().cx_px}, {"cy", rig().cy_px}})
      text += std::string(key) + "=" + messages::digits(double{value}) + "\n";
    write(at("in/calib.txt"), text);
  }
  [[nodiscard]] Json objects(const std::string& folder) const {
    return Json::parse(content(at(folder + "/objects.json")))["objects"];
  }
};

TEST_F(Given, DepthImagesGiveTheObjectsWhereTheyAre) {
  rgbd(1);
  const Outcome outcome = run({"segment", path("in"), "-o", path("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Outcome by_pair = run({"segment", kSample.string(), "-o", path("pair")});
  ASSERT_EQ(by_pair.code, 0) << by_pair.err;
  const Json found = objects("out");
  const Json expected = objects("pair");
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i]["position_m"][2].get<double>(), expected[i]["position_m"][2].get<double>(), 0.1)
        << i;
  EXPECT_TRUE(Json::parse(content(at("out/objects.json")))["external_disparity"].get<bool>());
}

TEST_F(Given, TheOptionNamesTheSameImages) {
  rgbd(1);
  ASSERT_EQ(run({"segment", path("in"), "-o", path("out")}).code, 0);
  const Outcome outcome = run({"segment", path("in/rgb/0.png"), "--depth-image", path("in/depth/0.png"),
                               "--calib", path("in/calib.txt"), "-o", path("named")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(objects("named"), objects("out"));
  EXPECT_EQ(content(at("named/objects.png")), content(at("out/objects.png")));
}

TEST_F(Given, DepthIsFollowedRecordedAndBatched) {
  rgbd(4);
  const Outcome outcome = run({"follow", path("in"), "-o", path("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json summary = Json::parse(content(at("out/summary.json")));
  EXPECT_EQ(summary["frames"], 4);
  EXPECT_EQ(summary["tracks"], 4);
  // As folders of frames, and as a recording.
  ASSERT_EQ(run({"record", path("in"), "-o", path("frames")}).code, 0);
  EXPECT_TRUE(fs::exists(at("frames/0000/disparity.pfm")) || fs::exists(at("frames/000000/disparity.pfm")));
  const Outcome again = run({"follow", path("frames"), "-o", path("again")});
  ASSERT_EQ(again.code, 0) << again.err;
  const auto without_names = [&](const std::string& folder) {
    std::istringstream lines(content(at(folder + "/tracks.jsonl")));
    std::vector<Json> all;
    for (std::string line; std::getline(lines, line);) {
      all.push_back(Json::parse(line));
      all.back().erase("name");
    }
    return all;
  };
  EXPECT_EQ(without_names("again"), without_names("out"));
  const Outcome live =
      run({"live", path("in"), "--every-frame", "--pace", "0", "--record", path("run.mcap")});
  ASSERT_EQ(live.code, 0) << live.err;
  const Outcome replayed = run({"follow", path("run.mcap"), "-o", path("replayed")});
  ASSERT_EQ(replayed.code, 0) << replayed.err;
  EXPECT_EQ(without_names("replayed"), without_names("out"));
  ASSERT_EQ(run({"batch", "plan", path("in"), "-o", path("batch")}).code, 0);
  const Outcome batch = run({"batch", "work", path("batch"), "--threads", "1"});
  ASSERT_EQ(batch.code, 0) << batch.err;
  EXPECT_NE((batch.out + batch.err).find("4 frames"), std::string::npos) << batch.out << batch.err;
  const Outcome odometry = run({"odometry", path("in")});
  EXPECT_EQ(odometry.code, 0) << odometry.err;
  const Outcome tuned = run({"tune", path("in")});
  EXPECT_EQ(tuned.code, 2);
}

TEST_F(Given, TheRightImagesOfARecordingCheckItsDepth) {
  const auto record = [&](const std::string& name, float factor) {
    CameraFile camera(at(name));
    const auto left = camera.topic<ros::Image>("/left/image_rect");
    const auto right = camera.topic<ros::Image>("/right/image_rect");
    const auto depth = camera.topic<ros::Image>("/left/depth");
    const auto left_info = camera.topic<ros::CameraInfo>("/left/camera_info");
    const auto right_info = camera.topic<ros::CameraInfo>("/right/camera_info");
    const io::LoadedPair pair = io::load_pair(kSample / "left.png", kSample / "right.png");
    const Image<std::uint16_t> millimetres = depth_mm();
    Image<float> metres(millimetres.size());
    for (int y = 0; y < metres.height(); ++y) {
      for (int x = 0; x < metres.width(); ++x)
        metres(x, y) = 1e-3F * factor * static_cast<float>(millimetres(x, y));
    }
    for (int i = 0; i < 3; ++i) {
      const Stamp stamp{i * 100'000'000LL};
      const ros::Header header = messages::header(stamp, "left_optical");
      camera.add(left, stamp, ros::image_of(header, pair.left.gray.view()));
      camera.add(right, stamp, ros::image_of(header, pair.right.gray.view()));
      camera.add(depth, stamp, ros::image_of(header, View<const float>(metres)));
      camera.add(left_info, stamp, ros::camera_info_of(header, rig(), metres.size(), ros::Side::left));
      camera.add(right_info, stamp, ros::camera_info_of(header, rig(), metres.size(), ros::Side::right));
    }
  };
  record("right.mcap", 1);
  record("wrong.mcap", 1.5F);
  const auto findings = [&](const std::string& name, const std::string& topics) {
    const Outcome outcome = run({"follow", path(name), "--topics", topics, "-o", path(name + ".out")});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.err.find("no disparity of these images") != std::string::npos;
  };
  const std::string three = "/left/image_rect,/right/image_rect,/left/depth";
  EXPECT_FALSE(findings("right.mcap", three));
  EXPECT_TRUE(findings("wrong.mcap", three));
  EXPECT_FALSE(findings("wrong.mcap", "/left/image_rect,/left/depth")) << "nothing there to check it";
  const auto recorded = [&](const std::string& name) {
    const Outcome outcome = run({"record", path(name), "--topics", three, "-o", path(name + ".frames")});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const std::size_t at = outcome.err.find("no disparity of these images");
    EXPECT_TRUE(at == std::string::npos || outcome.err.find("no disparity", at + 1) == std::string::npos)
        << "said once: " << outcome.err;
    return at != std::string::npos;
  };
  EXPECT_FALSE(recorded("right.mcap"));
  EXPECT_TRUE(recorded("wrong.mcap"));
  const Outcome motion = run({"odometry", path("wrong.mcap"), "--topics", three, "-o", path("poses.txt")});
  EXPECT_NE(motion.err.find("no disparity of these images"), std::string::npos) << motion.err;
}

TEST_F(Given, ARecordingGivesTheSameTracks) {
  rgbd(3);
  {
    CameraFile camera(at("run.mcap"));
    const auto image = camera.topic<ros::Image>("/camera/color/image_raw");
    const auto depth = camera.topic<ros::Image>("/camera/aligned_depth_to_color/image_raw");
    const auto info = camera.topic<ros::CameraInfo>("/camera/color/camera_info");
    const io::LoadedImage left = io::load_picture(kSample / "left.png");
    const Image<std::uint16_t> millimetres = depth_mm();
    for (int i = 0; i < 3; ++i) {
      const ros::Header header = messages::header({i * 100'000'000LL}, "camera_color_optical_frame");
      camera.add(image, {i * 100'000'000LL},
                 left.rgb.empty() ? ros::image_of(header, left.gray.view())
                                  : ros::image_of(header, left.rgb.view()));
      ros::Image message;
      message.header = header;
      message.width = static_cast<std::uint32_t>(millimetres.width());
      message.height = static_cast<std::uint32_t>(millimetres.height());
      message.encoding = "16UC1";
      message.step = static_cast<std::uint32_t>(2 * millimetres.width());
      message.data.resize(std::size_t{message.step} * message.height);
      for (int y = 0; y < millimetres.height(); ++y) {
        std::copy_n(reinterpret_cast<const std::uint8_t*>(millimetres.row(y)), message.step,
                    message.data.begin() + static_cast<std::ptrdiff_t>(message.step) * y);
      }
      camera.add(depth, {i * 100'000'000LL}, message);
      ros::CameraInfo of_color;
      of_color.width = message.width;
      of_color.height = message.height;
      of_color.k = {rig().focal_px, 0, rig().cx_px, 0, rig().focal_px, rig().cy_px, 0, 0, 1};
      camera.add(info, {i * 100'000'000LL}, of_color);
    }
  }
  ASSERT_EQ(run({"follow", path("in"), "-o", path("folder")}).code, 0);
  const Outcome outcome = run({"follow", path("run.mcap"), "-o", path("recording")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(content(at("recording/tracks.mots.txt")), content(at("folder/tracks.mots.txt")));
  EXPECT_EQ(content(at("recording/poses.tum")), content(at("folder/poses.tum")));
}

TEST_F(Given, OtherSensorsOnTopicsOfARecordingEqualTheirFiles) {
  std::string table;
  std::string tum = "# base_link\n";
  {
    CameraFile camera(at("run.mcap"));
    const io::LoadedPair pair = io::load_pair(kSample / "left.png", kSample / "right.png");
    const auto left = camera.topic<ros::Image>("/stereo/left/image_rect");
    const auto right = camera.topic<ros::Image>("/stereo/right/image_rect");
    const auto left_info = camera.topic<ros::CameraInfo>("/stereo/left/camera_info");
    const auto right_info = camera.topic<ros::CameraInfo>("/stereo/right/camera_info");
    for (int i = 0; i < 3; ++i) {
      const Stamp stamp{1'000'000'000 + i * 100'000'000LL};
      const ros::Header header = messages::header(stamp, "");
      camera.add(left, stamp, ros::image_of(header, pair.left.gray.view()));
      camera.add(right, stamp, ros::image_of(header, pair.right.gray.view()));
      const Size size = pair.right.gray.size();
      camera.add(left_info, stamp, ros::camera_info_of(header, rig(), size, ros::Side::left));
      camera.add(right_info, stamp, ros::camera_info_of(header, rig(), size, ros::Side::right));
    }
    const auto scan = camera.topic<ros::LaserScan>("/scan");
    for (ros::LaserScan message : messages::scans(4)) {
      message.header.stamp.sec += 1;
      camera.add(scan, ros::stamp_of(message.header.stamp), message);
      table += messages::table_line(message, table.empty());
    }
    const auto odom = camera.topic<ros::Odometry>("/odom");
    for (const ros::Odometry& message : messages::odometry(10)) {
      camera.add(odom, ros::stamp_of(message.header.stamp), message);
      tum += messages::tum_line(message);
    }
  }
  write(at("scan.csv"), table);
  write(at("base_link.tum"), tum);
  const Outcome by_topics =
      run({"follow", path("run.mcap"), "--scan", "ros2:/scan", "--odometry", "ros2:/odom", "--json-lines"});
  ASSERT_EQ(by_topics.code, 0) << by_topics.err;
  const Outcome by_files = run({"follow", path("run.mcap"), "--scan", path("scan.csv"), "--odometry",
                                path("base_link.tum"), "--json-lines"});
  ASSERT_EQ(by_files.code, 0) << by_files.err;
  EXPECT_EQ(by_topics.out, by_files.out);
  EXPECT_NE(by_topics.out.find("\"scan\":0"), std::string::npos) << by_topics.out.substr(0, 2000);
  EXPECT_NE(by_topics.err.find("/tf_static has no transform from base_link to cairn_camera"),
            std::string::npos)
      << by_topics.err;
  const Outcome of_folder = run({"follow", kSample.string(), "--scan", "ros2:/scan"});
  EXPECT_EQ(of_folder.code, 2);
  EXPECT_NE(of_folder.err.find("ros2:/scan: is a topic, expected a recording (MCAP) or a live source"),
            std::string::npos)
      << of_folder.err;
}

}  // namespace
}  // namespace cairn::command
