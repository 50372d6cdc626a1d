// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/io/rle.hpp>
#include <cairn/output/results.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <support/temporary_folder.hpp>

namespace cairn::output {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

using namespace std::string_literals;

constexpr Size kSize{60, 40};

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// A temporary folder.
class ResultFolder : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    root_ = fs::temp_directory_path() / (std::string("cairn_results_") + test->name());
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  static std::set<std::string> names(const fs::path& folder) {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder)) all.insert(entry.path().filename().string());
    return all;
  }

  fs::path root_;
};

/// Everything but a strip of obstacle is floor.
void add_space(Frame& frame) {
  frame.space = Image<ObstacleLabel>(kSize, ObstacleLabel::floor, {});
  for (int y = 10; y < 22; ++y) std::fill_n(frame.space.row(y) + 20, 15, ObstacleLabel::obstacle);
  RejectedObstacle left;
  left.reason = RejectionReason::too_small;
  left.box_px = {1, 2, 3, 4};
  left.pixel_count = 12;
  left.disparity_px = 5;
  frame.left_out.push_back(left);
}

Frame frame_with_one_object(bool with_floor) {
  Frame frame;
  frame.disparity = {Image<float>(kSize, 10.0F, {}), Image<Reject>(kSize, Reject::none, {})};
  frame.disparity.disparity_px(0, 0) = std::numeric_limits<float>::quiet_NaN();
  frame.disparity.reject(0, 0) = Reject::border | Reject::flat;
  frame.disparity.disparity_px(1, 0) = 0;
  frame.confidence = Image<float>(kSize, 0.75F, {});
  frame.confidence(0, 0) = 0;
  if (with_floor) {
    frame.floor = Image<std::uint8_t>(kSize, 255, {});
    frame.ground.plane = GroundPlane{0.0F, 0.1F, -2.0F};
    frame.ground.support = 0.5F;
    frame.epipolar = {.rows = 0.5F, .points = 40, .agreeing = 30, .outcome = EpipolarOutcome::corrected};
  } else {
    frame.ground.refusal = Refusal::no_plane;
  }
  frame.objects.labels = Image<ObjectId>(kSize, ObjectId::none, {});
  Object object;
  object.id = ObjectId{1};
  object.box_px = {20, 10, 15, 12};
  object.pixel_count = 15 * 12;
  object.disparity_px = 10.7F;
  object.valid_share = 0.75F;
  object.mean_colour = {1, 2, 3};
  object.position_in_camera_m = Vec3{0.1F, -0.2F, 1.5F};
  object.confidence = 0.9F;
  for (int y = 10; y < 22; ++y) std::fill_n(frame.objects.labels.row(y) + 20, 15, ObjectId{1});
  frame.objects.list.push_back(object);
  return frame;
}

Provenance some_provenance() {
  Provenance provenance;
  provenance.preset = "paper";
  provenance.config = Config::paper();
  provenance.config.match.window_size = 11;
  provenance.config.match.cost = Cost::zncc;
  provenance.rig = StereoRig{500, 30, 20, 0.12F, 0};
  provenance.timings = {{"match", 3.25}, {"measure", 0.5}};
  return provenance;
}

void write(const fs::path& folder, const Frame& frame, const Provenance& provenance) {
  const Image<Gray> left(kSize, Gray{90}, {});
  write_result(folder, left, {}, frame, provenance);
}

