// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <bit>
#include <cairn/core/error.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cairn/ros/from_step.hpp>
#include <cmath>
#include <cstring>

#include "support/temporary_folder.hpp"

namespace cairn::ros {
namespace {

struct Sample {
  io::LoadedPair images;
  io::Calibration calibration;
  Config config;
  TrackedFrame step;
};

/// The objects of an image, and their tracks in a sequence of this one image.
const Sample& sample() {
  static const Sample made = [] {
    const std::filesystem::path folder =
        std::filesystem::path(CAIRN_SOURCE_DIR) / "data" / "samples" / "four_in_a_row";
    Sample s;
    s.images = io::load_pair(folder / "left.png", folder / "right.png");
    s.calibration = io::load_calibration(folder / "calib.txt");
    s.config.match.num_disparities = s.calibration.num_disparities.value_or(64);
    FollowConfig config;
    config.segmentation = s.config;
    Follower follower(config, s.calibration.rig);
    s.step = follower.next(StereoPair::from(s.images.left.gray, s.images.right.gray, s.images.left.rgb),
                           {1'500'000'000});
    return s;
  }();
  return made;
}

float float_at(const Bytes& bytes, std::size_t at) {
  float value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

const Header kHeader{{1, 2}, "camera"};

TEST(RosFromStep, ImagesHaveNoGapsBetweenRows) {
  cairn::Image<Gray> grey({3, 2}, 0, {});
  for (int i = 0; i < 6; ++i) grey(i % 3, i / 3) = static_cast<Gray>(i);
  const Image message = image_of(kHeader, grey);
  EXPECT_EQ(message.data, (Bytes{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(message.step, 3U);
  EXPECT_EQ(message.encoding, "mono8");
  cairn::Image<Rgb> colour({2, 1}, Rgb{1, 2, 3}, {});
  EXPECT_EQ(image_of(kHeader, colour).data, (Bytes{1, 2, 3, 1, 2, 3}));
  EXPECT_EQ(image_of(kHeader, colour).step, 6U);
}

TEST(RosFromStep, TheRigIsRecoveredFromBothCameras) {
  const StereoRig rig{517.3F, 318.6F, 255.3F, 0.1203F, 12.5F};
  const CameraInfo left = camera_info_of(kHeader, rig, {640, 480}, Side::left);
  const CameraInfo right = camera_info_of(kHeader, rig, {640, 480}, Side::right);
  const StereoRig again = rig_of(left, right);
  EXPECT_EQ(again.focal_px, rig.focal_px);
  EXPECT_EQ(again.cx_px, rig.cx_px);
  EXPECT_EQ(again.cy_px, rig.cy_px);
  EXPECT_EQ(again.baseline_m, rig.baseline_m);
  EXPECT_EQ(again.doffs_px, rig.doffs_px);
  EXPECT_TRUE(support::has(support::refusal([&] { (void)rig_of(right, left); }), {"exchanged"}));
  EXPECT_THROW(rig_of(CameraInfo{}, right), Error);
}

TEST(RosMessages, BinningAndRegionOfInterestAreAppliedToTheRig) {
  const StereoRig rig{500, 320, 240, 0.12F, 4};
  CameraInfo left = camera_info_of(kHeader, rig, {640, 480}, Side::left);
  CameraInfo right = camera_info_of(kHeader, rig, {640, 480}, Side::right);
  for (CameraInfo* info : {&left, &right}) {
    info->binning_x = info->binning_y = 2;
    info->roi = {40, 20, 400, 600, false};
  }
  EXPECT_EQ(image_size_of(left), (Size{300, 200}));
  const StereoRig binned = rig_of(left, right, Size{300, 200});
  EXPECT_FLOAT_EQ(binned.focal_px, 250);
  EXPECT_FLOAT_EQ(binned.cx_px, 140);
  EXPECT_FLOAT_EQ(binned.cy_px, 110);
  EXPECT_FLOAT_EQ(binned.baseline_m, 0.12F);
  EXPECT_FLOAT_EQ(binned.doffs_px, 2);
  EXPECT_TRUE(support::has(support::refusal([&] {
                             (void)rig_of(left, right, Size{640, 480});
                           }),
                           {"300x200", "640x480 as they come"}));
}

TEST(RosFromStep, DisparitiesGiveTheDepthThatTheRigGives) {
  const Sample& s = sample();
  StereoRig rig = s.calibration.rig.value();
  rig.doffs_px = 3;
  const DisparityImage message = disparity_image_of(kHeader, s.step.frame, rig, s.config.match);
  const View<const float> disparity_px = s.step.frame.disparity.disparity_px;
  int holes = 0;
  for (int y = 0; y < disparity_px.height(); ++y) {
    for (int x = 0; x < disparity_px.width(); ++x) {
      const float d = float_at(message.image.data, 4 * (slot(y) * slot(disparity_px.width()) + slot(x)));
      ASSERT_EQ(std::isnan(d), std::isnan(disparity_px(x, y)));
      if (std::isnan(d)) {
        ++holes;
        continue;
      }
      const auto point =
          rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), disparity_px(x, y));
      ASSERT_NEAR(message.f * message.t / d, point->z, 1e-4 * point->z);
    }
  }
  EXPECT_GT(holes, 0);
  EXPECT_EQ(message.min_disparity, 3);
  EXPECT_EQ(message.max_disparity, static_cast<float>(s.config.match.num_disparities + 2));
  EXPECT_EQ(message.delta_d, 0.0625F);
  const DisparityImage filled = disparity_image_of(kHeader, s.step.frame, rig, s.config.match, -1.0F);
  for (std::size_t i = 0; i < filled.image.data.size(); i += 4)
    ASSERT_FALSE(std::isnan(float_at(filled.image.data, i)));
}

TEST(RosFromStep, DetectionsAreTheObjectsWithTheirTracks) {
  const Sample& s = sample();
  const Detection3DArray message = detections_of(kHeader, s.step, s.calibration.rig);
  const auto& objects = s.step.frame.objects.list;
  ASSERT_EQ(message.detections.size(), objects.size());
  ASSERT_FALSE(objects.empty());
  int tracked = 0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Detection3D& found = message.detections[i];
    EXPECT_EQ(found.bbox.center.position.z, objects[i].position_in_camera_m->z);
    EXPECT_EQ(found.bbox.size.x, objects[i].extent_in_camera_m->x);
    ASSERT_EQ(found.results.size(), 1U);
    EXPECT_EQ(found.results[0].hypothesis.score, objects[i].confidence);
    EXPECT_GT(found.results[0].pose.covariance[14], 0);
    for (const Track& track : s.step.tracks.list) {
      if (track.object != objects[i].id) continue;
      EXPECT_EQ(found.id, std::to_string(number(track.id)));
      ++tracked;
    }
  }
  EXPECT_GT(tracked, 0);
  EXPECT_TRUE(detections_of(kHeader, s.step, std::nullopt).detections.empty());
}

TEST(RosFromStep, LabelsAndReasonsEqualThoseOfTheFrame) {
  const Sample& s = sample();
  const Image labels = labels_of(kHeader, s.step);
  const Image reject = reject_of(kHeader, s.step.frame);
  EXPECT_EQ(labels.encoding, "mono16");
  for (int y = 0; y < s.step.ids.height(); ++y) {
    for (int x = 0; x < s.step.ids.width(); ++x) {
      const std::size_t at = 2 * (slot(y) * slot(s.step.ids.width()) + slot(x));
      ASSERT_EQ(labels.data[at] + 256 * labels.data[at + 1], number(s.step.ids(x, y)));
      ASSERT_EQ(reject.data[at] + 256 * reject.data[at + 1],
                static_cast<int>(s.step.frame.disparity.reject(x, y)));
    }
  }
}

TEST(RosFromStep, CloudsContainThePixelsOfTheirClass) {
  const Sample& s = sample();
  const auto& images = s.images.left;
  const auto cloud = [&](ObstacleLabel space, int stride) {
    return cloud_of(kHeader, s.step.frame, space, s.calibration.rig, images.gray, images.rgb, stride);
  };
  const PointCloud2 obstacles = cloud(ObstacleLabel::obstacle, 1);
  const PointCloud2 floor = cloud(ObstacleLabel::floor, 1);
  EXPECT_GT(obstacles.width, 1000U);
  EXPECT_GT(floor.width, 1000U);
  EXPECT_EQ(obstacles.data.size(), std::size_t{obstacles.width} * 24);
  EXPECT_GT(float_at(obstacles.data, 8), 0.3F);
  EXPECT_NEAR(cloud(ObstacleLabel::obstacle, 4).width, obstacles.width / 16.0, obstacles.width / 40.0);
  EXPECT_EQ(cloud_of(kHeader, s.step.frame, ObstacleLabel::floor, std::nullopt, images.gray, {}).width, 0U);
}

TEST(RosFromStep, CloudsOfObstaclesMarkStepsOfTheGround) {
  const Sample& s = sample();
  const auto floor = floor_frame(s.step.frame.ground, s.calibration.rig);
  ASSERT_TRUE(floor);
  for (const float height_m : {0.12F, -0.2F}) {
    PointCloud2 cloud = cloud_of(kHeader, {}, ObstacleLabel::obstacle, {}, {}, {});
    add_steps(cloud, {{{2, -0.5F, 0.01F}, {2.3F, 0.5F, 0.01F}, height_m}}, *floor);
    ASSERT_GE(cloud.width, 53U) << "1.04 m, points 2 cm apart";
    ASSERT_EQ(cloud.data.size(), std::size_t{cloud.width} * cloud.point_step);
    EXPECT_EQ(cloud.row_step, cloud.data.size());
    for (std::size_t k = 0; k < cloud.width; ++k) {
      const auto number = [&](std::size_t i) { return float_at(cloud.data, k * cloud.point_step + 4 * i); };
      const Vec3 at = floor->to_floor({number(0), number(1), number(2)});
      EXPECT_NEAR(at.z, height_m > 0 ? 0.13 : 0.01, 1e-3);
      EXPECT_NEAR(at.x, 2.15 + 0.3 * at.y, 1e-3);
      EXPECT_LE(std::abs(at.y), 0.501);
    }
  }
}

TEST(RosFromStep, TheFloorIsBelowTheCamera) {
  const Sample& s = sample();
  const TFMessage message = transforms_of({}, s.step, s.calibration.rig);
  ASSERT_EQ(message.transforms.size(), 2U);
  EXPECT_EQ(message.transforms[0].header.frame_id, "cairn_map");
  EXPECT_EQ(message.transforms[0].child_frame_id, "cairn_camera");
  const TransformStamped& floor = message.transforms[1];
  EXPECT_EQ(floor.header.frame_id, "cairn_camera");
  EXPECT_EQ(floor.child_frame_id, "cairn_floor");
  EXPECT_GT(floor.transform.translation.y, 0.1);  // down
  EXPECT_EQ(floor.header.stamp.sec, 1);
  EXPECT_EQ(floor.header.stamp.nanosec, 500'000'000U);
  const Quaternion& q = floor.transform.rotation;
  EXPECT_NEAR(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1, 1e-9);
  // A point on the floor one metre ahead is below and in front of the camera: its z axis rotated by q.
  const FloorFrame frame = *floor_frame(s.step.frame.ground, s.calibration.rig);
  const cairn::Pose pose =
      pose_of({floor.transform.translation.x, floor.transform.translation.y, floor.transform.translation.z},
              {q.x, q.y, q.z, q.w});
  const Point3 ahead = pose({1, 0.5, 0.25});
  const Vec3 expected = frame.to_camera({1, 0.5F, 0.25F});
  EXPECT_NEAR(ahead.x, expected.x, 1e-5);
  EXPECT_NEAR(ahead.y, expected.y, 1e-5);
  EXPECT_NEAR(ahead.z, expected.z, 1e-5);
}

TEST(RosFromStep, TheGridEqualsThatOfTheLibrary) {
  const Sample& s = sample();
  const auto grid = grid_of(kHeader, s.step.frame, s.calibration.rig, s.config.obstacles);
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->data.size(), std::size_t{grid->info.width} * grid->info.height);
  EXPECT_NE(std::find(grid->data.begin(), grid->data.end(), std::int8_t{100}), grid->data.end());
  EXPECT_NE(std::find(grid->data.begin(), grid->data.end(), std::int8_t{0}), grid->data.end());
  EXPECT_FALSE(grid_of(kHeader, s.step.frame, std::nullopt, s.config.obstacles));
}

}  // namespace
}  // namespace cairn::ros