TEST(ObjectsJson, ListsObstaclesAndWhyTheyAreNoObjects) {
  Frame frame = frame_with_one_object(true);
  EXPECT_TRUE(Json::parse(objects_json(frame, some_provenance())).at("obstacle_scan").is_null());
  add_space(frame);
  const Json j = Json::parse(objects_json(frame, some_provenance()));
  ASSERT_EQ(j.at("left_out").size(), 1U);
  EXPECT_EQ(j.at("left_out").at(0).at("reason"), "too small");
  EXPECT_EQ(j.at("left_out").at(0).at("bbox"), (Json{1, 2, 3, 4}));
  EXPECT_TRUE(j.at("left_out").at(0).at("position_m").is_null());
  const Json& ranges = j.at("obstacle_scan").at("ranges_m");
  EXPECT_TRUE(std::any_of(ranges.begin(), ranges.end(), [](const Json& r) { return r.is_number(); }));
  EXPECT_NEAR(j.at("floor_frame").at("camera_height_m").get<double>(), 0.12 / std::hypot(0.1, 0.0), 0.2);
  Provenance without_rig = some_provenance();
  without_rig.rig.reset();
  EXPECT_TRUE(Json::parse(objects_json(frame, without_rig)).at("obstacle_scan").is_null());
  EXPECT_EQ(j.at("ground_steps"), Json::array());
  EXPECT_TRUE(Json::parse(objects_json(frame, without_rig)).at("ground_steps").is_null());
  EXPECT_TRUE(Json::parse(objects_json(frame, without_rig)).at("floor_frame").is_null());
}

TEST(ObjectsJson, HasThePositionAndBoxOfAnObject) {
  Frame frame = frame_with_one_object(true);
  Object& object = frame.objects.list[0];
  object.disparity_sigma_px = 0.25F;
  object.depth_interval_m = Interval{1.4F, std::numeric_limits<float>::infinity()};
  object.box_on_floor = FloorBox{{1.5F, 0.5F, 0.25F}, {0.5F, 0.25F, 0.5F}, -0.5F, {1, 2, 3, 4, 5, 6}};
  const Json j = Json::parse(objects_json(frame, some_provenance())).at("objects").at(0);
  EXPECT_EQ(j.at("disparity_sigma_px"), 0.25);
  EXPECT_EQ(j.at("depth_interval_m"), (Json{1.4, nullptr}));
  EXPECT_EQ(j.at("box_on_floor").at("centre_m"), (Json{1.5, 0.5, 0.25}));
  EXPECT_EQ(j.at("box_on_floor").at("yaw_rad"), -0.5);
  EXPECT_EQ(j.at("box_on_floor").at("centre_covariance_m2"), (Json{1, 2, 3, 4, 5, 6}));
}

TEST(ObjectsJson, HasObjectsAndProvenance) {
  const Frame frame = frame_with_one_object(true);
  const Json j = Json::parse(objects_json(frame, some_provenance()));
  EXPECT_EQ(j.at("image"), (Json{{"width", 60}, {"height", 40}}));
  EXPECT_EQ(j.at("preset"), "paper");
  EXPECT_EQ(j.at("rig").at("baseline_m"), 0.12);  // the shortest text of the float, not 0.119999997
  EXPECT_EQ(j.at("config").at("match").at("window_size"), 11);
  EXPECT_EQ(j.at("config").at("match").at("cost"), "zncc");
  EXPECT_TRUE(j.at("config").at("ground").at("label_floor").is_boolean());
  EXPECT_FALSE(j.at("config").contains("semi_global")) << "what is not read says nothing about the result";
  EXPECT_EQ(j.at("timings_ms").at("match"), 3.25);
  EXPECT_EQ(j.at("ground").at("plane").at("b"), 0.1);
  EXPECT_EQ(j.at("ground").at("refusal"), "none");
  EXPECT_EQ(j.at("epipolar").at("outcome"), "corrected");
  EXPECT_EQ(j.at("epipolar").at("rows"), 0.5);
  EXPECT_EQ(j.at("epipolar").at("agreeing"), 30);
  const Json& object = j.at("objects").at(0);
  EXPECT_EQ(object.at("id"), 1);
  EXPECT_EQ(object.at("bbox"), (Json{20, 10, 15, 12}));
  EXPECT_EQ(object.at("area"), 180);
  EXPECT_EQ(object.at("disparity_px"), 10.7);
  EXPECT_EQ(object.at("position_m"), (Json{0.1, -0.2, 1.5}));
  EXPECT_TRUE(object.at("extent_m").is_null());
  EXPECT_EQ(object.at("mean_colour"), (Json{1, 2, 3}));
  EXPECT_EQ(object.at("valid_share"), 0.75);
  EXPECT_EQ(object.at("confidence"), 0.9);
}

TEST(ObjectsJson, ListsEveryActiveOptionOnce) {
  const Provenance provenance = some_provenance();
  const Json config = Json::parse(objects_json(frame_with_one_object(false), provenance)).at("config");
  std::size_t count = 0;
  for (const OptionInfo& option : active_options(provenance.config)) {
    const std::size_t dot = option.name.find('.');
    EXPECT_TRUE(config.at(option.name.substr(0, dot)).contains(option.name.substr(dot + 1))) << option.name;
  }
  for (const auto& section : config) count += section.size();
  EXPECT_EQ(count, active_options(provenance.config).size());
}

TEST(ObjectsJson, HasTheMaskInCocoFormat) {
  const Json object =
      Json::parse(objects_json(frame_with_one_object(false), some_provenance())).at("objects").at(0);
  EXPECT_EQ(object.at("segmentation").at("size"), (Json{40, 60}));  // height first
  const Image<std::uint8_t> mask = io::decode_rle({kSize, object.at("segmentation").at("counts")});
  EXPECT_EQ(mask(20, 10), 1);
  EXPECT_EQ(mask(34, 21), 1);
  EXPECT_EQ(mask(35, 21), 0);
  EXPECT_EQ(mask(20, 9), 0);
}

TEST(ObjectsJson, WritesUnknownValuesAsNull) {
  Provenance provenance = some_provenance();
  provenance.rig = std::nullopt;
  const Json j = Json::parse(objects_json(frame_with_one_object(false), provenance));
  EXPECT_TRUE(j.at("rig").is_null());
  EXPECT_TRUE(j.at("ground").at("plane").is_null());
  EXPECT_EQ(j.at("ground").at("refusal"), "no plane has enough support");
}

TEST_F(ResultFolder, HasAllFilesOfAResultAndNoTemporaryOnes) {
  write(root_ / "out", frame_with_one_object(true), some_provenance());
  EXPECT_EQ(names(root_), std::set<std::string>{"out"});
  EXPECT_EQ(names(root_ / "out"),
            (std::set<std::string>{"disparity.png", "reject.png", "confidence.png", "objects.png",
                                   "floor.png", "overlay.png", "disparity_view.png", "objects.json"}));
}

TEST_F(ResultFolder, IsReadBackAsWritten) {
  const Frame frame = frame_with_one_object(true);
  write(root_ / "out", frame, some_provenance());
  const Image<float> disparity = io::load_disparity(root_ / "out" / "disparity.png");
  EXPECT_TRUE(std::isnan(disparity(0, 0)));
  EXPECT_FLOAT_EQ(disparity(1, 0), 1 / 256.0F);  // a true 0 is written as 1
  EXPECT_FLOAT_EQ(disparity(30, 30), 10.0F);
  const io::Labels objects = io::load_labels(root_ / "out" / "objects.png");
  EXPECT_EQ(objects.bits, 16);
  EXPECT_EQ(objects.ids(20, 10), 1);
  EXPECT_EQ(objects.ids(19, 10), 0);
  const io::Labels reject = io::load_labels(root_ / "out" / "reject.png");
  EXPECT_EQ(reject.bits, 16);
  EXPECT_EQ(reject.ids(0, 0), 1 + 8);
  const io::Labels confidence = io::load_labels(root_ / "out" / "confidence.png");
  EXPECT_EQ(confidence.bits, 8);
  EXPECT_EQ(confidence.ids(0, 0), 0);
  EXPECT_EQ(confidence.ids(30, 30), 191);  // 255·0.75, rounded
  const auto confidences = load_confidences(root_ / "out" / "objects.json");
  ASSERT_EQ(confidences.size(), 1U);
  EXPECT_EQ(confidences[0].id, ObjectId{1});
  EXPECT_DOUBLE_EQ(confidences[0].confidence, 0.9);
}

TEST_F(ResultFolder, HasAPfmIfSixteenBitsCannotHoldTheSearchRange) {
  Provenance provenance = some_provenance();
  provenance.config.match.min_disparity = -16;
  write(root_ / "out", frame_with_one_object(false), provenance);
  EXPECT_TRUE(fs::exists(root_ / "out" / "disparity.pfm"));
  EXPECT_FALSE(fs::exists(root_ / "out" / "disparity.png"));
  EXPECT_FLOAT_EQ(io::load_disparity(root_ / "out" / "disparity.pfm")(1, 0), 0.0F);
}

TEST_F(ResultFolder, ReplacesAnOlderResultAndKeepsOtherFiles) {
  Provenance provenance = some_provenance();
  write(root_ / "out", frame_with_one_object(true), provenance);
  std::ofstream(root_ / "out" / "notes.txt") << "mine";
  provenance.config.match.min_disparity = -16;
  write(root_ / "out", frame_with_one_object(false), provenance);
  EXPECT_EQ(names(root_ / "out"),
            (std::set<std::string>{"disparity.pfm", "reject.png", "confidence.png", "objects.png",
                                   "overlay.png", "disparity_view.png", "objects.json", "notes.txt"}));
}

TEST_F(ResultFolder, OfASecondRunHasNoFileOfTheFirst) {
  const Provenance plenty = some_provenance();
  const Image<Gray> left(kSize, Gray{90}, {});
  write_result(root_ / "out", left, {}, frame_with_one_object(true), plenty, {.point_cloud = true});
  Frame least = frame_with_one_object(false);
  least.confidence = {};
  Provenance other = some_provenance();
  other.rig = std::nullopt;
  other.config.match.min_disparity = -16;
  write(root_ / "alone", least, other);
  EXPECT_GT(names(root_ / "out").size(), names(root_ / "alone").size());
  write(root_ / "out", least, other);
  EXPECT_EQ(names(root_ / "out"), names(root_ / "alone"));
}

TEST_F(ResultFolder, CanBeRemovedWithoutOtherFiles) {
  const Image<Gray> left(kSize, Gray{90}, {});
  for (const char* name : {"out", "mixed"}) {
    write_result(root_ / name, left, {}, frame_with_one_object(true), some_provenance(),
                 {.point_cloud = true, .object_clouds = true, .depth = true});
  }
  std::ofstream(root_ / "mixed" / "notes.txt") << "mine";
  remove_result(root_ / "out");
  EXPECT_FALSE(fs::exists(root_ / "out"));
  remove_result(root_ / "mixed");
  EXPECT_EQ(names(root_ / "mixed"), std::set<std::string>{"notes.txt"});
  fs::create_directories(root_ / "truth");
  std::ofstream(root_ / "truth" / "objects.png") << "not ours";
  remove_result(root_ / "truth");
  EXPECT_TRUE(fs::exists(root_ / "truth" / "objects.png"));
}

TEST_F(ResultFolder, HasNoConfidenceIfThereIsNoneNotEvenAnOlderOne) {
  write(root_ / "out", frame_with_one_object(true), some_provenance());
  Frame frame = frame_with_one_object(true);
  frame.confidence = {};
  write(root_ / "out", frame, some_provenance());
  EXPECT_FALSE(fs::exists(root_ / "out" / "confidence.png"));
}

TEST_F(ResultFolder, CreatesMissingParentsAndAcceptsATrailingSlash) {
  write(root_ / "a" / "b" / "out/", frame_with_one_object(false), some_provenance());
  EXPECT_TRUE(fs::exists(root_ / "a" / "b" / "out" / "objects.json"));
}

TEST_F(ResultFolder, IsReadableForOthers) {
  write(root_ / "out", frame_with_one_object(false), some_provenance());
  fs::create_directory(root_ / "usual");
  EXPECT_EQ(fs::status(root_ / "out").permissions(), fs::status(root_ / "usual").permissions());
}

TEST_F(ResultFolder, IsRefusedBelowAFileWithoutLeavingAnything) {
  std::ofstream(root_ / "file") << "x";
  EXPECT_THROW(write(root_ / "file", frame_with_one_object(false), some_provenance()), Error);
  EXPECT_THROW(write(root_ / "file" / "out", frame_with_one_object(false), some_provenance()), Error);
  EXPECT_THROW(write(root_ / "file" / "deep" / "out", frame_with_one_object(false), some_provenance()),
               Error);
  EXPECT_EQ(names(root_), std::set<std::string>{"file"});
}

TEST_F(ResultFolder, DoesNotExistAfterAFailedWriteNorDoItsParents) {
  Frame frame = frame_with_one_object(false);
  frame.objects.labels(0, 0) = ObjectId{70000};  // does not fit into 16 bits
  EXPECT_THROW(write(root_ / "a" / "out", frame, some_provenance()), Error);
  EXPECT_TRUE(names(root_).empty());
}

TEST_F(ResultFolder, KeepsTheOlderResultIfTheNewOneFails) {
  write(root_ / "out", frame_with_one_object(true), some_provenance());
  const auto before = names(root_ / "out");
  Frame frame = frame_with_one_object(false);
  frame.objects.labels(0, 0) = ObjectId{70000};
  EXPECT_THROW(write(root_ / "out", frame, some_provenance()), Error);
  EXPECT_EQ(names(root_ / "out"), before);
  EXPECT_EQ(io::load_labels(root_ / "out" / "objects.png").ids(20, 10), 1);
}

TEST_F(ResultFolder, RefusesOtherObjectsJson) {
  std::ofstream(root_ / "objects.json") << R"({"objects": [{"id": "one"}]})";
  EXPECT_THROW((void)load_confidences(root_ / "objects.json"), Error);
  std::ofstream(root_ / "objects.json") << "{";
  EXPECT_THROW((void)load_confidences(root_ / "objects.json"), Error);
}

TEST_F(ResultFolder, AnInvalidIdIsRefusedBeforeConversion) {
  for (const char* id : {"2e128", "-1", "0", "1.5", "65536", "18446744073709551615", "[[1]]", "null"}) {
    const fs::path path = root_ / "objects.json";
    std::ofstream(path) << R"({"objects": [{"id": )" << id << R"(, "confidence": 0.5}]})";
    const std::string message = support::refusal([&] { (void)load_confidences(path); });
    EXPECT_TRUE(support::has(message, {path.string(), "`id` is ", "a whole number from 1 to 65535"})) << id;
  }
}

TEST_F(ResultFolder, HasDepthAndGridOnRequest) {
  Frame frame = frame_with_one_object(true);
  add_space(frame);
  const Image<Gray> left(kSize, Gray{90}, {});
  write_result(root_ / "with", left, {}, frame, some_provenance(), {.depth = true, .grid = true});
  // Z = 500 · 0.12 / 10 = 6 m; a hole at (0, 0), infinity at (1, 0).
  const io::Labels depth = io::load_labels(root_ / "with" / "depth.png");
  EXPECT_EQ(depth.ids(5, 5), 6000);
  EXPECT_EQ(depth.ids(0, 0), 0);
  EXPECT_EQ(depth.ids(1, 0), 0);
  const std::string npy = text_of(root_ / "with" / "depth.npy");
  ASSERT_EQ(npy.size() % 64, static_cast<std::size_t>(kSize.area()) * 4 % 64);
  EXPECT_EQ(npy.substr(0, 6), "\x93NUMPY");
  EXPECT_NE(npy.find("'shape': (40, 60)"), std::string::npos);
  const std::string pgm = text_of(root_ / "with" / "grid.pgm");
  EXPECT_EQ(pgm.substr(0, 15), "P5\n120 240\n255\n"s.substr(0, 15));
  EXPECT_NE(text_of(root_ / "with" / "grid.yaml").find("resolution: 0.05\norigin: [0.0, -6.0, 0.0]"),
            std::string::npos);
  EXPECT_TRUE(names(root_ / "with").count("space.png"));

  write_result(root_ / "with", left, {}, frame, some_provenance());
  for (const char* name : {"depth.png", "depth.npy", "grid.pgm", "grid.yaml"})
    EXPECT_FALSE(names(root_ / "with").count(name)) << name;
}

}  // namespace
}  // namespace cairn::output
